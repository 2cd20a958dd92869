"""The ball, by a sequence of gates: one compiled call from a frame's blobs to its balls.

A blob must pass every gate of ``GATES``, in that order; the first that stops it is the reason given for it
(``reasons``). A blob that passes is a ball. Its center is refined by fitting a circle to the visible part of its edge.
The bounding box of a ball that is partly hidden limits where its center can be: a visible side lies one radius from it.
"""

import math
from typing import Any, NamedTuple, TypeAlias

import numpy as np

from vision_core.geometry import Bytes, Floats, Mask, frozen
from vision_core.models.camera_kernels import CameraMap, field_from_pixel, pixels_per_square_metre
from vision_core.native.kernels import kernel
from vision_core.objects.circle_fit import SECTORS, SPHERE_INSIDE_PX, circle_buffer, fitted_circle
from vision_core.objects.field_limits import accepted_extents, is_accepted
from vision_core.objects.observation import Observation
from vision_core.settings.schema import Settings
from vision_core.types.color_cells import color_cell
from vision_core.types.colors import ColorTable
from vision_core.types.tables import Table

Row: TypeAlias = Any
"""One row of a table."""

RING_POINTS = 24
RING_RADII = 1.8
"""Radius of the ring on which the surroundings are judged, in radii of the ball: outside its blurred edge, inside its
shadow."""

DISC_FILL = math.pi / 4.0
"""Share of its bounding box that a disc fills."""

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
"""What is wrong with a blob that a gate stops, in the order of the gates."""
OFF_FIELD, TOO_SMALL, TOO_LARGE, TOO_LONG, TOO_RAGGED, ON_ROBOT, WRONG_SURROUNDINGS, LOW_CONFIDENCE, PASSED = range(9)

WHOLE_SUPPORT = 12
"""Sectors of the edge that must support a circle to believe it without further trials."""
HALF_SUPPORT = 7
"""The same for a ball that is partly hidden."""
SAME_RADIUS = 0.2
"""Relative difference up to which the radius of a round blob is tried instead of the predicted one."""
WHOLE_ELONGATION, WHOLE_AREA = 1.25, 0.75
"""A ball that is longer, or has a smaller share of the predicted area, may be partly hidden."""
SMALL_PX = 6.0
"""Up to this radius the edge of the visible part and the edge of the ball cannot be told apart."""
SHADING_SD_PX = 0.02
"""Deviation beside that of the fit: a ball's light and dark side shift all of its sectors alike."""
HIDDEN_SD_PX = 0.8
"""Deviation per hidden share of the edge: errors of opposite sides do not cancel."""
HIDDEN_SHIFT = 0.85
"""How far a disc's centroid moves when a segment of it is hidden, in radii per share of its area: 0.42 for a half."""

_ANGLES = np.arange(RING_POINTS) * (math.tau / RING_POINTS)
_RING = frozen(np.column_stack([np.cos(_ANGLES), np.sin(_ANGLES)]))


class BallFinder(NamedTuple):
    """What finding balls needs beside the frame. Kernels take it as one argument."""

    color: int
    """Class of the ColorTable."""
    radius_m: float
    min_area: float
    """Of the blob, as a share of the area predicted."""
    max_area: float
    max_elongation: float
    min_fill: float
    surrounding_classes: Mask
    """Which classes may surround it, shape (classes,)."""
    min_surrounding: float
    """Share of the ring that must have them; negative: not judged."""
    inside_robot_m: float
    min_confidence: float
    extents_m: Floats
    """Where balls are accepted, see ``field_limits``; shape (4,)."""
    half_field_m: Floats
    """Half length and half width between the lines, shape (2,)."""
    circle: Table
    """Of ``circle_buffer``."""


class Candidate(NamedTuple):
    """What the gates judge of a blob of the ball's color."""

    x_m: float
    y_m: float
    """Point of the floor under it."""
    scale: float
    """Pixels per metre there."""
    area_ratio: float
    """Area over the predicted one."""
    elongation: float
    """Longer side of its box over the shorter."""
    fill: float
    """Share of its box that it fills."""
    robot_m: float
    """Distance to the nearest robot's center, inf without robots."""
    surrounding: float
    """Share of the ring round it that has one of the surrounding classes."""
    confidence: float


