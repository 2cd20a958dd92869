"""``python -m vision_core.client``: be a robot, and print or draw what it sees."""

import argparse
import itertools
import json
import os
import sys
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

import numpy as np

from vision_core.client.connection import RESTART_S, Connection, connect
from vision_core.client.view import View
from vision_core.clock import MonotonicClock, after, seconds_between
from vision_core.errors import PslvError
from vision_core.models.mirror import PAPER_MIRROR, Mirror
from vision_core.protocol.messages import MAX_NUMBER
from vision_core.protocol.options import FASTEST_HZ, Options
from vision_core.types.objects import Team

FAILED = 2
STALE_S = 5.0
"""No view for so long is worth a line."""
MAX_TIMEOUT_S = 86400.0
MAX_VIEWS = 10**9
MAX_PORT = 65535


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command; returns its exit code: 0, also after Ctrl-C; 2 with one line on what went wrong."""
    asked = _parser().parse_args(arguments)
    try:
        mirror = Mirror(*asked.mirror) if asked.mirror else None
        options = Options(types=asked.types, rate_hz=asked.rate, mirror=mirror)
        of_field = Mirror(*asked.field_mirror) if asked.field_mirror else PAPER_MIRROR
        robot = connect(
            asked.host,
            asked.port,
            asked.team,
            asked.number,
            options=options,
            mirror=of_field,
            timeout_s=asked.timeout,
        )
        with robot:
            views = itertools.islice(_views(robot, asked.timeout), asked.count)
            _show(views, robot, as_json=asked.json, picture=asked.draw)
    except PslvError as error:
        print(f"pslv client: {error}", file=sys.stderr)
        return FAILED
    except KeyboardInterrupt:
        return 0
    except BrokenPipeError:  # the reader of our output has seen enough
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 0
    except OSError as error:
        print(f"pslv client: {error}", file=sys.stderr)
        return FAILED
    return 0


def plain_from_view(view: View) -> dict[str, object]:
    """A view as JSON types; -1 px for nothing."""
    ball = view.ball
    return {
        "time_s": view.time_s,
        "edges": [[letter, px] for letter, px in zip(view.letters.tolist(), view.px.tolist(), strict=True)],
        "ball": {
            "px": ball.px,
            "direction_deg": ball.direction_deg,
            "size_deg": ball.size_deg,
            "hidden": ball.hidden,
        },
    }


def sentence_from_view(view: View) -> str:
    """A view in one line for people."""
    return f"{view.time_s:10.3f} s, {view.summary}"


def draw(view: View, robot: Connection, path: Path) -> None:
    """Write the view as the simulated on-board picture of the paper's figure 6."""
    from vision_core.client.panorama import draw_panorama
    from vision_core.client.png import write_png

    options, ball = robot.init.options, view.ball
    whole_deg = ball.size_deg * (2.0 if options.size == "half" else 1.0)
    picture = draw_panorama(
        np.where(view.px < 0, 255.0, view.px),
        "".join(view.letters.tolist()),
        None if ball.hidden else (float(ball.px), float(ball.direction_deg), whole_deg),
        robot.mirror,
        fov_deg=(options.fov_deg, options.center_deg),
        clockwise=options.sense == "cw",
    )
    write_png(path, picture)


def _views(robot: Connection, timeout_s: float) -> Iterator[View]:
    """Views as they come; gaps are told. Raises PslvError unless the first one comes in time."""
    clock = MonotonicClock()
    deadline = after(clock.now(), timeout_s)
    waiting = True
    while True:
        patience_s = min(seconds_between(clock.now(), deadline), STALE_S) if waiting else STALE_S
        view = robot.receive(patience_s)
        if view is not None:
            waiting = False
            yield view
        elif waiting and clock.now() >= deadline:
            raise PslvError(f"{_why_silent(robot)}; no view within {timeout_s:g} s (--timeout)")
        else:
            print(f"pslv client: {_why_silent(robot)}", file=sys.stderr)


def _why_silent(robot: Connection) -> str:
    """The client asks a silent server every second: one that runs has just answered."""
    if robot.silent_s >= RESTART_S:
        return f"the server has not answered for {robot.silent_s:.0f} s: does it run?"
    who = f"{robot.init.team} {robot.init.number}"
    return f"connected as {who} from port {robot.port}, but the camera does not see it"


def _show(views: Iterator[View], robot: Connection, *, as_json: bool, picture: Path | None) -> None:
    """Print views; draw the last one at the end, also when that is Ctrl-C."""
    last = None
    try:
        for last in views:
            print(json.dumps(plain_from_view(last)) if as_json else sentence_from_view(last), flush=True)
    finally:
        if picture is not None and last is not None:
            draw(last, robot, picture)


def _within(least: int, most: int) -> Callable[[str], int]:
    def integer(text: str) -> int:
        value = int(text)
        if not least <= value <= most:
            raise argparse.ArgumentTypeError(f"{text} is not within {least}..{most}")
        return value

    return integer


def _seconds(text: str) -> float:
    seconds = float(text)
    if not 0.0 < seconds <= MAX_TIMEOUT_S:
        raise argparse.ArgumentTypeError(f"{text} is not within 0..{MAX_TIMEOUT_S:g} s")
    return seconds


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="pslv client",
        description="Be a robot: connect, and print what it sees.",
        epilog="Exit code 2, with one line that says why, when the server refuses, or no view comes in time.",
    )
    add = parser.add_argument
    add("--team", required=True, choices=[team.value for team in Team])
    add("--number", required=True, type=_within(1, MAX_NUMBER), help=f"of the robot, 1..{MAX_NUMBER}")
    add("--host", default="127.0.0.1", help="name or address of the server's computer [%(default)s]")
    add(
        "--port",
        type=_within(1, MAX_PORT),
        default=os.environ.get("PSLV_UDP_PORT") or "6000",
        help="UDP port of the server [that of the variable PSLV_UDP_PORT, else 6000]",
    )
    add("--count", type=_within(1, MAX_VIEWS), help="end after so many views [never]")
    add("--json", action="store_true", help="one line of JSON per view")
    add("--draw", type=Path, metavar="PNG", help="draw the last view as the on-board picture")
    add("--types", choices=["same", "team", "number"], default="same", help="how edges name robots")
    rate_help = f"at most so many views a second, 1..{FASTEST_HZ} [every frame]"
    add("--rate", type=_within(1, FASTEST_HZ), metavar="HZ", help=rate_help)
    abc = ("A", "B", "C")
    mirror_help = "ask for this mirror instead of the field's; metres are then right on any field"
    add("--mirror", type=float, nargs=3, metavar=abc, help=mirror_help)
    add(
        "--field-mirror",
        type=float,
        nargs=3,
        metavar=abc,
        help="the field's mirror is this one, asks for nothing: metres depend on it, and the server does not tell it."
        " It stands in the field's preset, config/fields/*.toml [that of the fields up to 3 m; --mirror goes before]",
    )
    timeout_help = "wait so long for the server's answer, then so long for the first view [%(default)g s]"
    add("--timeout", type=_seconds, default=5.0, metavar="S", help=timeout_help)
    return parser


if __name__ == "__main__":
    sys.exit(main())
