"""Which of the code's shapes a patch has: the one that explains its pixels best. Compiled kernels.

The heading is known by then. Each shape is laid with its center of area on that of the paint. How much of a pixel the
paint covers is seen, by where the pixel's color lies between the ground's and the paint's, and follows for each shape
from the pixel's depth in it. The seen area says how much wider or narrower the shape was cut than drawn, and the seen
edge how blurred the picture is. The energy of a shape is the sum of the squared differences over their variance; what
the second best shape needs beyond the best one is the margin. It is compared with the whole difference between the two
shapes as well: a patch half-way between them, by a crease or a cut, is neither.
"""

import math
from typing import Any, TypeAlias

import numpy as np

from vision_core.geometry import Floats
from vision_core.models.camera_kernels import field_steps
from vision_core.native.kernels import kernel
from vision_core.objects.observation import Observation
from vision_core.objects.robots.code_shapes import GRID, CodeShapes
from vision_core.objects.robots.markers import Marker
from vision_core.patterns.geometry import PatchShape, centroid_mm, depth_mm, rim_mm

Row: TypeAlias = Any
"""One row of a table."""

View: TypeAlias = tuple[
    float, float, float, tuple[float, float, float, float], tuple[int, int, int, int],
    tuple[float, float, float], tuple[float, float, float],
]  # fmt: skip
"""Center of the patch x, y [px], what a pixel shows [m], ``step``, the window's corners, colors of paint and ground."""

COVER_SD = 0.25
"""Standard deviation of a pixel's seen coverage from that of the right shape: pose, cut, noise. It is large since
neighboring pixels err together. With these limits, of 1440 robots drawn at 2.5 to 5 mm per pixel, blurred, cut badly,
compressed or spotted, none was read wrongly."""
MIN_MARGIN = 10.0
"""Energy that the second best shape must need beyond the best one."""
MIN_LEAN = 0.35
"""The margin as a share of the whole difference between the two shapes: 1 for a patch just like the best one."""
MAX_MISFIT = 0.08
"""Mean squared difference of the coverage over the patch's area beyond which no shape explains it."""
MIN_CONTRAST = 25.0
"""Grey levels between paint and ground, below which no shape is seen."""
CORE_PX, GROUND_PX = 0.5, 1.0
"""A pixel shows the paint alone when it lies so deep in all shapes, the ground alone so far outside of all."""
UNREAD_MISFIT = 1e3
PARTLY = 0.15
"""A pixel that is covered by less is ground, by all but less is paint."""
MAX_CUT, MAX_BLUR = 0.08, 3.0
"""Shapes may be cut wider or narrower by so much of their size; an edge may be so many pixels wide."""
SAMPLES_PER_PX = 4
"""Along a pixel's side, where pictures are thought of."""


def margin_between(one: PatchShape, other: PatchShape, mm_per_px: float) -> float:
    """The margin by which a picture without faults tells two shapes apart, by the millimetres that a pixel shows."""
    step = mm_per_px / SAMPLES_PER_PX
    reach = max(float(np.abs(rim_mm(shape) - centroid_mm(shape)).max()) for shape in (one, other)) + mm_per_px
    axis = np.arange(-reach, reach + step, step)
    points = np.column_stack([axis.ravel() for axis in np.meshgrid(axis, axis)])
    seen, rival = (
        np.clip(0.5 + depth_mm(shape, points + np.array(centroid_mm(shape))) / mm_per_px, 0.0, 1.0)
        for shape in (one, other)
    )
    return float(((seen - rival) ** 2).sum()) / SAMPLES_PER_PX**2 / COVER_SD**2


@kernel
def read_shapes(seen: Observation, marker: Marker, hypothesis: Row) -> None:
    """Write the best shape, the second best, margin, lean and misfit of each slot with a shape into a hypothesis."""
    details = marker.details.value
    for slot in range(len(details.shape_values)):
        if details.shape_values[slot] > 0:
            _read_shape(seen, details.code_shapes, marker.height_m, hypothesis, slot)


@kernel
def is_shape_sure(hypothesis: Row, slot: int) -> bool:
    """Is it clear which shape a slot's patch has?"""
    is_clear = hypothesis.shape_margins[slot] >= MIN_MARGIN and hypothesis.shape_leans[slot] >= MIN_LEAN
    sure: bool = is_clear and hypothesis.shape_misfits[slot] <= MAX_MISFIT
    return sure


@kernel
def code_of_shapes(marker: Marker, hypothesis: Row) -> int:
    """What the shapes of a hypothesis are worth in the code; -1 where one is not clear."""
    code, shape_values = 0, marker.details.value.shape_values
    for slot in range(len(shape_values)):
        if shape_values[slot] > 0:
            if not is_shape_sure(hypothesis, slot):
                return -1
            code += shape_values[slot] * hypothesis.shapes[slot]
    return code


