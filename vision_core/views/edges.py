"""The nearest edge of every ray (PSLV paper, section 3.3: intersections of lines through the origin with
the objects' boundaries)."""

import math

from vision_core.geometry import Bytes, Floats
from vision_core.kernels import kernel
from vision_core.views.rays import circle_reach, segment_reach


@kernel
def nearest_edges(
    angles_rad: Floats,
    x_m: float,
    y_m: float,
    segments_m: Floats,
    segment_kinds: Bytes,
    circles_m: Floats,
    circle_kinds: Bytes,
    radius_m: float,
    r_min_m: float,
    distances_m: Floats,
    kinds: Bytes,
) -> bool:
    """Fill in distance and kind of each ray's nearest edge; inf and 0 (EdgeKind.NOTHING) where there is none.

    angles_rad: shape (n,), in the field; segments_m: shape (s, 4), x1 y1 x2 y2; circles_m: centers, shape
    (c, 2), all of radius_m; distances_m, kinds: shape (n,), filled in. An edge nearer than r_min_m is reported there.
    Returns True when a circle holds our center; then it is the edge of every ray, at r_min_m.
    """
    holder, nearest = -1, radius_m
    for k in range(len(circles_m)):
        away = math.hypot(circles_m[k, 0] - x_m, circles_m[k, 1] - y_m)
        if away <= nearest:
            holder, nearest = k, away
    if holder >= 0:
        distances_m[:] = r_min_m
        kinds[:] = circle_kinds[holder]
        return True
    for i in range(len(angles_rad)):
        ux, uy = math.cos(angles_rad[i]), math.sin(angles_rad[i])
        best, kind = math.inf, 0
        for k in range(len(segments_m)):
            reach = segment_reach(
                ux,
                uy,
                segments_m[k, 0] - x_m,
                segments_m[k, 1] - y_m,
                segments_m[k, 2] - x_m,
                segments_m[k, 3] - y_m,
            )
            if reach < best:
                best, kind = reach, int(segment_kinds[k])
        for k in range(len(circles_m)):
            reach = circle_reach(ux, uy, circles_m[k, 0] - x_m, circles_m[k, 1] - y_m, radius_m)
            if reach < best:
                best, kind = reach, int(circle_kinds[k])
        distances_m[i] = max(best, r_min_m)
        kinds[i] = kind
    return False
