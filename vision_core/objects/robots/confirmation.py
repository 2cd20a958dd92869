"""Robots that the blobs do not show: looked for by their shape where one is expected. Compiled kernels.

A lamp's reflection on a paper, a shadow or a color that has drifted takes a marker's blobs away, not its shape. Two
sources say where to look: robots that were read in the last frames and are missing (``held``), and places that a search
of the whole picture suggests (``shape_search``; it takes too long for a frame). There the pose is moved to where the
marker's regions differ most, all patches are measured, and the id is that whose paints explain them best, with white
mixed in (``paint_residual``). A robot is confirmed only when its shape is clear, no other id is nearly as good, and
floor and white things explain the patches worse than its paints do.
"""

import math
from typing import Any, TypeAlias

from vision_core.geometry import Floats
from vision_core.models.camera_kernels import pixel_from_field, pixels_per_square_metre
from vision_core.native.angles import wrap_angle
from vision_core.native.kernels import kernel
from vision_core.objects.field_limits import is_accepted
from vision_core.objects.observation import Observation
from vision_core.objects.robots.confirmation_buffers import (
    ENERGY,
    PLAIN,
    SCORE,
    SECOND,
    WORST,
    Reading,
    Shapes,
)
from vision_core.objects.robots.finder import RobotFinder, order_robots
from vision_core.objects.robots.held import NO_ROW, HeldRobots, is_read, row_of
from vision_core.objects.robots.marker_reading import energy_of, is_doubtful, learn_references, measure_patches
from vision_core.objects.robots.marker_shape import LAST_STEP, Scene, fit_marker
from vision_core.objects.robots.markers import Marker, marker_with
from vision_core.objects.robots.paint_residual import VEILS, X, Y
from vision_core.types.colors import DARK_LEVEL
from vision_core.types.tables import MAX_ROBOTS, NO_ID, Table

Row: TypeAlias = Any
"""One row of a table."""

FIRST_STEP = 0.25
"""With which a pose is moved, as a share of the smallest patch's width."""
OVERLAP = 1.7
"""Two robots' centers are at least so many radii apart."""
APART = 0.6
"""A robot that is not read, nearer than this share of the marker's size, is the same one."""
HELD_SCORE, SUGGESTED_SCORE = 0.5, 0.65
"""How clear the shape must be (``marker_shape.score_of``): of a robot that was there before; of a new one."""
MIN_MARGIN = 5.0
"""Energy that any other robot must need beyond the best one."""
MIN_GAIN = 5.0
"""Energy that floor and white things must need beyond the paints."""
MAX_MISFIT = 30.0
"""Energy of one patch beyond which no paint explains it."""
PLAIN_SD = 0.1
"""Standard deviation of the chromaticity of floor and white things."""
PIXEL_SD = 0.3
"""Of a pose by its shape [px]."""


@kernel
def confirm_robots(
    seen: Observation, finder: RobotFinder, shapes: Shapes, held: HeldRobots, robots: Table, count: int
) -> int:  # fmt: skip
    """Add robots that their shape shows to those of a frame; returns how many there are.

    held: those of this frame and of the last ones; robots: ROBOT, those found by blobs. One without an id gives way to
    the same one with its id.
    """
    found = finder.buffers.found
    found[:count] = robots[:count]
    _learn(seen, finder, count)
    count = _confirm_missing(seen, finder, shapes, held, count)
    count = _confirm_suggested(seen, finder, shapes, count)
    order_robots(found, count, robots)
    return count


@kernel
def _learn(seen: Observation, finder: RobotFinder, count: int) -> None:
    """What the paints look like in this frame, from the robots that are read."""
    found, markers, buffers = finder.buffers.found, finder.markers, finder.buffers
    buffers.learned[:] = 0.0
    for one in range(count):
        if not is_read(found[one]):
            continue
        marker, patches = markers[marker_with(markers, found[one].team, found[one].id)], buffers.patches[one]
        measure_patches(seen, marker, found[one], patches)
        if not is_doubtful(marker, patches):
            learn_references(marker, found[one].id, patches, buffers.learned)


@kernel
def _confirm_missing(seen: Observation, finder: RobotFinder, shapes: Shapes, held: HeldRobots, count: int) -> int:
    """Add robots that are missing to ``buffers.found``; returns how many robots there are."""
    reading = shapes.reading
    for number in range(held.size[0]):
        missing = held.robots[number]
        if missing.missed == 0:
            continue
        _forget(reading)
        look = shapes.looks[marker_with(finder.markers, missing.team, missing.id)]
        _try_pose(seen, finder, shapes, look, missing.x_m, missing.y_m, missing.heading_rad, count)
        robot = reading.robot[0]
        if reading.values[SCORE] >= HELD_SCORE and robot.team == missing.team and robot.id == missing.id:
            count = _add(seen, finder, shapes, count)
    return count


@kernel
def _confirm_suggested(seen: Observation, finder: RobotFinder, shapes: Shapes, count: int) -> int:
    """Add robots that a search suggests to ``buffers.found``; returns how many robots there are."""
    suggested, reading, found = shapes.suggested, shapes.reading, finder.buffers.found
    number = 0
    while number < shapes.size[0]:
        place = suggested[number].place
        _forget(reading)
        while number < shapes.size[0] and suggested[number].place == place:
            one = suggested[number]
            if not _is_taken(found, count, one.x_m, one.y_m, OVERLAP * finder.markers[one.marker].radius_m):
                _try_pose(seen, finder, shapes, one.marker, one.x_m, one.y_m, one.heading_rad, count)
            number += 1
        robot, values = reading.robot[0], reading.values
        is_clear = values[SCORE] >= SUGGESTED_SCORE and values[SECOND] - values[ENERGY] >= MIN_MARGIN
        if is_clear and row_of(found, count, robot.team, robot.id) == NO_ROW:
            count = _add(seen, finder, shapes, count)
    return count


