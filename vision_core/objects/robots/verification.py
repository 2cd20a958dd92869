"""Known robots are verified, not searched: each patch is measured at the place where it should be. Compiled kernels.

A robot that was read in the last frame is predicted into this one, and its marker's patches with it:

1. ``_cross``: from the predicted place of a patch the run of its color across and along gives its center to a fraction
   of a pixel and its size. A pixel of another class, a saturated color, or a wrong size ends the verification.
2. ``_place_starts``: one shift and turn in the picture brings the predicted places to the measured ones.
3. ``_refine`` refines every center from there by ``fitted_circle``, and ``fit_pose`` fits the pose to all of them, as
   for robots that are searched. Each patch must be within the tolerance of its place.

A verified robot has all patches, each in the color of its id, so no other hypothesis is better and none is made. Every
other robot, also one that was swapped, covered or lifted, fails here and is searched. Only markers whose patches are
all circles are verified (``Marker.is_verifiable``).
"""

import math
from typing import Any, TypeAlias

import numpy as np

from vision_core.geometry import Bytes, Floats
from vision_core.models.camera_kernels import pixel_from_field
from vision_core.native.kernels import kernel
from vision_core.native.pixel_reads import prefetch
from vision_core.objects.circle_fit import OUTSIDE_PX, PAPER_INSIDE_PX, fitted_circle
from vision_core.objects.field_limits import is_accepted
from vision_core.objects.observation import Observation
from vision_core.objects.robots.buffers import FinderBuffers, Gates
from vision_core.objects.robots.finder import RobotFinder
from vision_core.objects.robots.held import NO_ROW, HeldRobots
from vision_core.objects.robots.hypothesis_generation import area_score
from vision_core.objects.robots.marker_reading import SATURATED_LEVEL, pixel_frame
from vision_core.objects.robots.markers import Marker, row_of_id
from vision_core.objects.robots.pose_refinement import fit_pose, place_in_robot
from vision_core.types.color_cells import class_at
from vision_core.types.tables import TEAMS

Row: TypeAlias = Any
"""One row of a table."""

LONGEST = 1.5
"""A run longer than so many diameters is no patch's."""
CLOSE_PX = 0.3
"""Predictions that seem to be off by less than this are right: a run tells no more."""
ROUNDS, STILL_PX = 3, 0.08
"""A robot's centers are refined so many times at most, until that moves it by less than this."""
X, Y, AREA = range(3)
SD = AREA
"""Columns of ``FinderBuffers.crossed``: the area, then the center's deviation."""


@kernel
def verify_robots(seen: Observation, finder: RobotFinder, held: HeldRobots) -> int:
    """Measure the robots that were read in the last frame where they should be now; how many are there as they were.

    held: moved on to this frame (``move_robots``). The verified robots fill ``buffers.found`` from its first row.
    """
    verified = int(np.int64(0))
    if len(finder.markers) > len(TEAMS):  # other markers of a team would have to be ruled out
        return verified
    flat = seen.pixels.reshape(-1)
    for marker in finder.markers:
        if marker.is_verifiable:
            verified = _verify_team(seen, flat, marker, finder.gates, finder.buffers, held, verified)
    return verified


@kernel
def _verify_team(
    seen: Observation, flat: Bytes, marker: Marker, gates: Gates, buffers: FinderBuffers, held: HeldRobots,
    verified: int,
) -> int:  # fmt: skip
    """Append the robots with a marker that are as they were to the verified ones; the new number of these."""
    candidate, turn = NO_ROW, 0
    for number in range(held.size[0] + 1):
        is_last = number == held.size[0]
        if not is_last:
            robot = held.robots[number]
            if robot.team != marker.team or robot.missed != 1:
                continue
            # its pixels come to the cache while the one before it is measured
            _predict(seen, flat, marker, robot, buffers.predicted[1 - turn])
        if candidate != NO_ROW:
            predicted, found = buffers.predicted[turn], buffers.found[verified]
            if _verify(seen, flat, marker, gates, buffers, predicted, held.robots[candidate], found):
                buffers.known_px2[verified] = (marker.radius_m * predicted.px_m) ** 2
                verified += 1
        candidate, turn = number, 1 - turn
    return verified


