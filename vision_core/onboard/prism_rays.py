"""Kernels: where a ray meets an upright prism, exactly.

A ray starts at the viewpoint; its direction need not be a unit vector. In a prism's own space it is (ox, oy) +
t (dx, dy), at the height eye + t dz.
"""

import math
from typing import TypeAlias

from vision_core.geometry import Floats
from vision_core.native.kernels import kernel

Point: TypeAlias = tuple[float, float, float]
"""x, y, z of a point or direction."""

TIE_M = 1e-9
"""Of two faces that coincide, that of the first solid is seen."""
MISSED, ON_TOP, ON_SIDE, BELOW = range(4)
"""Which face of a prism a ray meets."""


@kernel
def hit_prism(
    shapes: Floats, i: int, eye: float, ox: float, oy: float, dx: float, dy: float, dz: float
) -> tuple[float, int, float, float]:  # fmt: skip
    """t of the entry, the face, and the side's normal there, in the prism's space; inf and MISSED for a miss.

    shapes: as of ``azimuths.shapes_of``; i: the prism's row. A viewpoint inside the prism sees nothing of it.
    """
    enter, leave, nx, ny = outline_interval(shapes, i, ox, oy, dx, dy)
    bottom, top, face = shapes[i, 4], shapes[i, 5], ON_SIDE
    if dz != 0.0:
        first, last = (top - eye) / dz, (bottom - eye) / dz
        if dz > 0.0:
            first, last = last, first
        if first > enter:
            enter, face = first, ON_TOP if dz < 0.0 else BELOW
        leave = min(leave, last)
    elif not bottom < eye < top:
        return math.inf, MISSED, 0.0, 0.0
    if enter >= leave or enter <= 0.0:
        return math.inf, MISSED, 0.0, 0.0
    return enter, face, nx, ny


@kernel
def outline_interval(
    shapes: Floats, i: int, ox: float, oy: float, dx: float, dy: float
) -> tuple[float, float, float, float]:  # fmt: skip
    """Where a line on the floor enters and leaves a prism's outline, and the normal where it enters.

    A miss has an entry of inf and a leaving of -inf.
    """
    if shapes[i, 0]:
        return disc_interval(shapes[i, 1], shapes[i, 3], ox, oy, dx, dy)
    return box_interval(shapes[i, 1], shapes[i, 2], ox, oy, dx, dy)


@kernel
def disc_interval(
    radius: float, front: float, ox: float, oy: float, dx: float, dy: float
) -> tuple[float, float, float, float]:  # fmt: skip
    """The same for a disc cut flat at x = front."""
    a, b, c = dx * dx + dy * dy, ox * dx + oy * dy, ox * ox + oy * oy - radius * radius
    if a == 0.0:
        inside = c < 0.0 and ox < front
        return (-math.inf, math.inf, 0.0, 0.0) if inside else (math.inf, -math.inf, 0.0, 0.0)
    room = b * b - a * c
    if room <= 0.0:
        return math.inf, -math.inf, 0.0, 0.0
    root = math.sqrt(room)
    enter, leave = (-b - root) / a, (-b + root) / a
    nx, ny = (ox + enter * dx) / radius, (oy + enter * dy) / radius
    if dx > 0.0:
        leave = min(leave, (front - ox) / dx)
    elif dx < 0.0:
        at = (front - ox) / dx
        if at > enter:
            enter, nx, ny = at, 1.0, 0.0
    elif ox >= front:
        return math.inf, -math.inf, 0.0, 0.0
    return enter, leave, nx, ny


@kernel
def box_interval(
    length: float, width: float, ox: float, oy: float, dx: float, dy: float
) -> tuple[float, float, float, float]:  # fmt: skip
    """The same for a rectangle round the origin of half sides length (along x) and width, by the slab method."""
    enter, leave, nx, ny = -math.inf, math.inf, 0.0, 0.0
    for axis in range(2):
        o, d, half = (ox, dx, length) if axis == 0 else (oy, dy, width)
        if d == 0.0:
            if abs(o) >= half:
                return math.inf, -math.inf, 0.0, 0.0
            continue
        first, last = (-half - o) / d, (half - o) / d
        if d < 0.0:
            first, last = last, first
        if first > enter:
            enter = first
            sign = -1.0 if d > 0.0 else 1.0
            nx, ny = (sign, 0.0) if axis == 0 else (0.0, sign)
        leave = min(leave, last)
    return enter, leave, nx, ny


@kernel
def hit_sphere(center: Point, radius: float, eye: Point, d: Point) -> float:
    """t where a ray from eye in the direction d meets a sphere; inf for a miss."""
    ox, oy, oz = eye[0] - center[0], eye[1] - center[1], eye[2] - center[2]
    a = d[0] * d[0] + d[1] * d[1] + d[2] * d[2]
    b = ox * d[0] + oy * d[1] + oz * d[2]
    room = b * b - a * (ox * ox + oy * oy + oz * oz - radius * radius)
    if not room > 0.0:
        return math.inf
    t = -(b + math.sqrt(room)) / a
    return t if t > 0.0 else math.inf
