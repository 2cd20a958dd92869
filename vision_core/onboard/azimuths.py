"""Kernels: where the solids stand at the times of the rays, and at which azimuths: a pixel's rays test few of them."""

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
def azimuths_of(solids: Table, places: Floats) -> Floats:
    """The azimuths that every solid covers at any of the times: bearing, lowest and highest from it, shape (n, 3)."""
    azimuths = np.zeros((len(solids), 3))
    for i in range(len(solids)):
        length, width = solids[i].half_length_m, solids[i].half_width_m
        azimuths[i, 0] = _bearing(places[0, i], 0.0, 0.0)
        for k in range(len(places)):
            x, y = places[k, i, 0], places[k, i, 1]
            if solids[i].round:
                distance = math.sqrt(x * x + y * y)
                half = math.asin(length / distance) if distance > length else math.pi
                aside = wrap_angle(_bearing(places[k, i], 0.0, 0.0) - azimuths[i, 0])
                azimuths[i, 1], azimuths[i, 2] = min(azimuths[i, 1], aside - half), max(azimuths[i, 2], aside + half)
            elif abs(x) <= length and abs(y) <= width:
                azimuths[i, 1], azimuths[i, 2] = -math.pi, math.pi
            else:
                for corner in range(4):
                    along, across = length if corner % 2 else -length, width if corner // 2 else -width
                    aside = wrap_angle(_bearing(places[k, i], along, across) - azimuths[i, 0])
                    azimuths[i, 1], azimuths[i, 2] = min(azimuths[i, 1], aside), max(azimuths[i, 2], aside)
    return azimuths


@kernel
def _bearing(place: Floats, x: float, y: float) -> float:
    """Azimuth in robot space of a point of a solid's space."""
    dx, dy, c, s = x - place[0], y - place[1], place[2], place[3]
    return math.atan2(c * dy - s * dx, c * dx + s * dy)


@kernel
def find_candidates(candidates: NDArray[np.int64], azimuths: Floats, azimuth: float, margin: float) -> int:
    """Fill in the numbers of the solids that rays within a margin of an azimuth may meet; how many there are."""
    count = 0
    for i in range(len(azimuths)):
        aside = wrap_angle(azimuth - azimuths[i, 0])
        if (
            azimuths[i, 1] - margin <= aside <= azimuths[i, 2] + margin
            or azimuths[i, 1] - margin + 2.0 * math.pi <= aside
            or aside <= azimuths[i, 2] + margin - 2.0 * math.pi
        ):
            candidates[count] = i
            count += 1
    return count
