"""Robots by their markers: one compiled call from a frame's blobs to its robots."""

from typing import NamedTuple

import numpy as np

from vision_core.geometry import Bytes, frozen
from vision_core.models.camera_kernels import CameraMap
from vision_core.models.field import accepted_half_extent, goal_line_x
from vision_core.models.from_settings import robots_of
from vision_core.native.kernels import kernel
from vision_core.objects.robots.buffers import TEAM, Gates, Memory, take_memory
from vision_core.objects.robots.conflict_resolution import compete
from vision_core.objects.robots.hypothesis_generation import place_blobs, propose
from vision_core.objects.robots.markers import Marker, marker_of
from vision_core.objects.robots.pose_refinement import refine_pose
from vision_core.patterns.loader import load_pattern
from vision_core.settings.schema import Settings
from vision_core.types.colors import ColorTable
from vision_core.types.tables import NO_ID, TEAMS, Table


class RobotFinder(NamedTuple):
    """All that finding robots needs beside the frame and the camera."""

    markers: tuple[Marker, Marker]
    """Of blue and yellow."""
    gates: Gates
    memory: Memory


def robot_finder(settings: Settings, table: ColorTable) -> RobotFinder:
    """Make the finder of both teams' robots. Raises SettingsError for a wrong pattern or colors without a class."""
    blue, yellow = (
        marker_of(load_pattern(robots.pattern), robots, team, number, table, settings.robots.dot_tolerance_m)
        for number, team in enumerate(TEAMS)
        for robots in [robots_of(settings.robots, team)]
    )
    return RobotFinder((blue, yellow), gates_from(settings), take_memory(settings.blobs.max_blobs))


def gates_from(settings: Settings) -> Gates:
    """What settings accept, as kernels take it."""
    robots, field = settings.robots, settings.field
    beyond = robots.margin_m
    goal = goal_line_x(field) + field.goal.depth_m + beyond, field.goal.width_m / 2.0 + beyond
    return Gates(
        min_area=robots.min_area,
        max_area=robots.max_area,
        tolerance_m=robots.dot_tolerance_m,
        min_confidence=robots.min_confidence,
        center_floor_px=robots.circle_floor_px,
        edge_floor_px=robots.polygon_floor_px,
        field_m=frozen(np.array([*(half + beyond for half in accepted_half_extent(field)), *goal])),
    )


@kernel
def find_robots(
    blobs: Table, count: int, pixels: Bytes, classes: Bytes, camera: CameraMap, finder: RobotFinder, robots: Table
) -> int:
    """Fill a table with the robots that a frame shows, ordered by team and id; how many there are.

    blobs: BLOB table of which count rows hold; pixels: the frame, shape (height, width, 3); classes: of the
    ColorTable, shape (65536,); robots: ROBOT table with room for MAX_ROBOTS. (x_m, y_m) is the robot's center.
    """
    markers, gates, memory = finder.markers, finder.gates, finder.memory
    rows = int(np.int64(0))  # a plain 0 is a type of its own, for which all that it is passed to is compiled twice
    for marker in markers:
        listed = place_blobs(blobs, count, camera, marker, gates, memory)
        rows = propose(blobs, listed, pixels, classes, camera, marker, gates, memory, rows)
    won = compete(rows, memory)
    for winner in range(won):
        row = memory.rows[memory.winners[winner]]
        refine_pose(
            blobs, pixels, camera, markers[int(row[TEAM])], gates, memory, row, memory.ambiguous[winner],
            memory.found[winner],
        )  # fmt: skip
    _order(memory.found, won, robots)
    return won


@kernel
def _order(found: Table, count: int, robots: Table) -> None:
    """Copy robots in order. Which of two with the same id is which cannot be told: both lose it."""
    for one in range(count):
        place = 0
        for other in range(count):
            if other != one and _comes_before(found, count, other, one):
                place += 1
        robots[place] = found[one]
        robots[place].id = _worn(found, count, one)


@kernel
def _worn(found: Table, count: int, one: int) -> int:
    """A robot's id, if no other of its team wears it."""
    number: int = found[one].id
    for other in range(count):
        if other != one and found[other].team == found[one].team and found[other].id == number:
            return NO_ID
    return number


@kernel
def _comes_before(found: Table, count: int, one: int, other: int) -> bool:
    """By team, then id, those without one last, then x."""
    if found[one].team != found[other].team:
        return bool(found[one].team < found[other].team)
    first, second = _worn(found, count, one), _worn(found, count, other)
    if first != second:
        return second == NO_ID or (first != NO_ID and first < second)
    if found[one].x_m != found[other].x_m:
        return bool(found[one].x_m < found[other].x_m)
    return one < other