def ball_finder(settings: Settings, table: ColorTable) -> BallFinder:
    """Make the finder of balls. table: with the ball's class and all classes of its surroundings."""
    ball, field = settings.ball, settings.field
    return BallFinder(
        color=table.index(ball.color),
        radius_m=ball.radius_m,
        min_area=ball.min_area,
        max_area=ball.max_area,
        max_elongation=ball.max_elongation,
        min_fill=ball.min_fill,
        surrounding_classes=frozen(np.array([name in ball.surrounding for name in table.names], dtype=np.bool_)),
        min_surrounding=ball.min_surrounding if ball.surrounding else -1.0,
        inside_robot_m=ball.inside_robot_m,
        min_confidence=ball.min_confidence,
        extents_m=accepted_extents(field),
        half_field_m=frozen(np.array([field.length_m / 2.0, field.width_m / 2.0])),
        circle=circle_buffer(),
    )


@kernel
def find_balls(seen: Observation, robots: Table, robot_count: int, finder: BallFinder, balls: Table) -> int:
    """Fill a table with a frame's balls: those between the lines first, then by confidence; how many there are.

    robots: ROBOT table of which robot_count rows hold; balls: BALL table; when it is full the last ones are left out.
    """
    found = 0
    for index in range(seen.blob_count):
        if seen.blobs[index].color == finder.color:
            blob = seen.blobs[index]
            candidate = judged(blob, seen, robots, robot_count, finder)
            if stopping_gate(candidate, finder) == PASSED:
                found = _insert(blob, candidate, seen, finder, balls, found)
    return found


@kernel
def judged(blob: Row, seen: Observation, robots: Table, robot_count: int, finder: BallFinder) -> Candidate:
    """Measure what the gates judge of a blob."""
    # area and outline, compared with those of a ball at this place
    x, y = field_from_pixel(seen.camera, blob.x_px, blob.y_px, finder.radius_m)
    scale2 = pixels_per_square_metre(seen.camera, x, y, finder.radius_m)
    area_ratio = blob.area_px / (math.pi * finder.radius_m * finder.radius_m * scale2)
    wide, high = blob.right - blob.left + 1.0, blob.bottom - blob.top + 1.0
    elongation = max(wide, high) / min(wide, high)
    fill = blob.area_px / (wide * high)
    robot_m = np.inf
    for robot in range(robot_count):
        robot_m = min(robot_m, math.hypot(x - robots[robot].x_m, y - robots[robot].y_m))
    surrounding = 1.0
    if finder.min_surrounding >= 0.0:
        reach = RING_RADII * finder.radius_m * math.sqrt(scale2)
        surrounding = _surrounding(
            seen.pixels, seen.classes, blob.x_px, blob.y_px, reach, finder.surrounding_classes
        )  # fmt: skip
    area_score = math.sqrt(min(area_ratio, 1.0 / area_ratio))
    confidence = area_score * math.sqrt(1.0 / elongation) * min(fill / DISC_FILL, 1.0)
    return Candidate(x, y, math.sqrt(scale2), area_ratio, elongation, fill, robot_m, surrounding, confidence)


@kernel
def stopping_gate(candidate: Candidate, finder: BallFinder) -> int:
    """The first gate that stops a candidate, or PASSED. Judged backwards, so that an earlier gate overrides."""
    gate = PASSED
    if not candidate.confidence >= finder.min_confidence:
        gate = LOW_CONFIDENCE
    if not candidate.surrounding >= finder.min_surrounding:
        gate = WRONG_SURROUNDINGS
    if not candidate.robot_m >= finder.inside_robot_m:
        gate = ON_ROBOT
    if not candidate.fill >= finder.min_fill:
        gate = TOO_RAGGED
    if not candidate.elongation <= finder.max_elongation:
        gate = TOO_LONG
    if not candidate.area_ratio <= finder.max_area:
        gate = TOO_LARGE
    if not candidate.area_ratio >= finder.min_area:
        gate = TOO_SMALL
    if not is_accepted(candidate.x_m, candidate.y_m, finder.radius_m, finder.extents_m):
        gate = OFF_FIELD
    return gate


@kernel
def _surrounding(
    pixels: Bytes, classes: Bytes, x: float, y: float, reach: float, surrounding_classes: Mask
) -> float:  # fmt: skip
    """Share of the points on a ring that have one of the surrounding classes; points outside the picture have none."""
    height, width, _ = pixels.shape
    count = 0
    for k in range(RING_POINTS):
        u, v = round(x + reach * _RING[k, 0]), round(y + reach * _RING[k, 1])
        if 0 <= u < width and 0 <= v < height:
            count += surrounding_classes[classes[color_cell(pixels[v, u, 0], pixels[v, u, 1], pixels[v, u, 2])]]
    return count / RING_POINTS


