"""The outlines of a world's robots and obstacles, each with its edge kind.

A robot is a circle or, where its team's settings say so, a square turned by its heading. A square of unknown heading is
replaced by its inscribed circle, which it covers at every heading. An obstacle is a circle of its own radius.
"""

import math
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from vision_core.geometry import Bytes, Floats
from vision_core.native.kernels import kernel
from vision_core.types.edges import EdgeKind
from vision_core.types.tables import MAX_OBSTACLES, MAX_ROBOTS, Table

Integers: TypeAlias = NDArray[np.int64]
Row: TypeAlias = Any
"""One row of a table in a kernel: its fields are attributes."""

OUTLINE = np.dtype(
    [
        ("x_m", np.float64), ("y_m", np.float64), ("radius_m", np.float64),
        ("cos", np.float64), ("sin", np.float64), ("square", np.int32), ("kind", np.int32),
    ]
)  # fmt: skip
"""A circle or, if square, a square: center, radius or half the side, direction of the heading, EdgeKind."""
MAX_OUTLINES = MAX_ROBOTS + MAX_OBSTACLES
MAX_HEADING_SD_RAD = 1.0
"""A heading with a larger standard deviation is unknown."""
UNKNOWN = int(EdgeKind.UNKNOWN)


@kernel
def collect_outlines(
    world: Table, kind_of_id: Bytes, team_radius_m: Floats, team_square: Integers, outlines: Table
) -> int:
    """Fill in the outlines of a world's robots, in its order, then of its obstacles; returns how many there are.

    world: WORLD, shape (1,); kind_of_id: EdgeKind of a team's robot by 1 + its id, shape (2, 257); team_radius_m,
    team_square: shape (2,); outlines: OUTLINE, shape (MAX_OUTLINES,).
    """
    robots, obstacles = world[0].robots, world[0].obstacles
    count = world[0].counts[0]
    for k in range(count):
        team, marker = robots[k].team, robots[k].id
        outlines[k].x_m, outlines[k].y_m = robots[k].x_m, robots[k].y_m
        outlines[k].radius_m = team_radius_m[team]
        outlines[k].cos, outlines[k].sin = math.cos(robots[k].heading_rad), math.sin(robots[k].heading_rad)
        known = robots[k].heading_sd_rad <= MAX_HEADING_SD_RAD and math.isfinite(robots[k].heading_rad)
        outlines[k].square = team_square[team] if known else 0
        outlines[k].kind = kind_of_id[team, marker + 1 if 0 <= marker < 256 else 0]
    for k in range(world[0].counts[2]):
        outline = outlines[count]
        outline.x_m, outline.y_m, outline.radius_m = obstacles[k].x_m, obstacles[k].y_m, obstacles[k].radius_m
        outline.square, outline.kind = 0, UNKNOWN
        count += 1
    return int(count)


@kernel
def containing_outline(x_m: float, y_m: float, own: int, outlines: Table, count: int) -> int:
    """The outline, other than own, that contains a point; of several the one with the nearest center; -1 for none."""
    found, nearest = -1, math.inf
    for k in range(count):
        dx, dy = x_m - outlines[k].x_m, y_m - outlines[k].y_m
        radius = outlines[k].radius_m
        if k == own or abs(dx) > 1.5 * radius or abs(dy) > 1.5 * radius:  # 1.5 > sqrt(2): outside of a square, too
            continue
        distance = math.sqrt(dx * dx + dy * dy)
        if outlines[k].square:
            along, aside = dx * outlines[k].cos + dy * outlines[k].sin, dy * outlines[k].cos - dx * outlines[k].sin
            contains = max(abs(along), abs(aside)) <= radius
        else:
            contains = distance <= radius
        if contains and distance <= nearest:
            found, nearest = k, distance
    return found


@kernel
def corner(outline: Row, k: int) -> tuple[float, float]:
    """Corner k of a square, anticlockwise from the front right one (0..3; 4 is 0 again) [m]."""
    ahead = outline.radius_m if k % 4 < 2 else -outline.radius_m
    left = outline.radius_m if 1 <= k % 4 <= 2 else -outline.radius_m
    return (
        outline.x_m + ahead * outline.cos - left * outline.sin,
        outline.y_m + ahead * outline.sin + left * outline.cos,
    )
