"""A marker is read as a whole: every patch is measured in the picture at its place, blob or no blob. Compiled kernels.

1. ``measure_patches``: mean chromaticity of each patch, which channels are saturated, and how uneven it is.
2. ``learn_references``: robots that are read by their blobs show what the paints look like in this light; a class that
   no robot shows keeps the reference of the color table, which counts less.
3. ``read_marker``: of all ids of the pattern the one whose paints explain all patches best. One shift of the
   chromaticity, the light on this robot, is free within bounds, so papers are judged relative to each other. The
   energy that the second best id needs beyond it is the margin; a small one gives no id. Neither does a patch that no
   paint explains (a hand lies on it) or that is uneven (a cable does).

Blobs that only saturated channels tell apart are not trusted (``is_doubtful``): green and cyan, both with green and
blue at 255.
"""

import math
from typing import Any, TypeAlias

import numpy as np

from vision_core.geometry import Bytes, Floats
from vision_core.models.camera_kernels import pixel_from_field
from vision_core.native.kernels import kernel
from vision_core.objects.observation import Observation
from vision_core.objects.robots.held import NO_ROW
from vision_core.objects.robots.markers import Marker, row_of_id
from vision_core.objects.robots.paint_residual import (
    COST,
    COUNT,
    NO_VEIL,
    OFF_X,
    OFF_Y,
    SATURATED,
    STIFF_XX,
    STIFF_XY,
    STIFF_YY,
    SUM_X,
    SUM_XX,
    SUM_XY,
    SUM_Y,
    SUM_YY,
    UNEVEN,
    X,
    Y,
    measure_residual,
)
from vision_core.objects.robots.shape_reading import is_shape_sure
from vision_core.types.colors import DARK_LEVEL
from vision_core.types.tables import NO_ID

Row: TypeAlias = Any
"""One row of a table."""


SATURATED_LEVEL = 253.5
MAX_UNEVEN = 50.0
LIGHT_SD = 0.08
"""How much the light's chromaticity may differ on one robot from that of the others."""
MIN_MARGIN = 5.0
"""Energy, twice a log likelihood, that the second best id must need beyond the best one."""
ALIKE_MARGIN = 1.0
"""With a smaller margin two ids look the same."""
MAX_MISFIT = 12.0
"""Energy of one patch beyond which no paint explains it."""


@kernel
def measure_patches(seen: Observation, marker: Marker, robot: Row, patches: Floats) -> None:
    """Measure every patch of a robot at its place; patches: shape (>= 1 + s, PATCH_COLUMNS), see ``X``.

    Within one robot the camera is taken to be linear. A lamp's reflection adds light to a part of a patch, so the color
    is that of its points which are no lighter than their mean.
    """
    height, width, _ = seen.pixels.shape
    x0, y0, ax, ay, bx, by = pixel_frame(seen, marker, robot.x_m, robot.y_m, robot.heading_rad)
    points = marker.patch_points_m
    for patch in range(len(points)):
        mean, count = 0.0, 0.0
        whole, darker = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
        for turn in range(2):
            for k in range(points.shape[1]):
                along, across = points[patch, k, 0], points[patch, k, 1]
                u, v = x0 + along * ax + across * bx, y0 + along * ay + across * by
                column, row = min(max(int(u + 0.5), 0), width - 1), min(max(int(v + 0.5), 0), height - 1)
                light = float(seen.pixels[row, column, 0]) + seen.pixels[row, column, 1] + seen.pixels[row, column, 2]
                if turn == 0:
                    mean += light / points.shape[1]
                    whole = _added(whole, seen.pixels, row, column)
                elif light <= mean + 0.5:
                    darker = _added(darker, seen.pixels, row, column)
                    count += 1.0
        _summarize(whole, float(points.shape[1]), darker, count, patches[patch])


