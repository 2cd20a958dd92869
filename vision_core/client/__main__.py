"""``python -m vision_core.client``: connect as a robot, and print or draw its views."""

import argparse
import itertools
import json
import logging
import math
import os
import sys
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

from vision_core.client.connecting import connect
from vision_core.client.connection import RESTART_S, Connection
from vision_core.client.own_camera import OpenPictures, OwnCamera, add_camera_options, own_camera
from vision_core.client.panorama import draw_view
from vision_core.client.png import write_png
from vision_core.client.view import View
from vision_core.clock import MS_PER_S, MonotonicClock, after, seconds_between
from vision_core.errors import PslvError
from vision_core.geometry import Bytes
from vision_core.models.mirror import Mirror
from vision_core.protocol.error_codes import MEANINGS, ErrorCode
from vision_core.protocol.messages import MAX_NUMBER
from vision_core.protocol.options import MAX_RATE_HZ, Options
from vision_core.types.objects import Team

FAILED = 2
STALE_S = 5.0
"""Without a view for so long, the reason is printed."""
MAX_TIMEOUT_S = 86400.0
MAX_VIEWS = 10**9
MAX_PORT = 65535


def main(arguments: Sequence[str] | None = None, open_pictures: OpenPictures | None = None) -> int:
    """Run the command; returns its exit code: 0, also after Ctrl-C; 2 with one line on what went wrong.

    open_pictures: reads the pictures of a file or folder for ``--camera``: NumPy alone reads none.
    """
    asked = _parser().parse_args(arguments)
    logging.basicConfig(format="pslv client: %(message)s", force=True)
    try:
        mirror = Mirror(*asked.mirror) if asked.mirror else None
        options = Options(types=asked.types, rate_hz=asked.rate, mirror=mirror)
        field_mirror = Mirror(*asked.field_mirror) if asked.field_mirror else None
        eye = own_camera(asked, open_pictures) if asked.camera else None
        robot = connect(
            asked.host,
            asked.port,
            asked.team,
            asked.number,
            options=options,
            mirror=field_mirror,
            key=asked.key,
            timeout_s=asked.timeout,
        )
        with robot:
            views = itertools.islice(_views(robot, asked.timeout), asked.count)
            _show(views, robot, eye, as_json=asked.json, picture=asked.draw)
    except PslvError as error:
        print(f"pslv client: {error}", file=sys.stderr)
        return FAILED
    except KeyboardInterrupt:
        return 0
    except BrokenPipeError:  # the reader of our output has closed it
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


def plain_age_of(view: View) -> dict[str, float | None]:
    """Its age as JSON types: null while the server's clock is not known."""
    is_known = math.isfinite(view.age_s)
    return {"age_s": view.age_s if is_known else None, "age_bound_s": view.age_bound_s if is_known else None}


def sentence_from_view(view: View) -> str:
    """A view in one line for people."""
    lag = ""
    if math.isfinite(view.age_s):
        lag = f"lag {view.age_s * MS_PER_S:.1f} +- {view.age_bound_s * MS_PER_S:.1f} ms, "
    return f"{view.time_s:10.3f} s, {lag}{view.summary}"


def _views(robot: Connection, timeout_s: float) -> Iterator[View]:
    """Views as they arrive; prints the reason of a gap. Raises PslvError unless the first one arrives in time."""
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
    """Why no view arrives. A silent server is asked once a second, so one that runs has answered lately."""
    if robot.last_error == ErrorCode.NOT_READY:
        return MEANINGS[ErrorCode.NOT_READY]
    if robot.silent_s >= RESTART_S:
        return f"the server has not answered for {robot.silent_s:.0f} s: does it run?"
    name = f"{robot.init.team} {robot.init.number}"
    return f"connected as {name} from port {robot.port}, but the camera does not see it"


def _show(
    views: Iterator[View], robot: Connection, eye: OwnCamera | None, *, as_json: bool, picture: Path | None
) -> None:
    """Print views, beside the camera's pictures if there are some; draw the last one at the end, also after Ctrl-C."""
    last = None
    try:
        for view in views:
            told, said = plain_from_view(view) | plain_age_of(view), sentence_from_view(view)
            if eye is not None:
                if not eye.look(view, robot.mirror):
                    break
                told["camera"], said = eye.plain, f"{said}; camera: {eye.sentence}"
            last = view
            print(json.dumps(told) if as_json else said, flush=True)
    finally:
        if picture is not None and last is not None:
            write_png(picture, drawing_of(last, robot, eye))


def drawing_of(view: View, robot: Connection, eye: OwnCamera | None) -> Bytes:
    """The view as the simulated on-board picture of the paper's figure 6, with a camera's beside it; red green blue."""
    options = robot.init.options
    return draw_view(view, robot.mirror, options) if eye is None else eye.draw(view, robot.mirror, options)


def _within(minimum: int, maximum: int) -> Callable[[str], int]:
    def integer(text: str) -> int:
        value = int(text)
        if not minimum <= value <= maximum:
            raise argparse.ArgumentTypeError(f"{text} is not within {minimum}..{maximum}")
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
        description="Connect as a robot, and print its views.",
        epilog="Exit code 2, and one line with the reason, when the server refuses or no view arrives in time.",
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
    key_help = (
        "the team's key, from the referee; others on this computer can read arguments, but not PSLV_KEY [PSLV_KEY]"
    )
    add("--key", default=os.environ.get("PSLV_KEY") or "", help=key_help)
    add("--count", type=_within(1, MAX_VIEWS), help="number of views to print [no limit]")
    add("--json", action="store_true", help="one line of JSON per view")
    add("--draw", type=Path, metavar="PNG", help="draw the last view as the picture of an on-board camera")
    add("--types", choices=["same", "team", "number"], default="same", help="how edge types name robots")
    rate_help = f"at most so many views a second, 1..{MAX_RATE_HZ} [every frame]"
    add("--rate", type=_within(1, MAX_RATE_HZ), metavar="HZ", help=rate_help)
    abc = ("A", "B", "C")
    mirror_help = "have the server render the views through this mirror, in place of its field's"
    add("--mirror", type=float, nargs=3, metavar=abc, help=mirror_help)
    field_mirror_help = (
        "the mirror of the server's field, for a server that does not tell it: see the field's preset,"
        " config/fields/*.toml [the server is asked]; --mirror overrides it"
    )
    add("--field-mirror", type=float, nargs=3, metavar=abc, help=field_mirror_help)
    timeout_help = "wait so long for the server's answer, and then for the first view [%(default)g s]"
    add("--timeout", type=_seconds, default=5.0, metavar="S", help=timeout_help)
    add_camera_options(parser)
    return parser


if __name__ == "__main__":
    sys.exit(main())
