"""The command line and composition root: ``pslv serve | client | detect | evaluate | patterns | config``."""

import contextlib
import json
import os
import subprocess
import sys
import webbrowser
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.console import Console
from rich.status import Status

from app import __version__
from app.commands import evaluate, patterns
from app.commands.bench import bench
from app.commands.colors import colors_app
from app.commands.options import ConfigFile, Venue
from vision_core.errors import PslvError

app = typer.Typer(
    no_args_is_help=True, add_completion=False, rich_markup_mode="markdown", pretty_exceptions_enable=False
)
config_app = typer.Typer(no_args_is_help=True, help="Look at settings.")
app.add_typer(config_app, name="config")
app.add_typer(colors_app, name="colors")
app.add_typer(patterns.app, name="patterns")
app.command()(evaluate.evaluate)
app.command()(bench)
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


@app.command()
def serve(
    source: Annotated[
        str | None,
        typer.Option(
            envvar="PSLV_SOURCE",
            help="synthetic, file:PICTURE, file:FOLDER, file:VIDEO or camera:0, camera:/dev/video0.",
        ),
    ] = None,
    venue: Venue = None,
    config: ConfigFile = None,
    host: Annotated[str | None, typer.Option(envvar="PSLV_HOST", help="Address of the page.")] = None,
    udp_host: Annotated[
        str | None, typer.Option(envvar="PSLV_UDP_HOST", help="Address of the UDP ports; without it, as --host.")
    ] = None,
    port: Annotated[int | None, typer.Option(envvar="PSLV_PORT", help="TCP port of the page; 0: any free one.")] = None,
    udp_port: Annotated[int | None, typer.Option(envvar="PSLV_UDP_PORT", help="UDP port for (init ...).")] = None,
    session_port: Annotated[
        int | None,
        typer.Option(envvar="PSLV_SESSION_PORT", help="UDP port of the sessions; without it, --udp-port + 1."),
    ] = None,
) -> None:
    """Start the service: camera, vision, UDP server and page."""
    options = {
        "source.uri": source,
        "server.host": host,
        "server.udp_host": udp_host,
        "server.port": port,
        "server.udp_port": udp_port,
        "server.session_port": session_port,
    }
    from app.service_plan import plan_service, prepare_data_folder
    from app.supervisor.service import Supervisor
    from vision_core.settings_files import load_settings

    settings = load_settings(venue, config, options)
    prepare_data_folder()
    _check_source(settings)
    plan, info = plan_service(settings, __version__)
    _tell(f"PSLV {__version__}: page {info.http}, robots at UDP {info.udp}, source {settings.source.uri}")
    if os.environ.get("DISPLAY") and sys.stdout.isatty():
        webbrowser.open(info.http)
    progress = _Progress()
    sys.exit(Supervisor(plan, _tell, progress.show).run())


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
    from vision_core.settings_files import load_settings
    from vision_core.tasks.stills import detect_files

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

    from vision_core.settings_files import load_settings

    typer.echo(msgspec.json.format(msgspec.json.encode(load_settings(venue, config)), indent=2).decode())


@config_app.command("validate")
def config_validate(venue: Venue = None, config: ConfigFile = None) -> None:
    """Say whether settings are in order; exit status 2 when they are not."""
    from vision_core.settings_files import load_settings
    from vision_core.tasks.preflight import check_tasks

    settings = load_settings(venue, config)
    check_tasks(settings)
    typer.echo(f"in order: field {settings.field.name}, camera {settings.camera.width_px}x{settings.camera.height_px}")


def _check_source(settings: Any) -> None:
    """Open the source once in a process of its own, so that nothing is half started when it fails."""
    import msgspec

    result = subprocess.run(
        [sys.executable, "-m", "vision_core.tasks.preflight"],
        input=msgspec.json.encode(settings),
        capture_output=True,
        check=False,
    )
    if result.returncode:
        lines = result.stderr.decode(errors="replace").strip().splitlines() or ["no word"]
        raise PslvError(lines[-1] if result.returncode == 2 else "\n".join(lines))


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


def _tell(line: str) -> None:
    """News of the service. That nobody reads the log any more, or its disk is full, is no reason to stop it."""
    with contextlib.suppress(OSError):
        print(line, file=sys.stderr, flush=True)


class _Progress:
    """The compiler's progress: a spinner on a terminal, lines elsewhere."""

    def __init__(self) -> None:
        self._status: Status | None = None

    def show(self, text: str) -> None:
        """Show how far it is; the empty string ends it."""
        if not text:
            if self._status is not None:
                self._status.stop()
            self._status = None
        elif not console.is_terminal:
            _tell(f"preparing {text}")
        elif self._status is None:
            self._status = console.status(f"preparing {text}")
            self._status.start()
        else:
            self._status.update(f"preparing {text}")