@kernel
def pixel_frame(
    seen: Observation, marker: Marker, x_m: float, y_m: float, heading_rad: float
) -> tuple[float, float, float, float, float, float]:
    """A robot's place in the picture [px], and how far ahead and to its left a metre reaches there [px/m]."""
    arm = marker.radius_m
    c, s = math.cos(heading_rad), math.sin(heading_rad)
    x0, y0 = pixel_from_field(seen.camera, x_m, y_m, marker.height_m)
    ahead_x, ahead_y = pixel_from_field(seen.camera, x_m + c * arm, y_m + s * arm, marker.height_m)
    left_x, left_y = pixel_from_field(seen.camera, x_m - s * arm, y_m + c * arm, marker.height_m)
    return x0, y0, (ahead_x - x0) / arm, (ahead_y - y0) / arm, (left_x - x0) / arm, (left_y - y0) / arm


@kernel
def _added(
    sums: tuple[float, float, float, float, float, float], pixels: Bytes, row: int, column: int
) -> tuple[float, float, float, float, float, float]:
    """Sums of blue, green, red and of their squares, with one pixel more."""
    blue, green = np.float64(pixels[row, column, 0]), np.float64(pixels[row, column, 1])
    red = np.float64(pixels[row, column, 2])
    b, g, r, bb, gg, rr = sums
    return b + blue, g + green, r + red, bb + blue * blue, gg + green * green, rr + red * red


@kernel
def _summarize(
    whole: tuple[float, float, float, float, float, float], all_points: float,
    darker: tuple[float, float, float, float, float, float], count: float, patch: Floats,
) -> None:  # fmt: skip
    """Write the columns of one patch, from the sums over all of its points and over the darker ones."""
    b, g, r = darker[0] / count, darker[1] / count, darker[2] / count
    green = math.log(g + DARK_LEVEL)
    patch[X], patch[Y] = math.log(b + DARK_LEVEL) - green, math.log(r + DARK_LEVEL) - green
    patch[SATURATED] = (b >= SATURATED_LEVEL) + 2.0 * (g >= SATURATED_LEVEL) + 4.0 * (r >= SATURATED_LEVEL)
    b, g, r = whole[0] / all_points, whole[1] / all_points, whole[2] / all_points
    variance = max(
        whole[3] / all_points - b * b, whole[4] / all_points - g * g, whole[5] / all_points - r * r, 0.0
    )  # fmt: skip
    patch[UNEVEN] = math.sqrt(variance)


@kernel
def is_doubtful(marker: Marker, patches: Floats) -> bool:
    """Has a patch of the code two saturated channels, so that its hue is not known?"""
    for slot in range(len(marker.slots_m)):
        bits = int(patches[1 + slot, SATURATED])
        if marker.place_values[slot] > 0 and bits & (bits - 1) != 0:
            return True
    return False


@kernel
def is_overexposed(seen: Observation, blob: int) -> bool:
    """Are two channels saturated in the middle of a blob?"""
    if blob < 0:
        return False
    row, column = int(seen.blobs[blob].y_px + 0.5), int(seen.blobs[blob].x_px + 0.5)
    saturated = 0
    for channel in range(3):
        saturated += seen.pixels[row, column, channel] > SATURATED_LEVEL
    return saturated >= 2


@kernel
def learn_references(marker: Marker, number: int, patches: Floats, learned: Floats) -> None:
    """Count the patches of a robot whose id is sure, those without a saturated channel.

    number: the id; learned: per class, shape (classes, 6), see ``COUNT``.
    """
    row = row_of_id(marker, number)
    if row == NO_ROW:
        return
    for patch in range(marker.worn.shape[1]):
        if patches[patch, SATURATED] == 0.0:
            x, y, sums = patches[patch, X], patches[patch, Y], learned[marker.worn[row, patch]]
            sums[COUNT] += 1.0
            sums[SUM_X] += x
            sums[SUM_Y] += y
            sums[SUM_XX] += x * x
            sums[SUM_XY] += x * y
            sums[SUM_YY] += y * y


