"""``python -m vision_core.client``: be a robot, and print or draw what it sees."""

import argparse
import json
import math
import os
import sys
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from vision_core.client.connection import Connection, connect
from vision_core.client.view import View
from vision_core.errors import PslvError
from vision_core.mirror_model import MM_PER_M, Mirror
from vision_core.protocol.options import Options
from vision_core.types.objects import Team

FAILED = 2
STALE_S = 5.0
LONGEST_TIMEOUT_S = 86400.0


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command; returns its exit code: 0, also after Ctrl-C; 2 with one line on what went wrong."""
    asked = _parser().parse_args(arguments)
    try:
        mirror = Mirror(*asked.mirror) if asked.mirror else None
        options = Options(types=asked.types, rate_hz=asked.rate, mirror=mirror)
        with connect(
            asked.host, asked.port, asked.team, asked.number, options=options, timeout_s=asked.timeout
        ) as robot:
            _follow(robot, asked.count, as_json=asked.json, picture=asked.draw)
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
    said = [f"{view.time_s:10.3f} s"]
    if len(view.mm) and math.isfinite(nearest_mm := view.mm.min()):
        where = int(np.argmin(view.mm))
        letter, direction = view.letters[where], view.directions_deg[where]
        said.append(f"nearest {letter} at {nearest_mm / MM_PER_M:.2f} m, {direction:.0f} deg")
    ball = view.ball
    away = f"at {view.ball_mm / MM_PER_M:.2f} m, {ball.direction_deg} deg"
    said.append("ball hidden" if ball.hidden else f"ball {away}")
    return ", ".join(said)


def draw(view: View, robot: Connection, path: Path) -> None:
    """Write the view as the simulated on-board picture of the paper's figure 6."""
    from vision_core.png import write_png
    from vision_core.views.panorama import draw_panorama

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


def _follow(robot: Connection, count: int | None, *, as_json: bool, picture: Path | None) -> None:
    """Print views as they come; draw the last one at the end, also when that is Ctrl-C."""
    last, seen = None, 0
    try:
        while count is None or seen < count:
            view = robot.receive(STALE_S)
            if view is None:
                print("pslv client: no view: does the camera see the robot, does the server run?", file=sys.stderr)
                continue
            last, seen = view, seen + 1
            print(json.dumps(plain_from_view(view)) if as_json else sentence_from_view(view), flush=True)
    finally:
        if picture is not None and last is not None:
            draw(last, robot, picture)


def _seconds(text: str) -> float:
    seconds = float(text)
    if not 0.0 < seconds <= LONGEST_TIMEOUT_S:
        raise argparse.ArgumentTypeError(f"{text} is not within 0..{LONGEST_TIMEOUT_S:g} s")
    return seconds


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="pslv client", description="Be a robot: connect, and print what it sees.")
    parser.add_argument("--team", required=True, choices=[team.value for team in Team])
    parser.add_argument("--number", required=True, type=int, help="of the robot, from 1")
    parser.add_argument("--host", default="127.0.0.1", help="of the server [%(default)s]")
    parser.add_argument("--port", type=int, default=6000, help="UDP port of the server [%(default)s]")
    parser.add_argument("--count", type=int, help="end after so many views [never]")
    parser.add_argument("--json", action="store_true", help="one line of JSON per view")
    parser.add_argument("--draw", type=Path, metavar="PNG", help="draw the last view as the on-board picture")
    parser.add_argument("--types", choices=["same", "team", "number"], default="same", help="how edges name robots")
    parser.add_argument("--rate", type=int, metavar="HZ", help="at most so many views a second [every frame]")
    parser.add_argument("--mirror", type=float, nargs=3, metavar=("A", "B", "C"), help="ask for this mirror")
    parser.add_argument("--timeout", type=_seconds, default=5.0, help="wait so long for an answer [%(default)s s]")
    return parser


if __name__ == "__main__":
    sys.exit(main())