@kernel
def _forget(reading: Reading) -> None:
    reading.values[ENERGY] = reading.values[SECOND] = reading.values[PLAIN] = math.inf
    reading.values[WORST] = reading.values[SCORE] = 0.0
    reading.robot[0].id = NO_ID


@kernel
def _try_pose(
    seen: Observation, finder: RobotFinder, shapes: Shapes, look: int, x_m: float, y_m: float, heading_rad: float,
    count: int,
) -> None:  # fmt: skip
    """Read what stands at a pose, and keep it if it is the best one at this place.

    look: the first marker that looks the same without its colors.
    """
    markers, template, reading = finder.markers, shapes.templates[look], shapes.reading
    scene, height_m = Scene(seen.pixels, shapes.roots, shapes.plain), markers[look].height_m
    pose, robot = reading.pose, reading.tried[0]
    pose[1], pose[2], pose[3] = x_m, y_m, heading_rad
    fit_marker(scene, seen.camera, template, height_m, FIRST_STEP * template.smallest_m, pose)
    robot.x_m, robot.y_m, robot.heading_rad, robot.confidence = pose[1], pose[2], pose[3], pose[0]
    if pose[0] < HELD_SCORE or math.hypot(pose[1] - x_m, pose[2] - y_m) > 0.5 * template.size_m:
        return
    if _is_taken(finder.buffers.found, count, robot.x_m, robot.y_m, OVERLAP * markers[look].radius_m):
        return
    for number in range(len(markers)):
        marker = markers[number]
        if shapes.looks[number] != look or marker.has_shapes:
            continue
        measure_patches(seen, marker, robot, reading.patches)
        for row in range(len(marker.ids)):
            energy, worst = energy_of(marker, row, reading.patches, finder.buffers.learned, VEILS)
            _compare(reading, marker, int(marker.ids[row]), energy, worst, shapes.plain)


@kernel
def _is_taken(found: Table, count: int, x_m: float, y_m: float, apart_m: float) -> bool:
    """Is a robot that is read near a place?"""
    for one in range(count):
        other = found[one]
        if is_read(other) and math.hypot(other.x_m - x_m, other.y_m - y_m) < apart_m:
            return True
    return False


@kernel
def _compare(reading: Reading, marker: Marker, number: int, energy: float, worst: float, plain: Floats) -> None:
    """Keep the best reading of a place, and the energy of the best one that is another robot."""
    values, best, tried = reading.values, reading.robot[0], reading.tried[0]
    is_same = best.id == number and best.team == marker.team
    if energy >= values[ENERGY]:
        if not is_same:
            values[SECOND] = min(values[SECOND], energy)
        return
    if not is_same:
        values[SECOND] = values[ENERGY]
    values[ENERGY], values[WORST], values[SCORE] = energy, worst, tried.confidence
    best.team, best.id = marker.team, number
    best.x_m, best.y_m, best.heading_rad = tried.x_m, tried.y_m, wrap_angle(tried.heading_rad)
    best.confidence = tried.confidence
    values[PLAIN] = _plain_energy(reading.patches, marker.worn.shape[1], plain)


@kernel
def _plain_energy(patches: Floats, count: int, plain: Floats) -> float:
    """The energy of patches if they were no paints: each is white or grey, or looks like the floor."""
    green = (plain[2] - plain[0] - plain[1]) / 3.0
    floor_green = math.log(green * green + DARK_LEVEL)
    floor_x = math.log((green + plain[0]) ** 2 + DARK_LEVEL) - floor_green
    floor_y = math.log((green + plain[1]) ** 2 + DARK_LEVEL) - floor_green
    energy = 0.0
    for patch in range(count):
        x, y = patches[patch, X], patches[patch, Y]
        nearest = min(x * x + y * y, (x - floor_x) ** 2 + (y - floor_y) ** 2)
        energy += nearest / PLAIN_SD**2 + 4.0 * math.log(PLAIN_SD)
    return energy


@kernel
def _add(seen: Observation, finder: RobotFinder, shapes: Shapes, count: int) -> int:
    """Add the robot that was read, unless it is a plain thing or off the field; returns how many robots there are."""
    markers, found = finder.markers, finder.buffers.found
    values, robot = shapes.reading.values, shapes.reading.robot[0]
    if values[PLAIN] - values[ENERGY] < MIN_GAIN or values[WORST] > MAX_MISFIT:
        return count
    if not is_accepted(robot.x_m, robot.y_m, 0.0, finder.gates.extents_m):
        return count
    marker = marker_with(markers, robot.team, robot.id)
    template, height_m = shapes.templates[marker], markers[marker].height_m
    robot.x_px, robot.y_px = pixel_from_field(seen.camera, robot.x_m, robot.y_m, height_m)
    scale = math.sqrt(pixels_per_square_metre(seen.camera, robot.x_m, robot.y_m, height_m))
    robot.position_sd_m = math.hypot(FIRST_STEP * LAST_STEP * template.smallest_m, PIXEL_SD / scale)
    robot.heading_sd_rad = 2.0 * robot.position_sd_m / template.size_m
    place = count
    for one in range(count):
        if math.hypot(found[one].x_m - robot.x_m, found[one].y_m - robot.y_m) < APART * template.size_m:
            place = one
    if place == MAX_ROBOTS:
        return count
    found[place] = robot
    return max(count, place + 1)
