"""The command line and composition root: ``pslv serve | client | tasks | top | selftest | detect | ...``."""

import json
import sys
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.console import Console

from app import __version__
from app.commands import evaluate, patterns
from app.commands.bench import bench
from app.commands.colors import colors_app
from app.commands.options import ConfigFile, Venue
from app.commands.restart import restart
from app.commands.selftest import selftest
from app.commands.serve import serve
from app.commands.tasks import tasks
from app.commands.top import top
from vision_core.errors import PslvError

app = typer.Typer(
    no_args_is_help=True, add_completion=False, rich_markup_mode="markdown", pretty_exceptions_enable=False
)
config_app = typer.Typer(no_args_is_help=True, help="Look at settings.")
app.add_typer(config_app, name="config")
app.add_typer(colors_app, name="colors")
app.add_typer(patterns.app, name="patterns")
for command in (serve, tasks, top, restart, selftest, evaluate.evaluate, bench):
    app.command()(command)
console = Console(stderr=True, highlight=False)


def run() -> None:
    """Run the command line; errors of ours are one clear line and exit status 2."""
    try:
        app()
    except PslvError as error:
        console.print(f"pslv: {error}", style="red", markup=False, soft_wrap=True)
        sys.exit(2)


def _version(wanted: bool) -> None:
    if wanted:
        typer.echo(f"pslv {__version__}")
        raise typer.Exit


@app.callback()
def root(
    version: Annotated[
        bool, typer.Option("--version", callback=_version, is_eager=True, help="Print the version.")
    ] = False,
) -> None:
    """Pseudo-local vision: what every robot on the field would see, from one ceiling camera."""


@app.command(context_settings={"allow_extra_args": True, "ignore_unknown_options": True}, add_help_option=False)
def client(context: typer.Context) -> None:
    """Be a robot: connect, and print what it sees (`pslv client --help`)."""
    from vision_core.client.__main__ import main

    sys.exit(main(context.args))


@app.command()
def detect(
    files: Annotated[list[Path], typer.Argument(help="Pictures, each judged alone.")],
    venue: Venue = None,
    config: ConfigFile = None,
    as_json: Annotated[bool, typer.Option("--json", help="One line of JSON per picture.")] = False,
    draw: Annotated[
        Path | None, typer.Option(help="Folder for overlays: what was found, and the color class of every pixel.")
    ] = None,
) -> None:
    """Find robots and balls in pictures."""
    from vision_core.evaluation.stills import detect_files
    from vision_core.venues.loader import load_settings

    failed = False
    for found in detect_files(files, load_settings(venue, config), draw):
        failed |= "error" in found
        typer.echo(json.dumps(found) if as_json else _summary(found))
    if failed:
        raise typer.Exit(2)


@config_app.command("show")
def config_show(venue: Venue = None, config: ConfigFile = None) -> None:
    """Print every setting as the service would use it, as JSON."""
    import msgspec

    from vision_core.venues.loader import load_settings

    typer.echo(msgspec.json.format(msgspec.json.encode(load_settings(venue, config)), indent=2).decode())


@config_app.command("validate")
def config_validate(venue: Venue = None, config: ConfigFile = None) -> None:
    """Say whether settings are in order; exit status 2 when they are not."""
    from vision_core.models.camera_setup import CameraSetup
    from vision_core.startup.preflight import check_tasks
    from vision_core.tasks.table import check_table
    from vision_core.venues.loader import layers_of, place_of, settings_from_layers

    layers = layers_of(venue, config)
    settings = settings_from_layers(layers)
    check_table(settings, lambda key: place_of(key, layers))
    camera = CameraSetup.from_settings(settings)
    check_tasks(settings, camera)
    typer.echo("in order: field {}, camera {}x{}".format(settings.field.name, *camera.size_px))


def _summary(found: dict[str, Any]) -> str:
    """One picture's result in words."""
    if "error" in found:
        return f"{found['file']}: {found['error']}"
    robots = ", ".join(
        f"{robot['team']} {'?' if robot['id'] is None else robot['id']} ({robot['x_m']:.2f}, {robot['y_m']:.2f})"
        for robot in found["robots"]
    )
    balls = ", ".join(f"({ball['x_m']:.2f}, {ball['y_m']:.2f})" for ball in found["balls"])
    reasons = "".join(f"\n  {reason}" for reason in found["reasons"])
    return f"{found['file']}: robots: {robots or 'none'}; balls: {balls or 'none'}{reasons}"
