"""``pslv play``: programs play against each other in a simulated venue, each seeing only its robot's views."""

import contextlib
import os
import signal
import subprocess
import sys
import time
import urllib.request
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn
from rich.table import Table

from app.commands.progress import print_line
from vision_core.errors import ServiceError, SourceError

if TYPE_CHECKING:
    from vision_core.client.play.game import Page
    from vision_core.client.play.match import Match
    from vision_core.client.play.players import Player

READY_S = 1800.0
"""A first start compiles for minutes."""
PERCENT = 100.0
WRITABLE = "a file in a folder that may be written"


def play(
    controller: Annotated[
        str, typer.Option(help="chase, keeper, MODULE:CLASS or FILE.py:CLASS: plays blue, and yellow as well.")
    ] = "chase",
    yellow: Annotated[str, typer.Option(help="Plays yellow; without it, as --controller.")] = "",
    keeper: Annotated[str, typer.Option(help="Plays robot 1 of both teams; none: as the others.")] = "keeper",
    robots: Annotated[int, typer.Option(min=1, max=16, help="Robots of each team.")] = 5,
    minutes: Annotated[float, typer.Option(min=0.05, max=600.0, help="How long the match is.")] = 10.0,
    host: Annotated[str, typer.Option(help="Where the service runs.")] = "127.0.0.1",
    port: Annotated[int, typer.Option(help="Its UDP port.")] = 6000,
    page: Annotated[str, typer.Option(help="Its page, for the score; without it, port 8000 of the host.")] = "",
    serve: Annotated[bool, typer.Option(help="Start a service of its own for the match, at --port.")] = False,
    venue: Annotated[str, typer.Option(help="With --serve: a simulated venue, demo-vsss for example.")] = "",
    out: Annotated[Path, typer.Option(help="The picture of the match to write (SVG).")] = Path("match.svg"),
) -> None:
    """Let programs play the robots of a simulated venue: five against five, by their views alone.

    The service must run (`pslv serve`), or use --serve. Prints score, possession, collisions, what each program missed,
    and processor times; writes a picture.
    """
    from vision_core.client.play.controllers import load_controller
    from vision_core.client.play.game import Page
    from vision_core.client.play.players import Player, Server
    from vision_core.types.objects import Team

    _check_folder(out)
    kinds = {Team.BLUE: load_controller(controller), Team.YELLOW: load_controller(yellow or controller)}
    keeps = load_controller(keeper) if keeper != "none" and robots > 1 else None
    address = page or f"http://{host}:8000"
    with contextlib.ExitStack() as stack:
        if serve:
            address = stack.enter_context(_own_service(port, venue))
        server = Server(host, port)
        players = [
            Player(server, team, number, keeps if keeps and number == 1 else kinds[team])
            for team in Team
            for number in range(1, robots + 1)
        ]
        match = _played(players, Page(address), minutes * 60.0)
    _report(match, out, f"{controller} against {yellow or controller}, {robots} each")


def _played(players: "list[Player]", page: "Page", duration_s: float) -> "Match":
    """Play with a bar that shows the score."""
    from vision_core.client.play.match import play as play_match

    columns = (TextColumn("{task.description}"), BarColumn(), TimeRemainingColumn())
    with Progress(*columns, console=Console(stderr=True)) as bar:
        task = bar.add_task("connecting", total=duration_s)
        match = play_match(
            players,
            page,
            duration_s,
            lambda gone_s, score: bar.update(
                task, completed=gone_s, description=f"blue {score.goals[0]} : {score.goals[1]} yellow"
            ),
        )
        bar.update(task, completed=duration_s)
        return match


def _report(match: "Match", out: Path, title: str) -> None:
    """Print what happened, and write the picture."""
    from vision_core.client.play.chart import chart

    final = match.final
    console = Console(highlight=False)
    table = Table("robot", "views", "missed", "age", "processor", title=title)
    for player in match.players:
        count = player.count
        table.add_row(
            f"{player.team} {player.number}",
            f"{count.views / match.duration_s:.1f} /s",
            f"{PERCENT * count.missed_share:.2f} %",
            f"{count.mean_age_ms:.0f} ms",
            f"{PERCENT * count.cpu_s / match.duration_s:.1f} %",
        )
    console.print(table)
    share = PERCENT * final.blue_share
    service = "" if match.service_cpu_s is None else f", the service {match.service_cpu_s / match.duration_s:.2f}"
    console.print(
        f"blue {final.goals[0]} : {final.goals[1]} yellow in {final.played_s / 60.0:.1f} min;"
        f" possession {share:.0f} % : {PERCENT - share:.0f} %; {final.collisions_per_minute:.1f} collisions a minute\n"
        f"the programs use {match.controllers_cpu_s / match.duration_s:.2f} processors{service}"
    )
    try:
        out.write_text(chart(title, match.scores), encoding="utf-8")
    except OSError as error:
        raise SourceError(f"picture {out}", found=error.strerror or str(error), accepted=WRITABLE) from None
    console.print(f"picture: {out}")


def _check_folder(out: Path) -> None:
    """Can the picture be written when the match is over? Raises SourceError."""
    if not os.access(out.parent, os.W_OK) or out.is_dir():
        found = "it is a folder" if out.is_dir() else f"{out.parent} is no folder that may be written"
        raise SourceError(f"picture {out}", found=found, accepted=WRITABLE)


@contextlib.contextmanager
def _own_service(port: int, venue: str) -> Iterator[str]:
    """A service for this match alone; gives the address of its page. Raises ServiceError when it does not start."""
    http = port + 2
    command = [sys.executable, "-m", "app.main", "serve", "--source", "synthetic", "--port", str(http)]
    command += ["--udp-port", str(port), *(["--venue", venue] if venue else [])]
    print_line(f"starting a service at UDP port {port}; the first start compiles for minutes")
    service = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    try:
        _wait_until_ready(service, f"http://127.0.0.1:{http}")
        yield f"http://127.0.0.1:{http}"
    finally:
        service.send_signal(signal.SIGTERM)
        service.wait()


def _wait_until_ready(service: "subprocess.Popen[bytes]", page: str) -> None:
    deadline_s = time.monotonic() + READY_S
    while time.monotonic() < deadline_s:
        if service.poll() is not None:
            break
        with contextlib.suppress(OSError), urllib.request.urlopen(f"{page}/readyz", timeout=2.0):  # noqa: S310 (ours)
            return
        time.sleep(1.0)
    raise ServiceError("a service for the match", found="it does not start", accepted="see why: pslv serve")