@kernel
def _predict(seen: Observation, flat: Bytes, marker: Marker, known: Row, predicted: Row) -> None:
    """Where a robot's patches should be; their pixels are prefetched. known: a row of HELD; predicted: of PREDICTED."""
    height, width, _ = seen.pixels.shape
    frame = pixel_frame(seen, marker, known.x_m, known.y_m, known.heading_rad)
    predicted.ahead_x, predicted.ahead_y, predicted.left_x, predicted.left_y = frame[2:]
    predicted.px_m = math.sqrt(abs(frame[2] * frame[5] - frame[3] * frame[4]))
    c, s = math.cos(known.heading_rad), math.sin(known.heading_rad)
    for patch in range(1 + len(marker.slots_m)):
        along, across = place_in_robot(marker, patch)
        x_m, y_m = known.x_m + c * along - s * across, known.y_m + s * along + c * across
        x, y = pixel_from_field(seen.camera, x_m, y_m, marker.height_m)
        predicted.x_m[patch], predicted.y_m[patch] = x_m, y_m
        predicted.x_px[patch], predicted.y_px[patch] = x, y
        reach = marker.radii_m[patch] * predicted.px_m + OUTSIDE_PX
        if x - reach >= 0.0 and x + reach < width and y - reach >= 0.0 and y + reach < height:
            first, last = int(x - reach), int(x + reach)
            for row in range(int(y - reach), int(y + reach) + 1):
                prefetch(flat, row * width + first)
                prefetch(flat, row * width + last)


@kernel
def _verify(
    seen: Observation, flat: Bytes, marker: Marker, gates: Gates, buffers: FinderBuffers, predicted: Row, known: Row,
    robot: Row,
) -> bool:  # fmt: skip
    """Measure one robot; False when it is not as it was.

    predicted: a row of PREDICTED; known: of HELD; robot: of ROBOT, to be filled.
    """
    patches, scale, crossed = 1 + len(marker.slots_m), predicted.px_m, buffers.crossed
    worn, areas = row_of_id(marker, known.id), 0.0
    for patch in range(patches):
        radius = marker.radii_m[patch] * scale
        place = predicted.x_px[patch], predicted.y_px[patch]
        if not _cross(seen, flat, marker.worn[worn, patch], place, radius, crossed[patch]):
            return False
        score = area_score(crossed[patch, AREA] / (math.pi * radius * radius), gates)
        if score == 0.0:
            return False
        areas += score
    _place_starts(predicted, crossed, patches)
    if not _refine(seen, marker, scale, buffers, patches):
        return False
    # the rest of the way on the field, from the predicted places
    volume = predicted.ahead_x * predicted.left_y - predicted.ahead_y * predicted.left_x
    c, s = math.cos(known.heading_rad) / volume, math.sin(known.heading_rad) / volume
    centers = buffers.centers
    for patch in range(patches):
        dx, dy, sd = (
            crossed[patch, X] - predicted.x_px[patch],
            crossed[patch, Y] - predicted.y_px[patch],
            crossed[patch, SD],
        )
        along = dx * predicted.left_y - dy * predicted.left_x
        across = dy * predicted.ahead_x - dx * predicted.ahead_y
        centers[patch, 0] = predicted.x_m[patch] + c * along - s * across
        centers[patch, 1] = predicted.y_m[patch] + s * along + c * across
        centers[patch, 2] = scale * scale / (sd * sd + gates.circle_sd_px * gates.circle_sd_px)
    fit_pose(marker, buffers, robot)
    misfit = _misfit(marker, centers, robot, gates.tolerance_m)
    if misfit < 0.0 or not is_accepted(robot.x_m, robot.y_m, marker.radius_m, gates.extents_m):
        return False
    robot.team, robot.id = known.team, known.id
    robot.confidence = (1.0 - misfit / patches) * areas / patches
    robot.x_px, robot.y_px = pixel_from_field(seen.camera, robot.x_m, robot.y_m, marker.height_m)
    return True


@kernel
def _cross(
    seen: Observation, flat: Bytes, color: int, place: tuple[float, float], radius_px: float, crossed: Floats
) -> bool:  # fmt: skip
    """Measure a disc by its runs through a predicted place: across, then along its middle, then across again.

    place: x, y [px]; crossed: filled with x, y [px] and area [px^2]; False where the disc's color is not found, is
    saturated, or does not end.
    """
    height, width, _ = seen.pixels.shape
    if not (0.0 <= place[X] < width - 1.0 and 0.0 <= place[Y] < height - 1.0):
        return False
    classes = seen.classes
    reach = int(2.0 * LONGEST * radius_px) + 1
    u, v = int(place[X] + 0.5), int(place[Y] + 0.5)
    if class_at(flat, v * width + u, classes) != color:
        return False
    left, right = _run(flat, classes, color, v * width + u, 1, min(u, reach), min(width - 1 - u, reach))
    u += (right - left) // 2
    up, down = _run(flat, classes, color, v * width + u, width, min(v, reach), min(height - 1 - v, reach))
    y = v + 0.5 * (down - up)
    v += (down - up) // 2
    left, right = _run(flat, classes, color, v * width + u, 1, min(u, reach), min(width - 1 - u, reach))
    crossed[X], crossed[Y] = u + 0.5 * (right - left), y
    across, along = left + right + 1.0, up + down + 1.0
    crossed[AREA] = 0.25 * math.pi * across * along
    saturated = 0
    for channel in range(3):
        saturated += seen.pixels[v, u, channel] > SATURATED_LEVEL
    return max(across, along) <= 2.0 * LONGEST * radius_px and saturated < 2