@kernel
def read_marker(
    marker: Marker, hypothesis: Row, patches: Floats, learned: Floats, by_blobs: int
) -> tuple[int, float]:  # fmt: skip
    """The id whose paints explain a robot's patches best, NO_ID where that is not sure; and how likely it is, 0..1.

    by_blobs: the id that the blobs show, or NO_ID. It stays unless another one is as good, or clearly better.
    """
    best, second, best_row, misfit = math.inf, math.inf, 0, 0.0
    for row in range(len(marker.ids)):
        if not _has_its_shapes(marker, row, hypothesis):
            continue
        energy, worst = energy_of(marker, row, patches, learned, NO_VEIL)
        if energy < best:
            second, best, best_row, misfit = best, energy, row, worst
        elif energy < second:
            second = energy
    number, margin = int(marker.ids[best_row]), second - best
    if by_blobs != NO_ID:
        is_refuted = margin < ALIKE_MARGIN or (number != by_blobs and margin >= MIN_MARGIN)
        return (NO_ID if is_refuted else by_blobs), 1.0
    if not best < math.inf or margin < MIN_MARGIN or misfit > MAX_MISFIT or _is_covered_or_clipped(marker, patches):
        return NO_ID, 1.0
    return number, 1.0 / (1.0 + math.exp(-0.5 * margin))


@kernel
def _has_its_shapes(marker: Marker, row: int, hypothesis: Row) -> bool:
    """Has a robot the shapes of the id of a row, for sure?"""
    if not marker.has_shapes:
        return True
    details = marker.details.value
    for slot in range(len(marker.slots_m)):
        has_another = not is_shape_sure(hypothesis, slot) or hypothesis.shapes[slot] != details.shapes_worn[row, slot]
        if details.shape_values[slot] > 0 and has_another:
            return False
    return True


@kernel
def _is_covered_or_clipped(marker: Marker, patches: Floats) -> bool:
    """Does something lie over a part of a patch, or has one a saturated channel, so that its color is not known?"""
    most, saturated = 0.0, 0.0
    for patch in range(marker.worn.shape[1]):
        most, saturated = max(most, patches[patch, UNEVEN]), max(saturated, patches[patch, SATURATED])
    return most > MAX_UNEVEN or saturated > 0.0


@kernel
def energy_of(
    marker: Marker, row: int, patches: Floats, learned: Floats, veils: int
) -> tuple[float, float]:  # fmt: skip
    """Energy of the patches if the robot wears the id of a row, and that of the worst patch."""
    # normal equations of the light's shift: (sum W + 1 / sd^2) shift = sum W residual
    xx, xy, yy, bx, by, energy = 1.0 / LIGHT_SD**2, 0.0, 1.0 / LIGHT_SD**2, 0.0, 0.0, 0.0
    for number in range(marker.worn.shape[1]):
        patch = patches[number]
        measure_residual(marker, marker.worn[row, number], patch, learned, veils)
        x, y, wxx, wxy, wyy = patch[OFF_X], patch[OFF_Y], patch[STIFF_XX], patch[STIFF_XY], patch[STIFF_YY]
        xx, xy, yy = xx + wxx, xy + wxy, yy + wyy
        bx, by = bx + wxx * x + wxy * y, by + wxy * x + wyy * y
        energy += patch[COST] + wxx * x * x + 2.0 * wxy * x * y + wyy * y * y
    shift_x = shift_y = 0.0
    if veils == NO_VEIL:  # white and the light's shift would explain the same
        determinant = xx * yy - xy * xy
        shift_x, shift_y = (yy * bx - xy * by) / determinant, (xx * by - xy * bx) / determinant
    worst = 0.0
    for number in range(marker.worn.shape[1]):
        patch = patches[number]
        x, y = patch[OFF_X] - shift_x, patch[OFF_Y] - shift_y
        own = patch[STIFF_XX] * x * x + 2.0 * patch[STIFF_XY] * x * y + patch[STIFF_YY] * y * y
        worst = max(worst, own)
    return energy - bx * shift_x - by * shift_y, worst
