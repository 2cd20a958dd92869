"""The nearest edge of every ray (PSLV paper, section 3.3), by angular splat.

A thing is met by the rays between its two rims alone, so each thing touches those few and no others: a circle the rays
in atan2(y, x) +- asin(radius / distance), a segment those between its ends. The rays at the rims are tried exactly as
``rays`` has it, for angles are rounded; those in between meet it for certain. A body at no finite place is met by none.

Inner loops count without a sign: numba would look at every index whether it counts from the end.
"""

import math

import numpy as np

from vision_core.geometry import Bytes, Floats
from vision_core.native.kernels import kernel
from vision_core.types.tables import Table
from vision_core.views.outlines import corner, holder
from vision_core.views.rays import segment_reach

FULL_TURN = 2.0 * math.pi
ON_THE_LINE_M = 1e-6
"""Nearer than this to a segment's line, angles tell too little: every ray is tried."""


@kernel
def nearest_edges(
    own: int,
    heading_rad: float,
    bodies: Table,
    body_count: int,
    segments_m: Floats,
    segment_kinds: Bytes,
    seen: int,
    r_min_m: float,
    ux: Floats,
    uy: Floats,
    distances_m: Floats,
    kinds: Bytes,
) -> bool:
    """Fill in distance and kind of each ray's nearest edge; inf and 0 (EdgeKind.NOTHING) where there is none.

    own: the body from whose center the rays start, evenly spaced, ray 0 along heading_rad, anticlockwise; (ux,
    uy): their unit vectors in the field, shape (n,). segments_m: x1 y1 x2 y2, of which the first `seen` are seen. An
    edge nearer than r_min_m is reported there. Returns True when another body's outline holds our center; then it is
    the edge of every ray, at r_min_m.
    """
    x, y = bodies[own].x_m, bodies[own].y_m
    over = holder(x, y, own, bodies, body_count)
    if over >= 0:
        distances_m[:] = r_min_m
        kinds[:] = bodies[over].kind
        return True
    distances_m[:] = math.inf
    kinds[:] = 0
    for k in range(seen):
        x1, y1, x2, y2 = segments_m[k, 0] - x, segments_m[k, 1] - y, segments_m[k, 2] - x, segments_m[k, 3] - y
        splat_segment(x1, y1, x2, y2, int(segment_kinds[k]), heading_rad, ux, uy, distances_m, kinds)
    for k in range(body_count):
        if k == own or not math.isfinite(bodies[k].x_m + bodies[k].y_m + bodies[k].radius_m):
            continue
        kind = int(np.uint8(bodies[k].kind))  # of the type of a segment's kind: ``splat_segment`` is compiled once
        if bodies[k].square:
            x1, y1 = corner(bodies[k], 0)
            for side in range(1, 5):
                x2, y2 = corner(bodies[k], side)
                if (x1 - x) * (y2 - y) < (x2 - x) * (y1 - y):  # its outer face is turned to us
                    splat_segment(x1 - x, y1 - y, x2 - x, y2 - y, kind, heading_rad, ux, uy, distances_m, kinds)
                x1, y1 = x2, y2
        else:
            splat_circle(
                bodies[k].x_m - x, bodies[k].y_m - y, bodies[k].radius_m, kind,
                heading_rad, ux, uy, distances_m, kinds,
            )  # fmt: skip
    for i in range(len(distances_m)):
        distances_m[i] = max(distances_m[i], r_min_m)
    return False


@kernel
def turn_rays(ray_x: Floats, ray_y: Floats, cos: float, sin: float, ux: Floats, uy: Floats) -> None:
    """Unit vectors from the heading to the field; ux, uy are filled."""
    for i in range(len(ux)):
        ux[i] = ray_x[i] * cos - ray_y[i] * sin
    for i in range(len(uy)):
        uy[i] = ray_x[i] * sin + ray_y[i] * cos