@kernel
def _insert(
    blob: Row, candidate: Candidate, seen: Observation, finder: BallFinder, balls: Table, found: int
) -> int:  # fmt: skip
    """Insert a ball at its place in the order; the new count. The last ball of a full table is dropped."""
    x_px, y_px, sd_px = _refined(blob, candidate, seen.pixels, finder)
    x, y = _center_of_sphere(seen.camera, x_px, y_px, finder.radius_m)
    # go up past all balls that come after it
    outside = _is_outside(x, y, finder.half_field_m)
    place = found
    while place > 0:
        before = balls[place - 1]
        before_outside = _is_outside(before.x_m, before.y_m, finder.half_field_m)
        if before_outside < outside or (before_outside == outside and before.confidence >= candidate.confidence):
            break
        place -= 1
    if place == len(balls):
        return found
    # move those down by one row
    last = min(found, len(balls) - 1)
    for row in range(last, place, -1):
        balls[row] = balls[row - 1]
    ball = balls[place]
    ball.x_px, ball.y_px, ball.x_m, ball.y_m = x_px, y_px, x, y
    ball.confidence = candidate.confidence
    ball.position_sd_m = math.sqrt(sd_px * sd_px + SHADING_SD_PX * SHADING_SD_PX) / candidate.scale
    return last + 1


@kernel
def _center_of_sphere(camera: CameraMap, x_px: float, y_px: float, radius: float) -> tuple[float, float]:
    """Place of a sphere on the floor, from the center of its outline, which lies farther off axis than the sphere's.

    At the distance d the outline is a circle of angle asin(r / d). The mean of the tangents of its nearest and its
    farthest point is the tangent of its middle times 1 + (r / h)^2 at the height h, to the second order.
    """
    x, y = field_from_pixel(camera, x_px, y_px, radius)
    eye = camera.position_m
    shrink = 1.0 - (radius / (eye[2] - radius)) ** 2
    return eye[0] + (x - eye[0]) * shrink, eye[1] + (y - eye[1]) * shrink


@kernel
def _is_outside(x: float, y: float, half_field_m: Floats) -> bool:
    """Whether a place is beyond the field's lines."""
    return not (abs(x) <= half_field_m[0] and abs(y) <= half_field_m[1])


@kernel
def _refined(blob: Row, candidate: Candidate, pixels: Bytes, finder: BallFinder) -> tuple[float, float, float]:
    """A ball's center and its deviation [px]: that of the circle with the most support by the picture."""
    x, y, buffer = blob.x_px, blob.y_px, finder.circle
    radius = finder.radius_m * candidate.scale
    # at the centroid, with the predicted radius or the blob's own
    own = math.sqrt(blob.area_px / math.pi)
    best_x, best_y, best_sd, most = fitted_circle(pixels, x, y, radius, x, y, SPHERE_INSIDE_PX, buffer)
    if most < WHOLE_SUPPORT and abs(own / radius - 1.0) < SAME_RADIUS:
        other_x, other_y, sd, support = fitted_circle(pixels, x, y, own, x, y, SPHERE_INSIDE_PX, buffer)
        if support > most:
            best_x, best_y, best_sd, most = other_x, other_y, sd, support
    whole = candidate.elongation < WHOLE_ELONGATION and candidate.area_ratio > WHOLE_AREA
    if whole and most >= WHOLE_SUPPORT:
        return best_x, best_y, best_sd + HIDDEN_SD_PX * (SECTORS - most) / SECTORS
    # partly hidden: at the places that have one or two sides of the box as their edge
    shift = HIDDEN_SHIFT * max(1.0 - candidate.area_ratio, 0.0) * radius
    beyond = radius - 0.5  # a box ends in the middle of its last pixel
    for corner in range(9):
        across, along = corner % 3, corner // 3
        start_x = (x, blob.left + beyond, blob.right - beyond)[across]
        start_y = (y, blob.top + beyond, blob.bottom - beyond)[along]
        other_x, other_y, sd, support = fitted_circle(pixels, start_x, start_y, radius, x, y, SPHERE_INSIDE_PX, buffer)
        if support > most or (support == most and sd < best_sd):
            best_x, best_y, best_sd, most = other_x, other_y, sd, support
    if most < HALF_SUPPORT:
        return x, y, 0.1 * radius + shift
    best_sd += HIDDEN_SD_PX * (SECTORS - most) / SECTORS
    return best_x, best_y, best_sd if radius > SMALL_PX else best_sd + shift
