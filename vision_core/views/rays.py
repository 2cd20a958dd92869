"""Where a ray from the origin meets a segment. Distances [m] along the ray, inf for a miss."""

import math

from vision_core.native.kernels import kernel

CORNER = 1e-9
"""Segments are longer by this share at either end: no ray slips through a corner that two of them share."""
PARALLEL = 1e-12
"""Sine of the angle below which a ray runs along a segment."""


@kernel
def segment_reach(ux: float, uy: float, x1: float, y1: float, x2: float, y2: float) -> float:
    """To a segment; (ux, uy) is the ray's unit vector. Seen exactly edge on, it is met at its nearer end."""
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
    share = aside / slant
    if share < -CORNER or share > 1.0 + CORNER:
        return math.inf
    distance = (x1 * ey - y1 * ex) / slant
    return distance if distance >= 0.0 else math.inf
