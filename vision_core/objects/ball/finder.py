"""The ball, by gates: one compiled call from a frame's blobs to its balls.

A blob must pass every gate of ``GATES``, in that order; the first that stops it is its reason (``ball_reasons``).
What passes is a ball, and its center is refined: a circle is laid through its rim, where it can be seen. Of a ball
that is partly hidden the box tells where its center may be: the sides that are seen lie a radius from it.
"""

import math
from typing import Any, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from vision_core.geometry import Bytes, Floats, frozen
from vision_core.models.camera_kernels import CameraMap, field_from_pixel, pixels_per_square_metre
from vision_core.models.field import accepted_half_extent, goal_line_x
from vision_core.native.kernels import kernel
from vision_core.objects.circle_fit import SECTORS, SPHERE_INSIDE_PX, center_memory, fitted_circle
from vision_core.settings.schema import Settings
from vision_core.types.colors import ColorTable
from vision_core.types.tables import Table

Row: TypeAlias = Any
"""One row of a table."""

RING_POINTS = 24
RING_RADII = 1.8
"""Where the surroundings are looked at, in radii of the ball: outside its blurred rim, inside its shadow."""

ROUND_FILL = math.pi / 4.0
"""Share of its box that a disc fills."""

GATES = (
    "off the field",
    "too small (ball.min_area)",
    "too large (ball.max_area)",
    "too long (ball.max_elongation)",
    "too ragged (ball.min_fill)",
    "on a robot (ball.inside_robot_m)",
    "in the wrong surroundings (ball.surrounding)",
    "below ball.min_confidence",
)
"""What a blob is that does not pass, in the order of the gates."""
OFF_FIELD, TOO_SMALL, TOO_LARGE, TOO_LONG, TOO_RAGGED, ON_ROBOT, WRONG_SURROUNDINGS, UNLIKE, PASSED = range(9)

MOSTLY_SEEN = 12
"""Sectors of the rim that a circle must go through to be believed at once."""
HALF_SEEN = 7
"""And those of a ball that is partly hidden."""
SAME_RADIUS = 0.2
"""A round blob's own radius is believed rather than the predicted one when both differ by less."""
WHOLE_ELONGATION, WHOLE_SHARE = 1.25, 0.75
"""Longer, or smaller than predicted, a ball may be partly hidden."""
SMALL_PX = 6.0
"""Up to this radius the rim of what is seen of a ball and the rim of a ball cannot be told from each other."""
SHADE_SD_PX = 0.02
"""Deviation beyond what the fit tells: a ball's light and dark sides are the same for all of its sectors."""
HIDDEN_SD_PX = 0.8
"""Deviation by what cannot be seen, per share of the rim: errors of opposite sides do not cancel."""
HIDDEN_SHIFT = 0.85
"""How far a disc's centroid moves when a segment of it is hidden, in radii per share of its area: 0.42 for a half."""

_TURNS = np.arange(RING_POINTS) * (math.tau / RING_POINTS)
_RING = frozen(np.column_stack([np.cos(_TURNS), np.sin(_TURNS)]))


class BallFinder(NamedTuple):
    """All that finding balls needs beside the frame and the camera."""

    color: int
    """Class of the ColorTable."""
    radius_m: float
    min_area: float
    max_area: float
    max_elongation: float
    min_fill: float
    wanted: NDArray[np.bool_]
    """Which classes may surround it, shape (classes,)."""
    min_surrounding: float
    """Negative: not looked at."""
    inside_robot_m: float
    min_confidence: float
    field: Floats
    """Half extents of what is accepted x, y, of goals x, y, of the lines x, y [m], shape (6,)."""
    memory: Floats
    """Of ``center_memory``."""


class Candidate(NamedTuple):
    """A blob of the ball's color and what the gates ask of it."""

    x_m: float
    y_m: float
    """Point of the floor under it."""
    scale: float
    """Pixels per metre there."""
    share: float
    """Area over the predicted one."""
    elongation: float
    fill: float
    robot_m: float
    """Distance to the nearest robot's center, inf without robots."""
    surrounding: float
    """Share of the ring round it that has one of the surrounding classes."""
    confidence: float


