"""``pslv serve``: from settings to a running service."""

import os
import sys
import webbrowser
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from app.commands.options import ConfigFile, Venue
from app.commands.progress import Progress, console, print_line

if TYPE_CHECKING:
    from collections.abc import Callable

    from vision_core.rtdb.infos import SelfTest, ServiceInfo


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
    from app.launch.plan import prepare_kernel_folder
    from app.launch.prepared import StartOptions
    from app.launch.service import Reports, run_service

    options = {
        "source.uri": source,
        "server.host": host,
        "server.udp_host": udp_host,
        "server.port": port,
        "server.udp_port": udp_port,
        "server.session_port": session_port,
    }
    start = StartOptions(venue, _path(config), _path(database), options)
    lines = FirstLines(print_line)
    for line in prepare_kernel_folder():
        lines.say(line)
    progress = Progress().show if console.is_terminal else None
    sys.exit(run_service(start, Reports(lines, print_line, progress, _tell_start)))


def _path(path: Path | None) -> str | None:
    return str(path.absolute()) if path else None


def _tell_start(info: "ServiceInfo", machine: "SelfTest", say: "Callable[[str], None]") -> None:
    """Say where the page and the UDP ports are, and open the page on a desktop."""
    from vision_core.scheduling.selftest import in_words

    say(f"PSLV {info.version}: page {info.http}, robots at UDP {info.udp}, source {info.settings.source.uri}")
    say(in_words(machine))
    link = _link(info.http, Path(info.database).parent, say)
    if link != info.http:
        print_line(f"no password is set yet; the operator logs in here: {link}")
    if os.environ.get("DISPLAY") and sys.stdout.isatty():
        webbrowser.open(link)


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
