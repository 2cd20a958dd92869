"""Robots that the blobs do not show: looked for by their shape where one is expected. Compiled kernels.

A lamp's reflection on a paper, a shadow or a color that has drifted takes a marker's blobs away, not its shape. Two
sources say where to look: robots that were read in the last frames and are missing (*held*, at the place where they
should be by now), and places that a search of the whole picture suggests (``shape_search``; it takes too long for a
frame). There the pose is moved to where the marker's regions differ most, all patches are measured, and the id is that
whose paints explain them best, with white mixed in (``paint_residual``). A robot is confirmed only when its shape is
clear, no other id is nearly as good, and floor and white things explain the patches worse than its paints do.
"""

import math
from typing import Any, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from vision_core.geometry import Floats, frozen
from vision_core.models.camera_kernels import pixel_from_field, pixels_per_square_metre
from vision_core.native.angles import wrap_angle
from vision_core.native.kernels import kernel
from vision_core.objects.field_limits import is_accepted
from vision_core.objects.observation import Observation
from vision_core.objects.robots.buffers import MAX_SLOTS, PATCH_COLUMNS, Gates
from vision_core.objects.robots.finder import RobotFinder, order_robots
from vision_core.objects.robots.marker_reading import energy_of, is_doubtful, learn_references, measure_patches
from vision_core.objects.robots.marker_shape import LAST_STEP, ROOTS, Scene, fit_shape
from vision_core.objects.robots.markers import Marker
from vision_core.objects.robots.paint_residual import VEILS, X, Y
from vision_core.objects.robots.template import Template, template_of
from vision_core.patterns.worn import worn_patterns
from vision_core.settings.schema import Settings
from vision_core.types.colors import DARK_LEVEL
from vision_core.types.tables import MAX_ROBOTS, NO_ID, ROBOT, TEAMS, Table

Row: TypeAlias = Any
"""One row of a table."""

HELD = np.dtype(
    [
        ("team", np.int32), ("id", np.int32), ("marker", np.int32), ("missed", np.int32),
        ("x_m", np.float64), ("y_m", np.float64), ("heading_rad", np.float64),
        ("x_m_s", np.float64), ("y_m_s", np.float64), ("turn_rad_s", np.float64),
    ]
)  # fmt: skip
"""A robot of the last frames: its pose in the last one and its speed; missed: frames since it was last read."""

SUGGESTED = np.dtype(
    [("place", np.int32), ("marker", np.int32), ("x_m", np.float64), ("y_m", np.float64), ("heading_rad", np.float64)]
)
"""A pose where a marker may be. place: its number; poses of one place follow each other. marker: the first one that
looks the same without its colors."""
MAX_SUGGESTED = 64

MAX_MISSED = 10
"""So many frames a robot that is not seen is looked for where it should be."""
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


class Reading(NamedTuple):
    """Scratch: the best way to read a place, and what rivals it."""

    values: Floats
    """Energy, the second best's energy, that of plain things, the worst patch's energy, the shape's score; (5,)."""
    robot: Table
    """The best one, ROBOT, shape (1,)."""
    tried: Table
    """ROBOT, shape (1,)."""
    pose: Floats
    """Of ``fit_shape``."""
    patches: Floats
    """Of ``measure_patches``."""


ENERGY, SECOND, PLAIN, WORST, SCORE = range(5)


class Shapes(NamedTuple):
    """Where robots are expected, and what their markers look like. Kernels take it as one argument."""

    templates: tuple[Template, ...]
    """Of every marker."""
    looks: NDArray[np.int32]
    """Of every marker the first one that looks the same without its colors."""
    roots: Floats
    plain: Floats
    """See ``Scene``; all 0 while it is not known."""
    suggested: Table
    """SUGGESTED, shape (MAX_SUGGESTED,)."""
    held: Table
    """HELD, shape (MAX_ROBOTS,)."""
    counts: NDArray[np.int64]
    """How many are suggested and how many are held, shape (2,)."""
    reading: Reading


def shapes_from(settings: Settings, markers: tuple[Marker, ...]) -> Shapes:
    """The memory for both teams' markers; nothing is expected."""
    patterns = [pattern for team in TEAMS for pattern in worn_patterns(settings.robots, team)]
    templates = tuple(template_of(pattern) for pattern in patterns)
    looks = [
        next(
            other
            for other in range(len(markers))
            if templates[other].points_m.tobytes() == template.points_m.tobytes()
            and markers[other].height_m == marker.height_m
        )
        for marker, template in zip(markers, templates, strict=True)
    ]
    patches = np.zeros((1 + MAX_SLOTS, PATCH_COLUMNS))
    reading = Reading(np.zeros(5), np.zeros(1, dtype=ROBOT), np.zeros(1, dtype=ROBOT), np.zeros(5), patches)
    return Shapes(
        templates, frozen(np.array(looks, dtype=np.int32)), ROOTS, np.zeros(3),
        np.zeros(MAX_SUGGESTED, dtype=SUGGESTED), np.zeros(MAX_ROBOTS, dtype=HELD), np.zeros(2, dtype=np.int64),
        reading,
    )  # fmt: skip