def ball_finder(settings: Settings, table: ColorTable) -> BallFinder:
    """Make the finder of balls. table: of all classes that the surroundings ask for."""
    ball, field = settings.ball, settings.field
    goal = goal_line_x(field) + field.goal.depth_m, field.goal.width_m / 2.0
    extents = (*accepted_half_extent(field), *goal, field.length_m / 2.0, field.width_m / 2.0)
    return BallFinder(
        color=table.index(ball.color),
        radius_m=ball.radius_m,
        min_area=ball.min_area,
        max_area=ball.max_area,
        max_elongation=ball.max_elongation,
        min_fill=ball.min_fill,
        wanted=frozen(np.array([name in ball.surrounding for name in table.names], dtype=np.bool_)),
        min_surrounding=ball.min_surrounding if ball.surrounding else -1.0,
        inside_robot_m=ball.inside_robot_m,
        min_confidence=ball.min_confidence,
        field=frozen(np.array(extents, dtype=np.float64)),
        memory=center_memory(),
    )


@kernel
def find_balls(
    blobs: Table, count: int, pixels: Bytes, classes: Bytes, camera: CameraMap,
    robots: Table, robot_count: int, finder: BallFinder, balls: Table,
) -> int:  # fmt: skip
    """Fill a table with a frame's balls: those between the lines first, then by confidence; how many there are.

    blobs: BLOB table of which count rows hold; pixels: the frame, shape (height, width, 3); classes: of the
    ColorTable, shape (65536,); robots: ROBOT table of which robot_count rows hold; balls: BALL table, whose room
    is the most that are told.
    """
    found = 0
    for index in range(count):
        if blobs[index].color == finder.color:
            blob = blobs[index]
            candidate = judged(blob, pixels, classes, camera, robots, robot_count, finder)
            if stopping_gate(candidate, finder) == PASSED:
                found = _enter(blob, candidate, pixels, camera, finder, balls, found)
    return found


@kernel
def judged(
    blob: Row, pixels: Bytes, classes: Bytes, camera: CameraMap, robots: Table, robot_count: int, finder: BallFinder
) -> Candidate:
    """What the gates ask of a blob."""
    x, y = field_from_pixel(camera, blob.x_px, blob.y_px, finder.radius_m)
    scale2 = pixels_per_square_metre(camera, x, y, finder.radius_m)
    share = blob.area_px / (math.pi * finder.radius_m * finder.radius_m * scale2)
    wide, high = blob.right - blob.left + 1.0, blob.bottom - blob.top + 1.0
    elongation = max(wide, high) / min(wide, high)
    fill = blob.area_px / (wide * high)
    robot_m = np.inf
    for robot in range(robot_count):
        robot_m = min(robot_m, math.hypot(x - robots[robot].x_m, y - robots[robot].y_m))
    surrounding = 1.0
    if finder.min_surrounding >= 0.0:
        reach = RING_RADII * finder.radius_m * math.sqrt(scale2)
        surrounding = _surrounding(pixels, classes, blob.x_px, blob.y_px, reach, finder.wanted)
    likeness = math.sqrt(min(share, 1.0 / share)) * math.sqrt(1.0 / elongation) * min(fill / ROUND_FILL, 1.0)
    return Candidate(x, y, math.sqrt(scale2), share, elongation, fill, robot_m, surrounding, likeness)


@kernel
def stopping_gate(candidate: Candidate, finder: BallFinder) -> int:
    """The first gate that a candidate does not pass, or PASSED."""
    gate = PASSED
    if not candidate.confidence >= finder.min_confidence:
        gate = UNLIKE
    if not candidate.surrounding >= finder.min_surrounding:
        gate = WRONG_SURROUNDINGS
    if not candidate.robot_m >= finder.inside_robot_m:
        gate = ON_ROBOT
    if not candidate.fill >= finder.min_fill:
        gate = TOO_RAGGED
    if not candidate.elongation <= finder.max_elongation:
        gate = TOO_LONG
    if not candidate.share <= finder.max_area:
        gate = TOO_LARGE
    if not candidate.share >= finder.min_area:
        gate = TOO_SMALL
    if not _is_accepted(candidate.x_m, candidate.y_m, finder.radius_m, finder.field):
        gate = OFF_FIELD
    return gate


@kernel
def _is_accepted(x: float, y: float, tolerance: float, field: Floats) -> bool:
    """Is a place on the field, its margin or in a goal, or would be one tolerance nearer to the center?"""
    x, y = max(abs(x) - tolerance, 0.0), max(abs(y) - tolerance, 0.0)
    accepted: bool = (x <= field[0] and y <= field[1]) or (x <= field[2] and y <= field[3])
    return accepted


