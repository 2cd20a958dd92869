"""Robots of the last frames, held where they should be by now: a missing one is looked for there. Compiled kernels."""

import math
from typing import Any, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from vision_core.native.angles import wrap_angle
from vision_core.native.kernels import kernel
from vision_core.types.tables import MAX_ROBOTS, NO_ID, Table

Row: TypeAlias = Any
"""One row of a table."""

HELD = np.dtype(
    [
        ("team", np.int32), ("id", np.int32), ("missed", np.int32),
        ("x_m", np.float64), ("y_m", np.float64), ("heading_rad", np.float64),
        ("x_m_s", np.float64), ("y_m_s", np.float64), ("turn_rad_s", np.float64),
    ]
)  # fmt: skip
"""A robot of the last frames: its pose in this one, as it was read or as it should be, and its speed; missed: frames
since it was last read."""

MAX_MISSED = 10
"""So many frames a robot that is not read is looked for where it should be."""
NO_ROW = -1
"""Where a table has no row of a robot."""


class HeldRobots(NamedTuple):
    """The robots that are held. Kernels take it as one argument."""

    robots: Table
    """HELD, shape (MAX_ROBOTS,)."""
    size: NDArray[np.int64]
    """How many there are, shape (1,)."""


def held_robots() -> HeldRobots:
    """The memory; no robot is held."""
    return HeldRobots(np.zeros(MAX_ROBOTS, dtype=HELD), np.zeros(1, dtype=np.int64))


@kernel
def move_robots(held: HeldRobots, gap_s: float) -> None:
    """Move the robots of the last frames to where they should be by now; they are missing until they are read.

    gap_s: since the last frame, negative for a picture without relation to it: no robot is held any longer.
    """
    kept = 0
    for number in range(held.size[0] if gap_s >= 0.0 else 0):
        if held.robots[number].missed < MAX_MISSED:
            held.robots[kept] = held.robots[number]
            _move(held.robots[kept], gap_s)
            kept += 1
    held.size[0] = kept


@kernel
def hold_read(held: HeldRobots, gap_s: float, robots: Table, count: int) -> bool:
    """Hold the robots of this frame where they are read; is one missing that was held before?

    gap_s: as of ``move_robots``, which was called before; robots: ROBOT.
    """
    known, kept = held.robots, held.size[0]
    is_missing = False
    for number in range(kept):
        one = row_of(robots, count, known[number].team, known[number].id)
        if one == NO_ROW:
            is_missing = True
        else:
            _correct(known[number], gap_s, robots[one])
    for one in range(count):
        robot = robots[one]
        if is_read(robot) and kept < MAX_ROBOTS and row_of(known, kept, robot.team, robot.id) == NO_ROW:
            known[kept].team, known[kept].id = robot.team, robot.id
            known[kept].x_m_s = known[kept].y_m_s = known[kept].turn_rad_s = 0.0
            _correct(known[kept], 0.0, robot)
            kept += 1
    held.size[0] = kept
    return is_missing


@kernel
def _move(held: Row, gap_s: float) -> None:
    """Move a robot on; it is missing until it is read."""
    held.x_m, held.y_m = held.x_m + gap_s * held.x_m_s, held.y_m + gap_s * held.y_m_s
    held.heading_rad += gap_s * held.turn_rad_s
    held.missed += 1


@kernel
def _correct(held: Row, gap_s: float, robot: Row) -> None:
    """Set a robot that was moved on to where it is read."""
    if gap_s > 0.0:
        held.x_m_s += (robot.x_m - held.x_m) / gap_s
        held.y_m_s += (robot.y_m - held.y_m) / gap_s
        held.turn_rad_s += wrap_angle(robot.heading_rad - held.heading_rad) / gap_s
    held.x_m, held.y_m, held.heading_rad, held.missed = robot.x_m, robot.y_m, robot.heading_rad, 0


@kernel
def is_read(robot: Row) -> bool:
    """Has a robot an id and a heading?"""
    return robot.id != NO_ID and not math.isnan(robot.heading_rad)


@kernel
def row_of(robots: Table, count: int, team: int, number: int) -> int:
    """The row of the robot of a team that is read with an id; NO_ROW where none is."""
    for one in range(count):
        if robots[one].team == team and robots[one].id == number and is_read(robots[one]):
            return one
    return NO_ROW