@kernel
def confirm_robots(
    seen: Observation, finder: RobotFinder, shapes: Shapes, gap_s: float, robots: Table, count: int
) -> int:  # fmt: skip
    """Add robots that their shape shows to those of a frame, and hold all of them; returns how many there are.

    gap_s: since the last frame, negative for a picture without relation to it; robots: ROBOT, those found by blobs. One
    without an id gives way to the same one with its id.
    """
    if gap_s < 0.0:
        shapes.counts[1] = 0
    if _are_expected(shapes, robots, count):
        found = finder.buffers.found
        found[:count] = robots[:count]
        _learn(seen, finder, count)
        count = _confirm(seen, finder, shapes, max(gap_s, 0.0), count)
        order_robots(found, count, robots)
    _hold(shapes, finder.markers, max(gap_s, 0.0), robots, count)
    return count


@kernel
def _are_expected(shapes: Shapes, found: Table, count: int) -> bool:
    """Is there a place to look at?"""
    if shapes.counts[0] > 0:
        return True
    for number in range(shapes.counts[1]):
        if not _is_read(found, count, shapes.held[number].team, shapes.held[number].id):
            return True
    return False


@kernel
def _learn(seen: Observation, finder: RobotFinder, count: int) -> None:
    """What the paints look like in this frame, from the robots that are read."""
    found, markers, buffers = finder.buffers.found, finder.markers, finder.buffers
    buffers.learned[:] = 0.0
    for one in range(count):
        if found[one].id == NO_ID or math.isnan(found[one].heading_rad):
            continue
        marker, patches = markers[marker_with(markers, found[one].team, found[one].id)], buffers.patches[one]
        measure_patches(seen, marker, found[one], patches)
        if not is_doubtful(marker, patches):
            learn_references(marker, found[one].id, patches, buffers.learned)


@kernel
def _confirm(seen: Observation, finder: RobotFinder, shapes: Shapes, gap_s: float, count: int) -> int:
    """Add the robots that are confirmed to ``buffers.found``; returns how many there are."""
    markers, gates = finder.markers, finder.gates
    learned, found = finder.buffers.learned, finder.buffers.found
    scene = Scene(seen.pixels, shapes.roots, shapes.plain)
    reading = shapes.reading
    for number in range(shapes.counts[1]):
        held = shapes.held[number]
        if _is_read(found, count, held.team, held.id):
            continue
        _forget(reading)
        _try_pose(
            seen, scene, markers, shapes, held.marker, held.x_m + gap_s * held.x_m_s, held.y_m + gap_s * held.y_m_s,
            held.heading_rad + gap_s * held.turn_rad_s, learned, found, count,
        )  # fmt: skip
        robot = reading.robot[0]
        if reading.values[SCORE] >= HELD_SCORE and robot.team == held.team and robot.id == held.id:
            count = _add(seen, gates, shapes, markers, found, count)
    number = 0
    while number < shapes.counts[0]:
        place = shapes.suggested[number].place
        _forget(reading)
        while number < shapes.counts[0] and shapes.suggested[number].place == place:
            one = shapes.suggested[number]
            _try_pose(
                seen, scene, markers, shapes, one.marker, one.x_m, one.y_m, one.heading_rad, learned, found, count
            )
            number += 1
        robot = reading.robot[0]
        is_clear = (
            reading.values[SCORE] >= SUGGESTED_SCORE
            and reading.values[SECOND] - reading.values[ENERGY] >= MIN_MARGIN
        )  # fmt: skip
        if is_clear and not _is_read(found, count, robot.team, robot.id):
            count = _add(seen, gates, shapes, markers, found, count)
    return count


@kernel
def _forget(reading: Reading) -> None:
    reading.values[ENERGY] = reading.values[SECOND] = reading.values[PLAIN] = math.inf
    reading.values[WORST] = reading.values[SCORE] = 0.0
    reading.robot[0].id = NO_ID


@kernel
def _is_read(found: Table, count: int, team: int, number: int) -> bool:
    """Has a robot of a team an id already?"""
    for one in range(count):
        if found[one].team == team and found[one].id == number and not math.isnan(found[one].heading_rad):
            return True
    return False