@kernel
def _surrounding(
    pixels: Bytes, classes: Bytes, x: float, y: float, reach: float, wanted: NDArray[np.bool_]
) -> float:  # fmt: skip
    """Share of a ring that has one of the wanted classes; the picture's outside has not."""
    height, width, _ = pixels.shape
    count = 0
    for k in range(RING_POINTS):
        u, v = round(x + reach * _RING[k, 0]), round(y + reach * _RING[k, 1])
        if 0 <= u < width and 0 <= v < height:
            blue, green, red = np.intp(pixels[v, u, 0]), np.intp(pixels[v, u, 1]), np.intp(pixels[v, u, 2])
            count += wanted[classes[(blue >> 3) << 11 | (green >> 2) << 5 | red >> 3]]
    return count / RING_POINTS


@kernel
def _enter(
    blob: Row, candidate: Candidate, pixels: Bytes, camera: CameraMap, finder: BallFinder, balls: Table, found: int
) -> int:
    """Put a ball in its place in the order; how many there are then. The last one of a full table is lost."""
    x_px, y_px, sd_px = _refined(blob, candidate, pixels, finder)
    x, y = _under_sphere(camera, x_px, y_px, finder.radius_m)
    outside = _is_outside(x, y, finder.field)
    place = found
    while place > 0:
        before = balls[place - 1]
        before_outside = _is_outside(before.x_m, before.y_m, finder.field)
        if before_outside < outside or (before_outside == outside and before.confidence >= candidate.confidence):
            break
        place -= 1
    if place == len(balls):
        return found
    last = min(found, len(balls) - 1)
    for row in range(last, place, -1):
        balls[row] = balls[row - 1]
    ball = balls[place]
    ball.x_px, ball.y_px, ball.x_m, ball.y_m = x_px, y_px, x, y
    ball.confidence = candidate.confidence
    ball.position_sd_m = math.sqrt(sd_px * sd_px + SHADE_SD_PX * SHADE_SD_PX) / candidate.scale
    return last + 1


@kernel
def _under_sphere(camera: CameraMap, x_px: float, y_px: float, radius: float) -> tuple[float, float]:
    """Where a sphere lies whose outline has its center at a pixel: off axis the outline's lies beyond the sphere's.

    In a distance d the outline is a circle of angle asin(r / d), and the mean of the tangents of its nearest and its
    farthest point is that of its middle times 1 + (r / h)^2 at the height h, to the second order.
    """
    x, y = field_from_pixel(camera, x_px, y_px, radius)
    eye = camera.position_m
    shrink = 1.0 - (radius / (eye[2] - radius)) ** 2
    return eye[0] + (x - eye[0]) * shrink, eye[1] + (y - eye[1]) * shrink


@kernel
def _is_outside(x: float, y: float, field: Floats) -> bool:
    return not (abs(x) <= field[4] and abs(y) <= field[5])


@kernel
def _refined(blob: Row, candidate: Candidate, pixels: Bytes, finder: BallFinder) -> tuple[float, float, float]:
    """A ball's center and its deviation [px]: of the circle that goes through most of its rim."""
    x, y, memory = blob.x_px, blob.y_px, finder.memory
    radius = finder.radius_m * candidate.scale
    own = math.sqrt(blob.area_px / math.pi)
    best_x, best_y, best_sd, most = fitted_circle(pixels, x, y, radius, x, y, SPHERE_INSIDE_PX, memory)
    if most < MOSTLY_SEEN and abs(own / radius - 1.0) < SAME_RADIUS:
        other_x, other_y, sd, used = fitted_circle(pixels, x, y, own, x, y, SPHERE_INSIDE_PX, memory)
        if used > most:
            best_x, best_y, best_sd, most = other_x, other_y, sd, used
    whole = candidate.elongation < WHOLE_ELONGATION and candidate.share > WHOLE_SHARE
    if whole and most >= MOSTLY_SEEN:
        return best_x, best_y, best_sd + HIDDEN_SD_PX * (SECTORS - most) / SECTORS
    shift = HIDDEN_SHIFT * max(1.0 - candidate.share, 0.0) * radius
    beyond = radius - 0.5  # a box ends in the middle of its last pixel
    for corner in range(9):
        across, along = corner % 3, corner // 3
        start_x = (x, blob.left + beyond, blob.right - beyond)[across]
        start_y = (y, blob.top + beyond, blob.bottom - beyond)[along]
        other_x, other_y, sd, used = fitted_circle(pixels, start_x, start_y, radius, x, y, SPHERE_INSIDE_PX, memory)
        if used > most or (used == most and sd < best_sd):
            best_x, best_y, best_sd, most = other_x, other_y, sd, used
    if most < HALF_SEEN:
        return x, y, 0.1 * radius + shift
    best_sd += HIDDEN_SD_PX * (SECTORS - most) / SECTORS
    return best_x, best_y, best_sd if radius > SMALL_PX else best_sd + shift
