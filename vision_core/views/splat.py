"""The nearest edge of every ray (PSLV paper, section 3.3), by angular splat.

An object is hit by the rays between its two tangents only, so each object tests those few rays and no others: a circle
the rays in atan2(y, x) +- asin(radius / distance), a segment those between its ends. Angles are rounded, so the rays
at either end are tested exactly (``rays.segment_distance``); those in between certainly hit. An outline without a
finite position is hit by no ray.

Inner loops count with unsigned integers: numba would test every signed index for counting from the end.
"""

import math

import numpy as np

from vision_core.geometry import Bytes, Floats
from vision_core.native.kernels import kernel
from vision_core.types.tables import Table
from vision_core.views.outlines import containing_outline, corner
from vision_core.views.rays import Rays, segment_distance

FULL_TURN = 2.0 * math.pi
ON_THE_LINE_M = 1e-6
"""Nearer than this to a segment's line, angles are too inaccurate: every ray is tested exactly."""


@kernel
def nearest_edges(
    own: int,
    outlines: Table,
    outline_count: int,
    segments_m: Floats,
    segment_kinds: Bytes,
    segment_count: int,
    r_min_m: float,
    rays: Rays,
) -> bool:
    """Fill in distance and kind of each ray's nearest edge; inf and 0 (EdgeKind.NOTHING) where there is none.

    own: the row in outlines from whose center the rays start. segments_m: x1 y1 x2 y2, of which the first
    segment_count are visible. An edge nearer than r_min_m is reported at r_min_m. Returns True when another outline
    contains the center; then it is the edge of every ray, at r_min_m.
    """
    x, y = outlines[own].x_m, outlines[own].y_m
    distances_m, kinds = rays.distances_m, rays.kinds
    # An outline over the center is everything that is seen.
    over = containing_outline(x, y, own, outlines, outline_count)
    if over >= 0:
        distances_m[:] = r_min_m
        kinds[:] = outlines[over].kind
        return True
    distances_m[:] = math.inf
    kinds[:] = 0
    # Walls, goals and limits first: they hit most rays.
    for k in range(segment_count):
        x1, y1, x2, y2 = segments_m[k, 0] - x, segments_m[k, 1] - y, segments_m[k, 2] - x, segments_m[k, 3] - y
        splat_segment(x1, y1, x2, y2, int(segment_kinds[k]), rays)
    # Robots and obstacles. Of a square, the sides whose outer face is turned to the center.
    for k in range(outline_count):
        if k == own or not math.isfinite(outlines[k].x_m + outlines[k].y_m + outlines[k].radius_m):
            continue
        kind = int(np.uint8(outlines[k].kind))  # of the type of a segment's kind: ``splat_segment`` is compiled once
        if outlines[k].square:
            x1, y1 = corner(outlines[k], 0)
            for side in range(1, 5):
                x2, y2 = corner(outlines[k], side)
                if (x1 - x) * (y2 - y) < (x2 - x) * (y1 - y):
                    splat_segment(x1 - x, y1 - y, x2 - x, y2 - y, kind, rays)
                x1, y1 = x2, y2
        else:
            splat_circle(outlines[k].x_m - x, outlines[k].y_m - y, outlines[k].radius_m, kind, rays)
    for i in range(len(distances_m)):
        distances_m[i] = max(distances_m[i], r_min_m)
    return False


@kernel
def turn_rays(ray_x: Floats, ray_y: Floats, cos: float, sin: float, ux: Floats, uy: Floats) -> None:
    """Rotate unit vectors from robot space into field space; writes the result into ux and uy, shape (n,).

    ray_x, ray_y: the vectors in robot space, shape (n,); cos, sin: of the robot's heading.
    """
    for i in range(len(ux)):
        ux[i] = ray_x[i] * cos - ray_y[i] * sin
    for i in range(len(uy)):
        uy[i] = ray_x[i] * sin + ray_y[i] * cos