@kernel
def _run(
    flat: Bytes, classes: Bytes, color: int, pixel: int, step: int, before: int, after: int
) -> tuple[int, int]:  # fmt: skip
    """How many pixels before and after one have its class, in steps; each at most so many."""
    first, last = 0, 0
    while first < before and class_at(flat, pixel - (first + 1) * step, classes) == color:
        first += 1
    while last < after and class_at(flat, pixel + (last + 1) * step, classes) == color:
        last += 1
    return first, last


@kernel
def _place_starts(predicted: Row, crossed: Floats, count: int) -> None:
    """Write into ``crossed`` where each center is looked for: the predicted place, or where the robot seems to be.

    One shift and a small turn bring the predicted places to the measured ones. What is less than the measurement's
    error is none.
    """
    mean_x = mean_y = shift_x = shift_y = 0.0
    for k in range(count):
        x, y = predicted.x_px[k], predicted.y_px[k]
        mean_x, mean_y = mean_x + x, mean_y + y
        shift_x, shift_y = shift_x + crossed[k, X] - x, shift_y + crossed[k, Y] - y
    mean_x, mean_y, shift_x, shift_y = mean_x / count, mean_y / count, shift_x / count, shift_y / count
    moment, inertia, reach2 = 0.0, 1e-9, 0.0
    for k in range(count):
        a, b = predicted.x_px[k] - mean_x, predicted.y_px[k] - mean_y
        moment += a * (crossed[k, Y] - predicted.y_px[k]) - b * (crossed[k, X] - predicted.x_px[k])
        inertia, reach2 = inertia + a * a + b * b, max(reach2, a * a + b * b)
    turn = moment / inertia
    if shift_x * shift_x + shift_y * shift_y < CLOSE_PX * CLOSE_PX:
        shift_x = shift_y = 0.0
    if turn * turn * reach2 < CLOSE_PX * CLOSE_PX:
        turn = 0.0
    for k in range(count):
        a, b = predicted.x_px[k] - mean_x, predicted.y_px[k] - mean_y
        crossed[k, X] = predicted.x_px[k] + shift_x - turn * b
        crossed[k, Y] = predicted.y_px[k] + shift_y + turn * a


@kernel
def _refine(seen: Observation, marker: Marker, scale: float, buffers: FinderBuffers, count: int) -> bool:
    """Refine the centers in ``buffers.crossed`` and write their deviations; False where one cannot be refined.

    Once more, as long as that moves the robot: of an edge that motion has smeared a fit shows a part of how far it is
    off.
    """
    crossed = buffers.crossed
    for _ in range(ROUNDS):
        shift_x = shift_y = 0.0
        for patch in range(count):
            at_x, at_y, radius = crossed[patch, X], crossed[patch, Y], marker.radii_m[patch] * scale
            x, y, sd, support = fitted_circle(
                seen.pixels, at_x, at_y, radius, at_x, at_y, PAPER_INSIDE_PX, buffers.circle
            )  # fmt: skip
            if support <= 0:
                return False
            crossed[patch, X], crossed[patch, Y], crossed[patch, SD] = x, y, sd
            shift_x, shift_y = shift_x + x - at_x, shift_y + y - at_y
        if shift_x * shift_x + shift_y * shift_y < (count * STILL_PX) ** 2:
            break
    return True


@kernel
def _misfit(marker: Marker, centers: Floats, robot: Row, tolerance_m: float) -> float:
    """Sum of the patches' squared distances from their places over the squared tolerance; -1 beyond the tolerance."""
    c, s = math.cos(robot.heading_rad), math.sin(robot.heading_rad)
    total = 0.0
    for patch in range(1 + len(marker.slots_m)):
        along, across = place_in_robot(marker, patch)
        dx = robot.x_m + c * along - s * across - centers[patch, 0]
        dy = robot.y_m + s * along + c * across - centers[patch, 1]
        off = (dx * dx + dy * dy) / (tolerance_m * tolerance_m)
        if not off <= 1.0:
            return -1.0
        total += off
    return total
