"""``pslv serve``: from settings to a running service."""

import contextlib
import os
import sys
import webbrowser
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from app import __version__
from app.commands.options import ConfigFile, Venue
from app.commands.progress import Progress, console, print_line

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from app.launch.first_lines import FirstLines
    from vision_core.settings.layers import Layer
    from vision_core.settings.schema import Settings


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
    database: Annotated[
        Path | None,
        typer.Option(
            envvar="PSLV_DATABASE", help="Folder of what is changed on the page; without it, the data folder."
        ),
    ] = None,
) -> None:
    """Start the service: camera, vision, UDP server and page."""
    from app.launch.first_lines import FirstLines
    from app.launch.kept_changes import database_folder, scope_of, with_kept_changes
    from vision_core.tasks.table import check_table
    from vision_core.venues.loader import layers_of, place_of, settings_from_layers

    options = {
        "source.uri": source,
        "server.host": host,
        "server.udp_host": udp_host,
        "server.port": port,
        "server.udp_port": udp_port,
        "server.session_port": session_port,
    }
    folder, notice = database_folder(database)
    scope = scope_of(venue, config)
    document = folder / f"venue-{scope}.db"
    lines = FirstLines(print_line)
    if notice:
        lines.say(notice)
    layers = with_kept_changes(document, layers_of(venue, config, options), lines.say)
    settings = settings_from_layers(layers)
    check_table(settings, lambda key: place_of(key, layers))
    sys.exit(_run(settings, layers, document, scope, lines))


def _run(settings: "Settings", layers: "Sequence[Layer]", document: Path, scope: str, lines: "FirstLines") -> int:
    """Run the service until it is stopped. Returns its exit status."""
    from app.launch.page import page_being_built
    from app.launch.plan import plan_service, prepare_kernel_folder
    from app.launch.preflight import preflight
    from app.launch.resource_owners import lock_camera
    from app.supervisor.supervisor import Supervisor
    from vision_core.rtdb import records
    from vision_core.scheduling.selftest import in_words

    for line in prepare_kernel_folder():
        lines.say(line)
    with contextlib.ExitStack() as held:
        if settings.source.device is not None:
            held.enter_context(lock_camera(settings.source.device))
        plan, info = plan_service(settings, __version__, layers, document, scope)
        machine = preflight(settings, lines.say)
        held.enter_context(page_being_built())  # not before: the self-test of the machine wants it quiet
        lines.say(f"PSLV {__version__}: page {info.http}, robots at UDP {info.udp}, source {settings.source.uri}")
        lines.say(in_words(machine))
        link = _link(info.http, document.parent, lines.say)
        if link != info.http:
            print_line(f"no password is set yet; the operator logs in here: {link}")
        if os.environ.get("DISPLAY") and sys.stdout.isatty():
            webbrowser.open(link)
        first = {"selftest": records.SELF_TEST.encode(machine), "log": lines.record()}
        plan = replace(plan, initial=plan.initial | first)
        return Supervisor(plan, print_line, Progress().show if console.is_terminal else None).run()


def _link(page: str, database: Path, say: "Callable[[str], None]") -> str:
    """The address of the page, with a token for the operator while no password is set; say: takes a notice."""
    from app.web.auth.people import People
    from app.web.auth.people_file import NAME

    people = People(database / NAME)
    if people.notice:
        say(people.notice)
    token = people.first_run_token()
    people.close()
    return f"{page}/?token={token}" if token else page
