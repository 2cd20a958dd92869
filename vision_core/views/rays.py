"""The rays of a view, and where a ray from the origin hits a segment."""

import math
from typing import NamedTuple

from vision_core.geometry import Bytes, Floats
from vision_core.native.kernels import kernel

CORNER = 1e-9
"""Segments are longer by this fraction at either end: no ray slips through a corner that two of them share."""
PARALLEL = 1e-12
"""Sine of the angle below which a ray runs along a segment."""


class Rays(NamedTuple):
    """The rays of one view, evenly spaced and anticlockwise, ray 0 straight ahead; arrays of shape (n,)."""

    heading_rad: float
    """Direction of ray 0 in the field."""
    ux: Floats
    """Unit vectors of the rays in the field."""
    uy: Floats
    distances_m: Floats
    """Distance of the nearest edge so far, inf for none."""
    kinds: Bytes
    """Its EdgeKind."""


@kernel
def segment_distance(ux: float, uy: float, x1: float, y1: float, x2: float, y2: float) -> float:
    """Distance [m] along a ray to a segment, inf for a miss; (ux, uy) is the ray's unit vector.

    A segment seen exactly edge on is hit at its nearer end.
    """
    ex, ey = x2 - x1, y2 - y1
    slant = ux * ey - uy * ex
    aside = x1 * uy - y1 * ux
    length = math.sqrt(ex * ex + ey * ey)
    if abs(slant) <= PARALLEL * length:
        if abs(aside) > PARALLEL * (abs(x1) + abs(y1)):
            return math.inf
        first, second = x1 * ux + y1 * uy, x2 * ux + y2 * uy
        if max(first, second) < 0.0:
            return math.inf
        return max(min(first, second), 0.0)
    along = aside / slant
    if along < -CORNER or along > 1.0 + CORNER:
        return math.inf
    distance = (x1 * ey - y1 * ex) / slant
    return distance if distance >= 0.0 else math.inf
