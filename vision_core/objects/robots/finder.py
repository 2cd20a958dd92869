"""Robots by their markers: one compiled call from a frame's blobs to its robots."""

import math
from collections.abc import Callable
from typing import Any, NamedTuple, TypeAlias

import numpy as np

from vision_core.geometry import Mask, frozen
from vision_core.models.from_settings import robots_of
from vision_core.native.kernels import kernel
from vision_core.objects.field_limits import accepted_extents
from vision_core.objects.observation import Observation
from vision_core.objects.robots.buffers import FinderBuffers, Gates, finder_buffers
from vision_core.objects.robots.conflict_resolution import select_non_overlapping
from vision_core.objects.robots.hypothesis_generation import generate_hypotheses, locate_blobs
from vision_core.objects.robots.marker_reading import (
    is_doubtful,
    is_overexposed,
    learn_references,
    measure_patches,
    read_marker,
)
from vision_core.objects.robots.marker_weighing import weigh_hypotheses
from vision_core.objects.robots.markers import Marker, marker_of, marker_with
from vision_core.objects.robots.pose_refinement import refine_pose
from vision_core.patterns.pattern import Pattern
from vision_core.patterns.worn import colors_of, patterns_by_team
from vision_core.settings.schema import Settings
from vision_core.types.colors import ColorTable
from vision_core.types.tables import MAX_ROBOTS, NO_ID, TEAMS, Table

Row: TypeAlias = Any
"""One row of a table."""


class RobotFinder(NamedTuple):
    """What finding robots needs beside the frame. Kernels take it as one argument."""

    markers: tuple[Marker, ...]
    """Of blue, then of yellow; robots of a team may wear different ones."""
    gates: Gates
    buffers: FinderBuffers
    has_anchor: Mask
    """Which color classes a team's patch may have, shape (classes,)."""


def robot_finder(
    settings: Settings, table: ColorTable, change: Callable[[Pattern], Pattern] = lambda pattern: pattern,
    buffers: FinderBuffers | None = None,
) -> RobotFinder:  # fmt: skip
    """Make the finder of both teams' robots, with changed patterns. buffers: None for new ones.

    Raises SettingsError for a wrong pattern or colors without a class.
    """
    markers = markers_of(settings, table, change)
    buffers = buffers or finder_buffers(settings.blobs.max_blobs, len(markers))
    has_anchor = np.isin(np.arange(len(table.names)), [marker.anchor_class for marker in markers])
    return RobotFinder(markers, gates_from(settings), buffers, frozen(has_anchor))


def markers_of(
    settings: Settings, table: ColorTable, change: Callable[[Pattern], Pattern] = lambda pattern: pattern
) -> tuple[Marker, ...]:
    """The markers of both teams, blue's first, with changed patterns. Raises SettingsError as ``robot_finder``."""
    found: list[Marker] = []
    for team, patterns in patterns_by_team(settings.robots).items():
        robots, tolerance_m = robots_of(settings.robots, team), settings.robots.dot_tolerance_m
        colors = np.isin(table.names, colors_of({team: patterns}))
        found += [
            marker_of(change(pattern), robots, team, len(found) + place, table, tolerance_m, colors)
            for place, pattern in enumerate(patterns)
        ]
    return tuple(found)


def gates_from(settings: Settings) -> Gates:
    """The limits of the settings in the form that kernels take."""
    robots = settings.robots
    return Gates(
        min_area=robots.min_area,
        max_area=robots.max_area,
        tolerance_m=robots.dot_tolerance_m,
        min_confidence=robots.min_confidence,
        circle_sd_px=robots.circle_floor_px,
        polygon_sd_px=robots.polygon_floor_px,
        extents_m=accepted_extents(settings.field, robots.margin_m),
    )


@kernel
def find_robots(seen: Observation, finder: RobotFinder, known: int, robots: Table) -> int:
    """Fill a table with the robots that a frame shows, ordered by team and id; how many there are.

    known: robots that were verified, the first rows of ``buffers.found``; no blob is theirs. robots: ROBOT table with
    room for MAX_ROBOTS. (x_m, y_m) is the robot's center.
    """
    markers, gates, buffers = finder.markers, finder.gates, finder.buffers
    if not _shows_anchor(seen, finder.has_anchor):
        order_robots(buffers.found, known, robots)
        return known
    # hypotheses of both teams compete for the blobs
    count = int(np.int64(0))  # a plain 0 has a type of its own, and every function it is passed to compiles twice
    for marker in markers:
        listed = locate_blobs(seen, marker, gates, buffers)
        count = generate_hypotheses(seen, listed, marker, gates, buffers, count)
    if len(markers) > len(TEAMS):
        weigh_hypotheses(seen, markers, buffers, count)
    selected = min(select_non_overlapping(count, buffers), MAX_ROBOTS - known)
    for number in range(selected):
        hypothesis = buffers.hypotheses[buffers.selected[number]]
        refine_pose(
            seen, markers[hypothesis.marker], gates, buffers, hypothesis, buffers.ambiguous[number],
            buffers.found[known + number],
        )  # fmt: skip
        if buffers.alike[number]:
            buffers.found[known + number].id = NO_ID
    _read_markers(seen, markers, buffers, known, selected)
    order_robots(buffers.found, known + selected, robots)
    return known + selected


