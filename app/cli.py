"""The command line: registers every command of ``app.commands``."""

import sys
from typing import Annotated

import typer
from rich.console import Console

from app import __version__
from app.commands import evaluate, patterns
from app.commands.bench import bench
from app.commands.calibrate import calibrate_app
from app.commands.calibrate_lens import board, lens
from app.commands.calibrate_mirror import mirror
from app.commands.client import CONTEXT, client
from app.commands.colors import colors_app
from app.commands.compile import compile_command
from app.commands.config import config_app
from app.commands.detect import detect
from app.commands.examination import check, check_client, conformance
from app.commands.fairness import fairness
from app.commands.fidelity import fidelity
from app.commands.lag import lag
from app.commands.onboard import onboard_app
from app.commands.people import passwd, token
from app.commands.play import play
from app.commands.restart import restart
from app.commands.selftest import selftest
from app.commands.serve import serve
from app.commands.support_bundle import support_bundle
from app.commands.tasks import tasks
from app.commands.top import top
from app.commands.venue import venue_app
from vision_core.errors import PslvError

app = typer.Typer(
    no_args_is_help=True, add_completion=False, rich_markup_mode="markdown", pretty_exceptions_enable=False
)
app.add_typer(config_app, name="config")
app.add_typer(venue_app, name="venue")
app.add_typer(calibrate_app, name="calibrate")
app.add_typer(colors_app, name="colors")
app.add_typer(patterns.app, name="patterns")
app.add_typer(onboard_app, name="onboard")
for command in (
    serve,
    tasks,
    top,
    restart,
    passwd,
    token,
    selftest,
    detect,
    evaluate.evaluate,
    fairness,
    fidelity,
    lag,
    bench,
    support_bundle,
    play,
):
    app.command()(command)
for of_numpy_alone in (client, check, check_client, conformance):
    app.command(context_settings=CONTEXT, add_help_option=False)(of_numpy_alone)
app.command("compile")(compile_command)
calibrate_app.command()(board)
calibrate_app.command()(lens)
calibrate_app.command()(mirror)
console = Console(stderr=True, highlight=False)


def run() -> None:
    """Run the command line; a PslvError is printed as one line, with exit status 2."""
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