@kernel
def shape_certainty(marker: Marker, hypothesis: Row) -> float:
    """How likely the best shapes are, against the second best ones, 0..1."""
    certainty, shape_values = 1.0, marker.details.value.shape_values
    for slot in range(len(shape_values)):
        if shape_values[slot] > 0:
            certainty /= 1.0 + math.exp(-0.5 * hypothesis.shape_margins[slot])
    return certainty


@kernel
def _read_shape(seen: Observation, shapes: CodeShapes, height_m: float, hypothesis: Row, slot: int) -> None:
    hypothesis.shapes[slot] = hypothesis.rival_shapes[slot] = 0
    hypothesis.shape_margins[slot] = hypothesis.shape_leans[slot] = 0.0
    hypothesis.shape_misfits[slot] = UNREAD_MISFIT
    blob = hypothesis.slot_blobs[slot]
    if blob < 0:
        return
    x, y = seen.blobs[blob].x_px, seen.blobs[blob].y_px
    ux, uy, vx, vy = field_steps(seen.camera, x, y, height_m)
    pixel_m = math.sqrt(abs(ux * vy - uy * vx))
    # from pixels to robot space, about the blob's center
    c, s = math.cos(hypothesis.heading_rad), math.sin(hypothesis.heading_rad)
    step = (c * ux + s * uy, c * uy - s * ux, c * vx + s * vy, c * vy - s * vx)
    reach = int(shapes.half_m * 1.5 / pixel_m) + 1
    height, width, _ = seen.pixels.shape
    window = (
        max(int(x) - reach, 0), max(int(y) - reach, 0), min(int(x) + reach, width - 1), min(int(y) + reach, height - 1)
    )  # fmt: skip
    # the blob may lack what has another color in this light: the second time about the center of what is covered
    for _ in range(2):
        paint, ground = _two_colors(seen, shapes, slot, x, y, step, pixel_m, window)
        contrast = (paint[0] - ground[0]) ** 2 + (paint[1] - ground[1]) ** 2 + (paint[2] - ground[2]) ** 2
        if contrast < MIN_CONTRAST**2:
            return
        view = (x, y, pixel_m, step, window, paint, ground)
        x, y, area_px, edge_px = _covered(seen, shapes, slot, view)
        if area_px <= 0.0:
            return
    view = (x, y, pixel_m, step, window, paint, ground)
    best, second, least, next_least = 0, 0, math.inf, math.inf
    for shape in range(len(shapes.offsets_m)):
        energy = _energy(seen, shapes, slot, shape, view, _cut_of(shapes, shape, pixel_m, area_px, edge_px))
        if energy < least:
            second, next_least = best, least
            best, least = shape, energy
        elif energy < next_least:
            second, next_least = shape, energy
    cut = _cut_of(shapes, best, pixel_m, area_px, edge_px)
    rival_cut = _cut_of(shapes, second, pixel_m, area_px, edge_px)
    apart = 1e-9
    for row in range(window[1], window[3] + 1):
        for column in range(window[0], window[2] + 1):
            a, b = _robot_place(column - x, row - y, step)
            if _is_free(shapes, slot, a, b, pixel_m):
                off = _coverage(shapes, best, a, b, cut) - _coverage(shapes, second, a, b, rival_cut)
                apart += off * off
    hypothesis.shapes[slot], hypothesis.rival_shapes[slot] = best, second
    hypothesis.shape_margins[slot] = (next_least - least) / COVER_SD**2
    hypothesis.shape_leans[slot] = (next_least - least) / apart
    hypothesis.shape_misfits[slot] = least * pixel_m * pixel_m / shapes.areas_m2[best]


@kernel
def _covered(seen: Observation, shapes: CodeShapes, slot: int, view: View) -> tuple[float, float, float, float]:
    """Center of what the paint covers [px], its area, and the area of the pixels at its edge [px^2]."""
    x, y, pixel_m, step, window, _, _ = view
    area = edge = sum_x = sum_y = 0.0
    for row in range(window[1], window[3] + 1):
        for column in range(window[0], window[2] + 1):
            a, b = _robot_place(column - x, row - y, step)
            if not _is_free(shapes, slot, a, b, pixel_m):
                continue
            cover = _seen_coverage(seen, row, column, view)
            if cover >= PARTLY:
                cover = 1.0 if cover > 1.0 - PARTLY else cover
                edge += cover < 1.0
                area, sum_x, sum_y = area + cover, sum_x + cover * column, sum_y + cover * row
    if area <= 0.0:
        return x, y, 0.0, 0.0
    return sum_x / area, sum_y / area, area, edge


@kernel
def _energy(
    seen: Observation, shapes: CodeShapes, slot: int, shape: int, view: View, cut: tuple[float, float]
) -> float:
    """Sum of the squared differences between the seen coverage and that of a shape."""
    x, y, pixel_m, step, window, _, _ = view
    energy = 0.0
    for row in range(window[1], window[3] + 1):
        for column in range(window[0], window[2] + 1):
            a, b = _robot_place(column - x, row - y, step)
            if _is_free(shapes, slot, a, b, pixel_m):
                off = _seen_coverage(seen, row, column, view) - _coverage(shapes, shape, a, b, cut)
                energy += off * off
    return energy