@kernel
def _try_pose(
    seen: Observation, scene: Scene, markers: tuple[Marker, ...], shapes: Shapes, look: int, x_m: float, y_m: float,
    heading_rad: float, learned: Floats, found: Table, count: int,
) -> None:  # fmt: skip
    """Read what stands at a pose, and keep it if it is the best one at this place."""
    template, height_m, reading = shapes.templates[look], markers[look].height_m, shapes.reading
    pose, robot = reading.pose, reading.tried[0]
    pose[1], pose[2], pose[3], pose[4] = x_m, y_m, heading_rad, 1.0
    fit_shape(scene, seen.camera, template, height_m, FIRST_STEP * template.smallest_m, pose)
    robot.x_m, robot.y_m, robot.heading_rad, robot.confidence = pose[1], pose[2], pose[3], pose[0]
    if pose[0] < HELD_SCORE or math.hypot(pose[1] - x_m, pose[2] - y_m) > 0.5 * template.size_m:
        return
    if _is_taken(found, count, robot, OVERLAP * markers[look].radius_m):
        return
    for number in range(len(markers)):
        marker = markers[number]
        if shapes.looks[number] != look or marker.has_shapes:
            continue
        measure_patches(seen, marker, robot, reading.patches)
        for row in range(len(marker.ids)):
            energy, worst = energy_of(marker, row, reading.patches, learned, VEILS)
            _compare(reading, marker, int(marker.ids[row]), energy, worst, shapes.plain)


@kernel
def _is_taken(found: Table, count: int, robot: Row, apart_m: float) -> bool:
    """Is a robot that is read near a place?"""
    for one in range(count):
        other = found[one]
        near = math.hypot(other.x_m - robot.x_m, other.y_m - robot.y_m) < apart_m
        if near and other.id != NO_ID and not math.isnan(other.heading_rad):
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
def _add(
    seen: Observation, gates: Gates, shapes: Shapes, markers: tuple[Marker, ...], found: Table, count: int
) -> int:  # fmt: skip
    """Add the robot that was read, unless it is a plain thing or off the field; returns how many robots there are."""
    values, robot = shapes.reading.values, shapes.reading.robot[0]
    if values[PLAIN] - values[ENERGY] < MIN_GAIN or values[WORST] > MAX_MISFIT:
        return count
    if not is_accepted(robot.x_m, robot.y_m, 0.0, gates.extents_m):
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


@kernel
def marker_with(markers: tuple[Marker, ...], team: int, number: int) -> int:
    """The marker that a team's robot with an id wears."""
    for one in range(len(markers)):
        if markers[one].team == team:
            for row in range(len(markers[one].ids)):
                if markers[one].ids[row] == number:
                    return one
    return 0


@kernel
def _hold(shapes: Shapes, markers: tuple[Marker, ...], gap_s: float, robots: Table, count: int) -> None:
    """Expect the robots of this frame in the next one.

    gap_s: since the last frame; robots: ROBOT, what was found.
    """
    held = shapes.held
    kept = 0
    for number in range(shapes.counts[1]):
        held[kept] = held[number]
        kept += _follow(held[kept], gap_s, robots, count)
    for one in range(count):
        if robots[one].id == NO_ID or math.isnan(robots[one].heading_rad) or kept == MAX_ROBOTS:
            continue
        is_new = True
        for number in range(kept):
            is_new &= held[number].team != robots[one].team or held[number].id != robots[one].id
        if is_new:
            fresh = held[kept]
            fresh.team, fresh.id, fresh.missed = robots[one].team, robots[one].id, 0
            fresh.marker = shapes.looks[marker_with(markers, fresh.team, fresh.id)]
            fresh.x_m, fresh.y_m, fresh.heading_rad = robots[one].x_m, robots[one].y_m, robots[one].heading_rad
            fresh.x_m_s = fresh.y_m_s = fresh.turn_rad_s = 0.0
            kept += 1
    shapes.counts[1] = kept


@kernel
def _follow(held: Row, gap_s: float, robots: Table, count: int) -> bool:
    """Move a robot that is held to where it is now; whether it is held on."""
    for one in range(count):
        robot = robots[one]
        if robot.team == held.team and robot.id == held.id and not math.isnan(robot.heading_rad):
            if gap_s > 0.0:
                held.x_m_s, held.y_m_s = (robot.x_m - held.x_m) / gap_s, (robot.y_m - held.y_m) / gap_s
                held.turn_rad_s = wrap_angle(robot.heading_rad - held.heading_rad) / gap_s
            held.x_m, held.y_m, held.heading_rad, held.missed = robot.x_m, robot.y_m, robot.heading_rad, 0
            return True
    held.x_m, held.y_m = held.x_m + gap_s * held.x_m_s, held.y_m + gap_s * held.y_m_s
    held.heading_rad += gap_s * held.turn_rad_s
    held.missed += 1
    still: bool = held.missed <= MAX_MISSED
    return still