@kernel
def splat_circle(x: float, y: float, radius: float, kind: int, rays: Rays) -> None:
    """Test a circle around (x, y), relative to the rays' origin, which it does not contain."""
    count = len(rays.ux)
    per_rad = count / FULL_TURN
    middle = (math.atan2(y, x) - rays.heading_rad) * per_rad
    half = math.asin(min(radius / math.sqrt(x * x + y * y), 1.0)) * per_rad
    # Half a ray more on either side: the exact test decides there. Rays beyond the last one go on at ray 0.
    low = _in_turn(middle - half - 0.5, count)
    first, end = math.ceil(low), math.floor(low + 2.0 * half + 1.0) + 1
    _hit_circle(x, y, radius, kind, first, min(end, count), rays)
    _hit_circle(x, y, radius, kind, 0, end - count, rays)


@kernel
def _in_turn(ray: float, count: int) -> float:
    """The same direction, 0 <= ray < count."""
    ray -= count * math.floor(ray / count)
    return ray if ray < count else 0.0  # count - 1e-17 is count


@kernel
def _hit_circle(x: float, y: float, radius: float, kind: int, start: int, end: int, rays: Rays) -> None:
    """Test the rays start..end against a circle, exactly."""
    ux, uy, distances_m, kinds = rays.ux, rays.uy, rays.distances_m, rays.kinds
    square = radius * radius
    for i in range(np.uint64(start), np.uint64(max(end, start))):
        along, aside = x * ux[i] + y * uy[i], x * uy[i] - y * ux[i]
        depth = square - aside * aside
        if depth >= 0.0 and along > 0.0:
            distance = along - math.sqrt(depth)
            if distance < distances_m[i]:
                distances_m[i], kinds[i] = distance, kind


@kernel
def splat_segment(x1: float, y1: float, x2: float, y2: float, kind: int, rays: Rays) -> None:
    """Test a segment between two points, relative to the rays' origin."""
    count = len(rays.ux)
    ex, ey = x2 - x1, y2 - y1
    cross = x1 * ey - y1 * ex
    if abs(cross) <= ON_THE_LINE_M * math.sqrt(ex * ex + ey * ey):
        for ray in range(count):
            _test_segment(x1, y1, x2, y2, kind, ray, rays)
        return
    per_rad = count / FULL_TURN
    opening = math.atan2(cross, x1 * x2 + y1 * y2) * per_rad
    low = _in_turn((math.atan2(y1, x1) - rays.heading_rad) * per_rad + min(opening, 0.0), count)
    first, last = math.floor(low), math.ceil(low + abs(opening))
    # The rays between the ends hit for certain; rays beyond the last one go on at ray 0.
    _hit_line(cross, ex, ey, kind, first + 1, min(last, count), rays)
    _hit_line(cross, ex, ey, kind, 0, last - count, rays)
    # The two rays at the ends are tested exactly.
    _test_segment(x1, y1, x2, y2, kind, first, rays)
    _test_segment(x1, y1, x2, y2, kind, last if last < count else last - count, rays)


@kernel
def _hit_line(cross: float, ex: float, ey: float, kind: int, start: int, end: int, rays: Rays) -> None:
    """Where the rays start..end, all of which hit a segment, meet its line. Without branches: it is vectorized."""
    ux, uy, distances_m, kinds = rays.ux, rays.uy, rays.distances_m, rays.kinds
    for i in range(np.uint64(start), np.uint64(max(end, start))):
        distance = cross / (ux[i] * ey - uy[i] * ex)
        nearer = distance < distances_m[i]
        distances_m[i] = distance if nearer else distances_m[i]
        kinds[i] = kind if nearer else kinds[i]


@kernel
def _test_segment(x1: float, y1: float, x2: float, y2: float, kind: int, ray: int, rays: Rays) -> None:
    """Test a ray against a segment, exactly."""
    i = np.uint64(ray)
    distance = segment_distance(rays.ux[i], rays.uy[i], x1, y1, x2, y2)
    if distance < rays.distances_m[i]:
        rays.distances_m[i], rays.kinds[i] = distance, kind
