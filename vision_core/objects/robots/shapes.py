"""What the shape of a patch tells: is it the drawn one, and which way does it point?

A patch is known by its moments round its center. With z = x + i y they are, over its area, the means of z |z|^2,
z^2 and z^3, made free of its size: turning a patch by an angle t turns them by t, 2 t and 3 t. So those of them that
a drawn patch has tell which way a seen one points: a T by its axis (2 t) and by where its bar is (t and 3 t), a
rectangle by its axis only, a circle not at all. (Moments and their invariants: Hu, 1962.)
"""

import math
from typing import NamedTuple

import numpy as np

from vision_core.geometry import Bytes, Floats, frozen
from vision_core.native.kernels import kernel

ORDERS = 3
"""The moments that turn by t, 2 t and 3 t."""

MIN_MOMENT = 0.1
"""A drawn patch with a smaller moment does not show it in a picture."""

MIN_PX = 20
"""Patches of fewer pixels have no shape."""

MAX_STRANGE = 1.3
"""A box may hold so many times its blob's pixels of its color; more belong to something else."""

COARSE = 36
"""Headings that are tried."""
APART = 4
"""Steps of them: a heading that is nearer to the best one is no other."""

LONG, WIDE, STEADY, FIRST_MOMENT = range(4)
"""Places in a seen shape: variance along and across its longer axis [m^2], how firmly it tells its heading [m]
(see ``heading_sd``), then real and imaginary parts of its moments."""
SHAPE_LENGTH = FIRST_MOMENT + 2 * ORDERS

BOUNDARY = 1.7
"""Distance of a patch's rim from its center, in radii of gyration: where the noise of its shape comes from."""


class Shape(NamedTuple):
    """A drawn patch, as kernels take it."""

    moments: Floats
    """Real and imaginary part of every order, shape (3, 2)."""
    weights: Floats
    """How much each order counts; 0 where the patch lacks it. Shape (3,), their sum is 1 or 0."""
    spread_m2: Floats
    """Variances along and across its longer axis, shape (2,) [m^2]."""


def shape_from(points_m: Floats) -> Shape:
    """The shape of a patch from points that fill it evenly, shape (n, 2) [m]."""
    x, y = (points_m - points_m.mean(axis=0)).T
    moments = np.zeros(2 * ORDERS)
    long, wide = _normalize(
        float((x * x).mean()), float((y * y).mean()), float((x * y).mean()),
        float((x * (x * x + y * y)).mean()), float((y * (x * x + y * y)).mean()),
        float((x**3 - 3.0 * x * y * y).mean()), float((3.0 * x * x * y - y**3).mean()), moments,
    )  # fmt: skip
    pairs = moments.reshape(ORDERS, 2)
    strong = np.hypot(*pairs.T) >= MIN_MOMENT
    weights = strong / max(float(strong.sum()), 1.0)
    return Shape(frozen(pairs.copy()), frozen(weights), frozen(np.array([long, wide])))


@kernel
def _normalize(
    xx: float, yy: float, xy: float, first_x: float, first_y: float, third_x: float, third_y: float, moments: Floats
) -> tuple[float, float]:
    """Moments free of size, from means over a patch; returns the variances along and across its longer axis."""
    size = max(xx + yy, 1e-12)
    moments[0], moments[1] = first_x / size**1.5, first_y / size**1.5
    moments[2], moments[3] = (xx - yy) / size, 2.0 * xy / size
    moments[4], moments[5] = third_x / size**1.5, third_y / size**1.5
    apart = math.hypot(xx - yy, 2.0 * xy)
    return 0.5 * (xx + yy + apart), max(0.5 * (xx + yy - apart), 1e-12)