@kernel
def _shows_anchor(seen: Observation, has_anchor: Mask) -> bool:
    """Whether a blob may be a team's patch."""
    found = False
    for blob in range(seen.blob_count):
        found |= has_anchor[seen.blobs[blob].color]
    return found


@kernel
def _read_markers(
    seen: Observation, markers: tuple[Marker, ...], buffers: FinderBuffers, known: int, selected: int
) -> None:  # fmt: skip
    """Ids of robots that their blobs do not tell for sure: those read already show what the paints look like.

    Where the blobs tell all ids, the usual frame, nothing is measured.
    """
    if not _is_one_unsure(seen, markers, buffers, known, selected):
        return
    found, patches, learned = buffers.found, buffers.patches, buffers.learned
    learned[:] = 0.0
    for one in range(known):
        marker = markers[marker_with(markers, found[one].team, found[one].id)]
        measure_patches(seen, marker, found[one], patches[one])
        learn_references(marker, found[one].id, patches[one], learned)
    for number in range(selected):
        one, hypothesis = known + number, buffers.hypotheses[buffers.selected[number]]
        marker = markers[hypothesis.marker]
        buffers.unsure[one] = False
        if not marker.has_code or math.isnan(found[one].heading_rad) or buffers.alike[number]:
            continue
        measure_patches(seen, marker, found[one], patches[one])
        buffers.unsure[one] = found[one].id == NO_ID or is_doubtful(marker, patches[one])
        if not buffers.unsure[one]:
            learn_references(marker, found[one].id, patches[one], learned)
    for number in range(selected):
        one = known + number
        if buffers.unsure[one]:
            hypothesis = buffers.hypotheses[buffers.selected[number]]
            marker = markers[hypothesis.marker]
            read, certainty = read_marker(marker, hypothesis, patches[one], learned, found[one].id)
            if read != found[one].id:
                found[one].id = NO_ID if _is_taken(found, known + selected, one, read) else read
                found[one].confidence *= certainty


@kernel
def _is_one_unsure(
    seen: Observation, markers: tuple[Marker, ...], buffers: FinderBuffers, known: int, selected: int
) -> bool:  # fmt: skip
    """Has a robot with a heading no id, or a patch whose middle has two saturated channels?"""
    for number in range(selected):
        robot = buffers.found[known + number]
        hypothesis = buffers.hypotheses[buffers.selected[number]]
        marker = markers[hypothesis.marker]
        if not marker.has_code or math.isnan(robot.heading_rad) or buffers.alike[number]:
            continue
        if robot.id == NO_ID:
            return True
        for slot in range(len(marker.slots_m)):
            if is_overexposed(seen, hypothesis.slot_blobs[slot]):
                return True
    return False


@kernel
def _is_taken(found: Table, count: int, one: int, number: int) -> bool:
    """Whether another robot of its team has an id."""
    for other in range(count):
        if other != one and found[other].team == found[one].team and found[other].id == number:
            return True
    return False


@kernel
def order_robots(found: Table, count: int, robots: Table) -> None:
    """Copy robots in order. Two robots of a team with the same id cannot be told apart: both lose it."""
    for one in range(count):
        robot, number = found[one], int(found[one].id)
        if _is_taken(found, count, one, number):
            number = NO_ID
        place = one
        while place > 0 and _comes_before(robot, number, robots[place - 1]):
            robots[place] = robots[place - 1]
            place -= 1
        robots[place] = robot
        robots[place].id = number


@kernel
def _comes_before(robot: Row, number: int, other: Row) -> bool:
    """Order by team, then by id with unknown ids last, then by x. number: the robot's id."""
    if robot.team != other.team:
        return bool(robot.team < other.team)
    if number != other.id:
        return bool(other.id == NO_ID or (number != NO_ID and number < other.id))
    return bool(robot.x_m < other.x_m)