@kernel
def splat_circle(
    x: float, y: float, radius: float, kind: int,
    heading_rad: float, ux: Floats, uy: Floats, distances_m: Floats, kinds: Bytes,
) -> None:  # fmt: skip
    """A circle around (x, y) from us, that does not hold us."""
    count = len(ux)
    per_rad = count / FULL_TURN
    middle = (math.atan2(y, x) - heading_rad) * per_rad
    half = math.asin(min(radius / math.sqrt(x * x + y * y), 1.0)) * per_rad
    low = _in_turn(middle - half - 0.5, count)
    first, end = math.ceil(low), math.floor(low + 2.0 * half + 1.0) + 1
    _meet_circle(x, y, radius, kind, first, min(end, count), ux, uy, distances_m, kinds)
    _meet_circle(x, y, radius, kind, 0, end - count, ux, uy, distances_m, kinds)


@kernel
def _in_turn(ray: float, count: int) -> float:
    """The same direction, 0 <= ray < count."""
    ray -= count * math.floor(ray / count)
    return ray if ray < count else 0.0  # count - 1e-17 is count


@kernel
def _meet_circle(
    x: float, y: float, radius: float, kind: int,
    start: int, end: int, ux: Floats, uy: Floats, distances_m: Floats, kinds: Bytes,
) -> None:  # fmt: skip
    square = radius * radius
    for i in range(np.uint64(start), np.uint64(max(end, start))):
        along, aside = x * ux[i] + y * uy[i], x * uy[i] - y * ux[i]
        depth = square - aside * aside
        if depth >= 0.0 and along > 0.0:
            reach = along - math.sqrt(depth)
            if reach < distances_m[i]:
                distances_m[i], kinds[i] = reach, kind


@kernel
def splat_segment(
    x1: float, y1: float, x2: float, y2: float, kind: int,
    heading_rad: float, ux: Floats, uy: Floats, distances_m: Floats, kinds: Bytes,
) -> None:  # fmt: skip
    """A segment between two points from us."""
    ex, ey = x2 - x1, y2 - y1
    cross = x1 * ey - y1 * ex
    if abs(cross) <= ON_THE_LINE_M * math.sqrt(ex * ex + ey * ey):
        _try_segment(x1, y1, x2, y2, kind, 0, len(ux), ux, uy, distances_m, kinds)
        return
    count = len(ux)
    per_rad = count / FULL_TURN
    opening = math.atan2(cross, x1 * x2 + y1 * y2) * per_rad
    low = _in_turn((math.atan2(y1, x1) - heading_rad) * per_rad + min(opening, 0.0), count)
    first, last = math.floor(low), math.ceil(low + abs(opening))
    _meet_line(cross, ex, ey, kind, first + 1, min(last, count), ux, uy, distances_m, kinds)
    _meet_line(cross, ex, ey, kind, 0, last - count, ux, uy, distances_m, kinds)
    if last >= count:
        last -= count
    _try_segment(x1, y1, x2, y2, kind, first, first + 1, ux, uy, distances_m, kinds)
    _try_segment(x1, y1, x2, y2, kind, last, last + 1, ux, uy, distances_m, kinds)


@kernel
def _meet_line(
    cross: float, ex: float, ey: float, kind: int,
    start: int, end: int, ux: Floats, uy: Floats, distances_m: Floats, kinds: Bytes,
) -> None:  # fmt: skip
    for i in range(np.uint64(start), np.uint64(max(end, start))):
        reach = cross / (ux[i] * ey - uy[i] * ex)
        nearer = reach < distances_m[i]
        distances_m[i] = reach if nearer else distances_m[i]
        kinds[i] = kind if nearer else kinds[i]


@kernel
def _try_segment(
    x1: float, y1: float, x2: float, y2: float, kind: int,
    start: int, end: int, ux: Floats, uy: Floats, distances_m: Floats, kinds: Bytes,
) -> None:  # fmt: skip
    for i in range(np.uint64(start), np.uint64(end)):
        reach = segment_reach(ux[i], uy[i], x1, y1, x2, y2)
        if reach < distances_m[i]:
            distances_m[i], kinds[i] = reach, kind