@kernel
def measure_shape(
    pixels: Bytes, classes: Bytes, color: int, area_px: int, box: tuple[int, int, int, int],
    step: tuple[float, float, float, float], seen: Floats,
) -> bool:  # fmt: skip
    """The shape of the pixels of a color class in a box, left, top, right, bottom, inclusive; False if it has none.

    step: how x and y in the field change with a pixel to the right and with one down [m/px]; seen: shape (9,), filled.
    """
    left, top, right, bottom = box
    if area_px < MIN_PX:
        return False
    n = 0.0
    middle_u, middle_v = 0.5 * (left + right), 0.5 * (top + bottom)
    ux, uy, vx, vy = step
    x1 = y1 = xx = yy = xy = xxx = xxy = xyy = yyy = 0.0
    for v in range(top, bottom + 1):
        for u in range(left, right + 1):
            blue, green, red = np.intp(pixels[v, u, 0]), np.intp(pixels[v, u, 1]), np.intp(pixels[v, u, 2])
            if classes[(blue >> 3) << 11 | (green >> 2) << 5 | red >> 3] != color:
                continue
            du, dv = u - middle_u, v - middle_v
            x, y = du * ux + dv * vx, du * uy + dv * vy
            n += 1.0
            x1 += x
            y1 += y
            xx += x * x
            yy += y * y
            xy += x * y
            xxx += x * x * x
            xxy += x * x * y
            xyy += x * y * y
            yyy += y * y * y
    if n < MIN_PX or n > MAX_STRANGE * area_px:
        return False
    x1, y1, xx, yy, xy = x1 / n, y1 / n, xx / n, yy / n, xy / n
    xxx = xxx / n - 3.0 * x1 * xx + 2.0 * x1**3
    yyy = yyy / n - 3.0 * y1 * yy + 2.0 * y1**3
    xxy = xxy / n - 2.0 * x1 * xy - y1 * xx + 2.0 * x1 * x1 * y1
    xyy = xyy / n - 2.0 * y1 * xy - x1 * yy + 2.0 * x1 * y1 * y1
    xx, yy, xy = xx - x1 * x1, yy - y1 * y1, xy - x1 * y1
    pixel = 1.0 / 12.0  # a pixel is a square, not a point
    xx, yy, xy = xx + pixel * (ux * ux + vx * vx), yy + pixel * (uy * uy + vy * vy), xy + pixel * (ux * uy + vx * vy)
    moments = seen[FIRST_MOMENT:]
    seen[LONG], seen[WIDE] = _normalize(
        xx, yy, xy, xxx + xyy, xxy + yyy, xxx - 3.0 * xyy, 3.0 * xxy - yyy, moments
    )  # fmt: skip
    return True


@kernel
def alike(drawn: Shape, seen: Floats) -> float:
    """How like the drawn patch a seen one is, 0..1, by how long and how wide it is for its size."""
    drawn_size = drawn.spread_m2[0] + drawn.spread_m2[1]
    size = seen[LONG] + seen[WIDE]
    share = seen[WIDE] / size / (drawn.spread_m2[1] / drawn_size)
    long = seen[LONG] / size / (drawn.spread_m2[0] / drawn_size)
    return math.sqrt(min(share, 1.0 / share) * min(long, 1.0 / long))


@kernel
def agreement(drawn: Shape, seen: Floats, heading_rad: float) -> float:
    """How well a seen shape agrees with a heading, 0..1; 1 where the drawn patch tells nothing."""
    total = 1.0
    for order in range(ORDERS):
        if drawn.weights[order] > 0.0:
            a, b = drawn.moments[order, 0], drawn.moments[order, 1]
            p, q = seen[FIRST_MOMENT + 2 * order], seen[FIRST_MOMENT + 2 * order + 1]
            turn = (order + 1) * heading_rad
            along = (a * p + b * q) * math.cos(turn) + (a * q - b * p) * math.sin(turn)
            strength = a * a + b * b
            both = math.sqrt(strength * (p * p + q * q))
            total -= drawn.weights[order] * 0.5 * (1.0 - along / max(strength, both))
    return total


@kernel
def heading_from(drawn: Shape, seen: Floats) -> tuple[float, float, float]:
    """The heading at which a seen shape agrees best [rad], how well, and how well the best other one does.

    Writes how firmly it tells the heading into the seen shape.
    """
    best, best_step = -1.0, 0
    for step in range(COARSE):
        here = agreement(drawn, seen, step * 2.0 * math.pi / COARSE)
        if here > best:
            best, best_step = here, step
    heading = best_step * 2.0 * math.pi / COARSE
    for _ in range(2):
        off = strength = 0.0
        for order in range(ORDERS):
            if drawn.weights[order] > 0.0:
                a, b = drawn.moments[order, 0], drawn.moments[order, 1]
                p, q = seen[FIRST_MOMENT + 2 * order], seen[FIRST_MOMENT + 2 * order + 1]
                k = order + 1
                weight = k * k * (a * a + b * b)
                residual = (math.atan2(a * q - b * p, a * p + b * q) - k * heading + math.pi) % (2.0 * math.pi)
                off += weight * (residual - math.pi) / k
                strength += weight
        if strength > 0.0:
            heading += off / strength
    seen[STEADY] = math.sqrt(strength * (seen[LONG] + seen[WIDE]))
    other = -1.0
    for step in range(COARSE):
        apart = abs(step - best_step)
        if min(apart, COARSE - apart) >= APART:
            other = max(other, agreement(drawn, seen, step * 2.0 * math.pi / COARSE))
    return heading, agreement(drawn, seen, heading), other


@kernel
def heading_sd(steady_m: float, center_sd_m: float) -> float:
    """Standard deviation of a heading from a shape [rad], where its center's is known [m].

    Both come from the same noise at the patch's rim: the center takes its mean, the moment of order k its k-th.
    """
    return BOUNDARY * center_sd_m / max(steady_m, 1e-9)
