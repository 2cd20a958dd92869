"""Kernels: where the solids stand at the times of the rays, and what they cover: a pixel's rays test few of them."""

import math

import numpy as np
from numpy.typing import NDArray

from vision_core.geometry import Floats
from vision_core.native.angles import wrap_angle
from vision_core.native.kernels import kernel
from vision_core.types.tables import Table

PLACE = 6
"""Columns of a solid's place: the viewpoint in its space, cosine and sine of the viewer's heading in it, and of its own
heading in the field."""
BEARING, LOWEST, HIGHEST, NEAREST, BEYOND = range(5)
"""Columns of an extent: an azimuth in robot space, and how far from it the lowest and the highest one lie; the nearest
distance on the floor [m]; rays that meet the floor farther away than BEYOND pass over it."""


@kernel
def viewpoints_of(viewer: Floats, times: Floats) -> Floats:
    """x, y [m] of the viewer and cosine and sine of its heading at every time [s], shape (times, 4)."""
    viewpoints = np.empty((len(times), 4))
    for k in range(len(times)):
        time = times[k]
        heading = viewer[2] + time * viewer[5]
        viewpoints[k, 0], viewpoints[k, 1] = viewer[0] + time * viewer[3], viewer[1] + time * viewer[4]
        viewpoints[k, 2], viewpoints[k, 3] = math.cos(heading), math.sin(heading)
    return viewpoints


@kernel
def places_of(solids: Table, viewer: Floats, times: Floats) -> Floats:
    """Every solid's place at every time [s], shape (times, solids, PLACE). viewer: a row as in ``physics``."""
    places = np.empty((len(times), len(solids), PLACE))
    for k in range(len(times)):
        time = times[k]
        x, y, heading = viewer[0] + time * viewer[3], viewer[1] + time * viewer[4], viewer[2] + time * viewer[5]
        for i in range(len(solids)):
            solid = solids[i]
            own = solid.heading_rad + time * solid.turn_rad_s
            c, s = math.cos(own), math.sin(own)
            from_x, from_y = x - solid.x_m - time * solid.vx_m_s, y - solid.y_m - time * solid.vy_m_s
            places[k, i, 0], places[k, i, 1] = c * from_x + s * from_y, c * from_y - s * from_x
            places[k, i, 2], places[k, i, 3] = math.cos(heading - own), math.sin(heading - own)
            places[k, i, 4], places[k, i, 5] = c, s
    return places


@kernel
def shapes_of(solids: Table) -> Floats:
    """Whether it is round, half length, half width, front, bottom and top of every solid, shape (n, 6)."""
    shapes = np.empty((len(solids), 6))
    for i in range(len(solids)):
        shapes[i, 0], shapes[i, 1], shapes[i, 2] = solids[i].round, solids[i].half_length_m, solids[i].half_width_m
        shapes[i, 3], shapes[i, 4], shapes[i, 5] = solids[i].front_m, solids[i].bottom_m, solids[i].top_m
    return shapes


@kernel
def extents_of(
    solids: Table, places: Floats, viewpoints: Floats, times: Floats, ball: Floats, height_m: float
) -> Floats:
    """What every solid, and last the ball, covers at any of the times: columns BEARING .. BEYOND, shape (n + 1, 5).

    viewpoints, places: at the times [s]; ball: as in ``Scene``; height_m: of the viewpoint.
    """
    extents = np.zeros((len(solids) + 1, 5))
    extents[:, NEAREST] = math.inf
    for i in range(len(solids)):
        extent, length, width = extents[i], solids[i].half_length_m, solids[i].half_width_m
        extent[BEARING] = _bearing(places[0, i], 0.0, 0.0)
        for k in range(len(places)):
            place = places[k, i]
            x, y = abs(place[0]), abs(place[1])
            if solids[i].round:
                _widen_by_disc(extent, _bearing(place, 0.0, 0.0), math.hypot(x, y), length)
                continue
            half = math.pi if x <= length and y <= width else 0.0
            near, far = math.hypot(max(x - length, 0.0), max(y - width, 0.0)), math.hypot(x + length, y + width)
            for corner in range(4):
                along, across = length if corner % 2 else -length, width if corner // 2 else -width
                _widen(extent, _bearing(place, along, across), half, near, far)
        extent[BEYOND] *= _stretch(solids[i].top_m, height_m)
    extent = extents[-1]
    for k in range(len(times)):
        dx, dy = ball[0] + times[k] * ball[2] - viewpoints[k, 0], ball[1] + times[k] * ball[3] - viewpoints[k, 1]
        c, s = viewpoints[k, 2], viewpoints[k, 3]
        bearing = math.atan2(c * dy - s * dx, c * dx + s * dy)
        if k == 0:
            extent[BEARING] = bearing
        _widen_by_disc(extent, bearing, math.hypot(dx, dy), ball[4])
    extent[BEYOND] *= _stretch(2.0 * ball[4], height_m)
    return extents


@kernel
def _widen_by_disc(extent: Floats, bearing: float, distance: float, radius: float) -> None:
    """Widen an extent by a disc whose center is seen in a direction, at a distance on the floor."""
    half = math.asin(radius / distance) if distance > radius else math.pi
    _widen(extent, bearing, half, distance - radius, distance + radius)


@kernel
def _widen(extent: Floats, bearing: float, half: float, near: float, far: float) -> None:
    """Widen an extent by the azimuths on both sides of a bearing and by distances on the floor."""
    aside = wrap_angle(bearing - extent[BEARING])
    extent[LOWEST], extent[HIGHEST] = min(extent[LOWEST], aside - half), max(extent[HIGHEST], aside + half)
    extent[NEAREST], extent[BEYOND] = min(extent[NEAREST], near), max(extent[BEYOND], far)


@kernel
def _stretch(top_m: float, height_m: float) -> float:
    """How many times farther away than a top the ray over it meets the floor; inf: it never does."""
    return height_m / (height_m - top_m) if top_m < height_m else math.inf


@kernel
def _bearing(place: Floats, x: float, y: float) -> float:
    """Azimuth in robot space of a point of a solid's space."""
    dx, dy, c, s = x - place[0], y - place[1], place[2], place[3]
    return math.atan2(c * dy - s * dx, c * dx + s * dy)


@kernel
def find_candidates(
    candidates: NDArray[np.int64], extents: Floats, azimuth: float, margin: float, near: float, far: float
) -> int:
    """Fill in the rows of the extents that some rays may meet; how many there are.

    The rays lie within a margin of an azimuth and meet the floor at distances of near to far [m].
    """
    count = 0
    for i in range(len(extents)):
        if extents[i, NEAREST] > far or near > extents[i, BEYOND]:
            continue
        aside, lowest, highest = wrap_angle(azimuth - extents[i, BEARING]), extents[i, LOWEST], extents[i, HIGHEST]
        if (
            lowest - margin <= aside <= highest + margin
            or lowest - margin + 2.0 * math.pi <= aside
            or aside <= highest + margin - 2.0 * math.pi
        ):
            candidates[count] = i
            count += 1
    return count
