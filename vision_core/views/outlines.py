"""What stands on the field beside walls and goals: robots and obstacles of a world, as outlines with an edge kind.

A robot is a circle or, where its team's outline says so, a square turned by its heading. A square whose heading is
not known is the circle that fits into it whichever way it is turned. An obstacle is a circle of its own radius.
"""

import math
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from vision_core.geometry import Bytes, Floats
from vision_core.native.kernels import kernel
from vision_core.types.field import EdgeKind
from vision_core.types.tables import MAX_OBSTACLES, MAX_ROBOTS, Table

Integers: TypeAlias = NDArray[np.int64]
Row: TypeAlias = Any
"""One row of a table, as kernels see it: its fields are attributes."""

BODY = np.dtype(
    [
        ("x_m", np.float64), ("y_m", np.float64), ("radius_m", np.float64),
        ("cos", np.float64), ("sin", np.float64), ("square", np.int32), ("kind", np.int32),
    ]
)  # fmt: skip
"""An outline: center, radius or half of the side, direction of a square's sides, EdgeKind."""
MAX_BODIES = MAX_ROBOTS + MAX_OBSTACLES
HEADING_KNOWN_RAD = 1.0
"""A heading's deviation above this tells no direction."""
UNKNOWN = int(EdgeKind.UNKNOWN)


@kernel
def lay_out(world: Table, kind_of_id: Bytes, team_radius_m: Floats, team_square: Integers, bodies: Table) -> int:
    """Fill in the outlines of a world's robots, in its order, then of its obstacles; returns how many there are.

    world: WORLD, shape (1,); kind_of_id: EdgeKind of a team's robot by 1 + its id, shape (2, 257); team_radius_m,
    team_square: shape (2,); bodies: BODY, shape (MAX_BODIES,).
    """
    robots, obstacles = world[0].robots, world[0].obstacles
    count = world[0].counts[0]
    for k in range(count):
        team, marker = robots[k].team, robots[k].id
        bodies[k].x_m, bodies[k].y_m = robots[k].x_m, robots[k].y_m
        bodies[k].radius_m = team_radius_m[team]
        bodies[k].cos, bodies[k].sin = math.cos(robots[k].heading_rad), math.sin(robots[k].heading_rad)
        known = robots[k].heading_sd_rad <= HEADING_KNOWN_RAD and math.isfinite(robots[k].heading_rad)
        bodies[k].square = team_square[team] if known else 0
        bodies[k].kind = kind_of_id[team, marker + 1 if 0 <= marker < 256 else 0]
    for k in range(world[0].counts[2]):
        body = bodies[count]
        body.x_m, body.y_m, body.radius_m = obstacles[k].x_m, obstacles[k].y_m, obstacles[k].radius_m
        body.square, body.kind = 0, UNKNOWN
        count += 1
    return int(count)


@kernel
def holder(x_m: float, y_m: float, own: int, bodies: Table, count: int) -> int:
    """The body whose outline holds a point, the one with the nearest center; -1 when there is none."""
    found, nearest = -1, math.inf
    for k in range(count):
        dx, dy = x_m - bodies[k].x_m, y_m - bodies[k].y_m
        radius = bodies[k].radius_m
        if k == own or abs(dx) > 1.5 * radius or abs(dy) > 1.5 * radius:
            continue
        away = math.sqrt(dx * dx + dy * dy)
        if bodies[k].square:
            along, aside = dx * bodies[k].cos + dy * bodies[k].sin, dy * bodies[k].cos - dx * bodies[k].sin
            held = max(abs(along), abs(aside)) <= radius
        else:
            held = away <= radius
        if held and away <= nearest:
            found, nearest = k, away
    return found


@kernel
def corner(body: Row, k: int) -> tuple[float, float]:
    """Corner k of a square body, anticlockwise from the front right one (0..3; 4 is 0 again)."""
    ahead = body.radius_m if k % 4 < 2 else -body.radius_m
    left = body.radius_m if 1 <= k % 4 <= 2 else -body.radius_m
    return body.x_m + ahead * body.cos - left * body.sin, body.y_m + ahead * body.sin + left * body.cos