@kernel
def _cut_of(shapes: CodeShapes, shape: int, pixel_m: float, area_px: float, edge_px: float) -> tuple[float, float]:
    """How far a shape is cut wider than drawn, by the area that is seen, and how wide its edge is [m]."""
    area, rim = shapes.areas_m2[shape], shapes.rims_m[shape]
    most = MAX_CUT * math.sqrt(area)
    wider = min(max((area_px * pixel_m * pixel_m - area) / rim, -most), most)
    blur = edge_px * pixel_m * pixel_m / ((1.0 - 2.0 * PARTLY) * rim)
    return wider, min(max(blur, pixel_m), MAX_BLUR * pixel_m)


@kernel
def _two_colors(
    seen: Observation, shapes: CodeShapes, slot: int, x: float, y: float, step: tuple[float, float, float, float],
    pixel_m: float, window: tuple[int, int, int, int],
) -> tuple[tuple[float, float, float], tuple[float, float, float]]:  # fmt: skip
    """Mean color of what lies in all shapes, and of what lies in none; black where there is nothing."""
    b0 = g0 = r0 = n0 = b1 = g1 = r1 = n1 = 0.0
    for row in range(window[1], window[3] + 1):
        for column in range(window[0], window[2] + 1):
            a, b = _robot_place(column - x, row - y, step)
            shallowest, deepest = math.inf, -math.inf
            for shape in range(len(shapes.offsets_m)):
                depth = _depth_in_shape(shapes, shape, a, b)
                shallowest, deepest = min(shallowest, depth), max(deepest, depth)
            pixel = seen.pixels[row, column]
            if shallowest >= CORE_PX * pixel_m:
                b1, g1, r1, n1 = b1 + pixel[0], g1 + pixel[1], r1 + pixel[2], n1 + 1.0
            elif deepest <= -GROUND_PX * pixel_m and _is_free(shapes, slot, a, b, pixel_m):
                b0, g0, r0, n0 = b0 + pixel[0], g0 + pixel[1], r0 + pixel[2], n0 + 1.0
    n0, n1 = max(n0, 1.0), max(n1, 1.0)
    return (b1 / n1, g1 / n1, r1 / n1), (b0 / n0, g0 / n0, r0 / n0)


@kernel
def _robot_place(du: float, dv: float, step: tuple[float, float, float, float]) -> tuple[float, float]:
    """Place of a pixel in robot space about the blob's center [m]."""
    return du * step[0] + dv * step[2], du * step[1] + dv * step[3]


@kernel
def _seen_coverage(seen: Observation, row: int, column: int, view: View) -> float:
    """How much of a pixel the paint covers, by where its color lies between the ground's and the paint's."""
    _, _, _, _, _, paint, ground = view
    db, dg, dr = paint[0] - ground[0], paint[1] - ground[1], paint[2] - ground[2]
    pixel = seen.pixels[row, column]
    along = (pixel[0] - ground[0]) * db + (pixel[1] - ground[1]) * dg + (pixel[2] - ground[2]) * dr
    cover: float = min(max(along / (db * db + dg * dg + dr * dr), -0.2), 1.2)
    return cover


@kernel
def _is_free(shapes: CodeShapes, slot: int, a: float, b: float, pixel_m: float) -> bool:
    """Does a pixel show nothing but a slot's patch and its ground?"""
    return _depth(shapes.free_m[slot], shapes.half_m, a, b) >= GROUND_PX * pixel_m


@kernel
def _coverage(shapes: CodeShapes, shape: int, a: float, b: float, cut: tuple[float, float]) -> float:
    """How much of a pixel a shape covers whose center of area is that of the blob, 0..1. cut: of ``_cut_of``."""
    return min(max(0.5 + (_depth_in_shape(shapes, shape, a, b) + cut[0]) / cut[1], 0.0), 1.0)


@kernel
def _depth_in_shape(shapes: CodeShapes, shape: int, a: float, b: float) -> float:
    """Depth of a place about the blob's center in a shape that has its center of area there."""
    offset = shapes.offsets_m[shape]
    return _depth(shapes.depths_m[shape], shapes.half_m, a + offset[0], b + offset[1])


@kernel
def _depth(depths_m: Floats, half_m: float, a: float, b: float) -> float:
    """A depth between the grid's points; far outside beyond the grid."""
    spacing = 2.0 * half_m / (GRID - 1)
    x, y = (a + half_m) / spacing, (b + half_m) / spacing
    if not (0.0 <= x < GRID - 1 and 0.0 <= y < GRID - 1):
        return -half_m
    column, row = int(x), int(y)
    p, q = x - np.float64(column), y - np.float64(row)
    above = (1.0 - p) * depths_m[row, column] + p * depths_m[row, column + 1]
    below = (1.0 - p) * depths_m[row + 1, column] + p * depths_m[row + 1, column + 1]
    depth: float = (1.0 - q) * above + q * below
    return depth
