"""``(show Time {thing})``: the whole field for a monitor; the datagram and back.

Things in their order: the ball, the robots, the obstacles; whole millimetres, heading in tenths of a degree. A datagram
has at most 1400 bytes: what does not fit is left out, obstacles first.

    (show 12.345 ((ball) 120 -35 800 0) ((robot blue 3) -450 20 90.0 0 0) ((robot yellow) 10 10 - 0 0))
"""

import math
from collections.abc import Iterator, Mapping, Sequence
from itertools import accumulate

from vision_core.clock import NS_PER_US, Instant
from vision_core.models.mirror import MM_PER_M
from vision_core.protocol.encoding import time_word
from vision_core.protocol.messages import Show, ShownBall, ShownObstacle, ShownRobot
from vision_core.protocol.s_expressions import Form, real
from vision_core.protocol.words import TIME, number_of, team_of, time_us
from vision_core.types.objects import Team
from vision_core.types.tracks import RobotTrack, World

MAX_SHOW = 1400
"""Longest datagram [bytes], as of every message of the server."""
UNKNOWN = "-"


def encode_show(world: World, boot: Instant, numbers: Mapping[tuple[Team, int | None], int]) -> bytes:
    """The datagram of a world. boot: where Time is 0; numbers: of each robot, by team and marker id."""
    head = f"(show {time_word((world.at - boot) // NS_PER_US)}"
    things = list(_things(world, numbers))
    lengths = accumulate((1 + len(thing) for thing in things), initial=len(head) + 1)
    fitting = sum(length <= MAX_SHOW for length in lengths) - 1
    return f"{' '.join((head, *things[:fitting]))})".encode("ascii")


def decode_show(words: Sequence[str | Form]) -> Show | None:
    """What follows the word ``show``; things of other kinds are skipped. None when the Time is none."""
    match words[:1]:
        case (str(time),) if when := TIME.fullmatch(time.encode("ascii")):
            things = [shown for word in words[1:] if (shown := _thing(word)) is not None]
        case _:
            return None
    return Show(
        time_us(*when.groups()),
        next((thing for thing in things if isinstance(thing, ShownBall)), None),
        tuple(thing for thing in things if isinstance(thing, ShownRobot)),
        tuple(thing for thing in things if isinstance(thing, ShownObstacle)),
    )


def _things(world: World, numbers: Mapping[tuple[Team, int | None], int]) -> Iterator[str]:
    if (ball := world.ball) is not None:
        yield f"((ball) {_mm(ball.x_m, ball.y_m, ball.vx_m_s, ball.vy_m_s)})"
    for robot in world.robots:
        name = f"{robot.team} {numbers.get((robot.team, robot.id), '')}".rstrip()
        place, velocity = _mm(robot.x_m, robot.y_m), _mm(robot.vx_m_s, robot.vy_m_s)
        yield f"((robot {name}) {place} {_heading(robot)} {velocity})"
    for obstacle in world.obstacles:
        yield f"((obstacle) {_mm(obstacle.x_m, obstacle.y_m, obstacle.radius_m)})"


def _heading(robot: RobotTrack) -> str:
    return UNKNOWN if math.isnan(robot.heading_rad) else f"{math.degrees(robot.heading_rad):.1f}"


def _mm(*lengths_m: float) -> str:
    return " ".join(str(round(MM_PER_M * length_m)) for length_m in lengths_m)


def _thing(word: str | Form) -> ShownBall | ShownRobot | ShownObstacle | None:
    if not isinstance(word, tuple):
        return None
    numbers = [real(part) for part in word[1:]]
    match word[0], numbers:
        case (("ball",), (float(x), float(y), float(vx), float(vy))):
            return ShownBall(x, y, vx, vy)
        case (("robot", name, *rest), (float(x), float(y), heading, float(vx), float(vy))) if team := team_of(name):
            return ShownRobot(team, number_of(rest[0]) if rest else None, x, y, heading, vx, vy)
        case (("obstacle",), (float(x), float(y), float(radius))):
            return ShownObstacle(x, y, radius)
    return None
