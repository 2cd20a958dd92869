"""The shape of a patch: is it the drawn one, and which heading does it show?

A patch is described by its moments about its center. With z = x + i y they are the means of z |z|^2, z^2 and z^3 over
the patch, divided by powers of its size. Turning the patch by an angle t turns them by t, 2 t and 3 t. So the moments
that are not zero for the drawn patch show the heading of a seen one: a T by its axis (2 t) and by the side of its bar
(t and 3 t), a rectangle by its axis only, a circle not at all. (Hu, "Visual pattern recognition by moment invariants",
IRE Transactions on Information Theory, 1962.)
"""

import math
from typing import Any, NamedTuple, TypeAlias

import numpy as np

from vision_core.geometry import Bytes, Floats, frozen
from vision_core.native.kernels import kernel
from vision_core.types.color_cells import color_cell
from vision_core.types.tables import Table

Row: TypeAlias = Any
"""One row of a table."""

ORDERS = 3
"""The moments that turn by t, 2 t and 3 t."""

MIN_MOMENT = 0.1
"""A smaller moment of a drawn patch cannot be measured in a picture."""

MIN_PX = 20
"""The shape of a patch with fewer pixels is not measured."""

MAX_BOX_PIXELS = 1.3
"""Limit of the pixels of a blob's color in its box, as a multiple of the blob's pixels; more belong to another blob."""

HEADING_STEPS = 36
"""Headings that are tried before the best one is refined."""
MIN_STEPS_APART = 4
"""A heading fewer steps away from the best one is not an alternative to it."""

MEASURED_SHAPE = np.dtype(
    [
        ("long_m2", np.float64), ("wide_m2", np.float64), ("heading_stiffness_m", np.float64),
        ("moments", np.float64, (ORDERS, 2)),
    ]
)  # fmt: skip
"""A seen patch: variance along and across its longer axis, how strongly its moments resist a turn (``heading_sd``), and
real and imaginary part of each moment."""

EDGE_RADII = 1.7
"""Distance of a patch's edge from its center, in radii of gyration: the noise of the shape arises at the edge."""


class PatchShape(NamedTuple):
    """A drawn patch. Kernels take it as an argument."""

    moments: Floats
    """Real and imaginary part of every order, shape (3, 2)."""
    weights: Floats
    """Weight of each order, 0 for a moment that the patch lacks; shape (3,), their sum is 1 or 0."""
    variances_m2: Floats
    """Along and across the patch's longer axis, shape (2,)."""


def shape_from(points_m: Floats) -> PatchShape:
    """The shape of a patch from points that fill it evenly, shape (n, 2) [m]."""
    x, y = (points_m - points_m.mean(axis=0)).T
    moments = np.zeros((ORDERS, 2))
    long, wide = _normalize(
        float((x * x).mean()), float((y * y).mean()), float((x * y).mean()),
        float((x * (x * x + y * y)).mean()), float((y * (x * x + y * y)).mean()),
        float((x**3 - 3.0 * x * y * y).mean()), float((3.0 * x * x * y - y**3).mean()), moments,
    )  # fmt: skip
    strong = np.hypot(*moments.T) >= MIN_MOMENT
    weights = strong / max(float(strong.sum()), 1.0)
    return PatchShape(frozen(moments), frozen(weights), frozen(np.array([long, wide])))


def measured_from(shape: PatchShape) -> Table:
    """A drawn shape as if it had been measured, shape (1,)."""
    seen = np.zeros(1, dtype=MEASURED_SHAPE)
    seen["long_m2"], seen["wide_m2"] = shape.variances_m2
    seen["moments"] = shape.moments
    return seen


@kernel
def _normalize(
    xx: float, yy: float, xy: float, first_x: float, first_y: float, third_x: float, third_y: float, moments: Floats
) -> tuple[float, float]:
    """Fill in the moments free of size, from means over a patch; the variances along and across its longer axis."""
    size = max(xx + yy, 1e-12)
    moments[0, 0], moments[0, 1] = first_x / size**1.5, first_y / size**1.5
    moments[1, 0], moments[1, 1] = (xx - yy) / size, 2.0 * xy / size
    moments[2, 0], moments[2, 1] = third_x / size**1.5, third_y / size**1.5
    difference = math.hypot(xx - yy, 2.0 * xy)
    return 0.5 * (xx + yy + difference), max(0.5 * (xx + yy - difference), 1e-12)


@kernel
def measure_shape(
    pixels: Bytes, classes: Bytes, color: int, area_px: int, box: tuple[int, int, int, int],
    step: tuple[float, float, float, float], seen: Row,
) -> bool:  # fmt: skip
    """Measure the shape of the pixels of a color class in a box; False if it cannot be measured.

    box: left, top, right, bottom, inclusive; step: how x and y in the field change with one pixel to the right and with
    one pixel down [m/px]; seen: a row of MEASURED_SHAPE, filled except for its heading stiffness.
    """
    left, top, right, bottom = box
    if area_px < MIN_PX:
        return False
    # sums of powers of x and y over the class's pixels, in field coordinates about the box's middle
    n = 0.0
    middle_u, middle_v = 0.5 * (left + right), 0.5 * (top + bottom)
    ux, uy, vx, vy = step
    x1 = y1 = xx = yy = xy = xxx = xxy = xyy = yyy = 0.0
    for v in range(top, bottom + 1):
        for u in range(left, right + 1):
            if classes[color_cell(pixels[v, u, 0], pixels[v, u, 1], pixels[v, u, 2])] != color:
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
    if n < MIN_PX or n > MAX_BOX_PIXELS * area_px:
        return False
    # means about the center of gravity instead of the box's middle
    x1, y1, xx, yy, xy = x1 / n, y1 / n, xx / n, yy / n, xy / n
    xxx = xxx / n - 3.0 * x1 * xx + 2.0 * x1**3
    yyy = yyy / n - 3.0 * y1 * yy + 2.0 * y1**3
    xxy = xxy / n - 2.0 * x1 * xy - y1 * xx + 2.0 * x1 * x1 * y1
    xyy = xyy / n - 2.0 * y1 * xy - x1 * yy + 2.0 * x1 * y1 * y1
    xx, yy, xy = xx - x1 * x1, yy - y1 * y1, xy - x1 * y1
    # a pixel is a square with a variance of its own, not a point
    pixel = 1.0 / 12.0
    xx, yy, xy = xx + pixel * (ux * ux + vx * vx), yy + pixel * (uy * uy + vy * vy), xy + pixel * (ux * uy + vx * vy)
    seen.long_m2, seen.wide_m2 = _normalize(
        xx, yy, xy, xxx + xyy, xxy + yyy, xxx - 3.0 * xyy, 3.0 * xxy - yyy, seen.moments
    )  # fmt: skip
    return True


@kernel
def aspect_score(drawn: PatchShape, seen: Row) -> float:
    """How similar length and width of a seen patch, relative to its size, are to those of the drawn one, 0..1."""
    drawn_size = drawn.variances_m2[0] + drawn.variances_m2[1]
    size = seen.long_m2 + seen.wide_m2
    wide = seen.wide_m2 / size / (drawn.variances_m2[1] / drawn_size)
    long = seen.long_m2 / size / (drawn.variances_m2[0] / drawn_size)
    return math.sqrt(min(wide, 1.0 / wide) * min(long, 1.0 / long))


@kernel
def heading_score(drawn: PatchShape, seen: Row, heading_rad: float) -> float:
    """How well a seen shape agrees with a heading, 0..1; 1 where the drawn patch shows no heading."""
    total = 1.0
    for order in range(ORDERS):
        if drawn.weights[order] > 0.0:
            # the seen moment, turned back by the heading, projected on the drawn one
            a, b = drawn.moments[order, 0], drawn.moments[order, 1]
            p, q = seen.moments[order, 0], seen.moments[order, 1]
            turn = (order + 1) * heading_rad
            along = (a * p + b * q) * math.cos(turn) + (a * q - b * p) * math.sin(turn)
            strength = a * a + b * b
            both = math.sqrt(strength * (p * p + q * q))
            total -= drawn.weights[order] * 0.5 * (1.0 - along / max(strength, both))
    return total


@kernel
def heading_from_shape(drawn: PatchShape, seen: Row) -> tuple[float, float, float]:
    """The heading that a seen shape agrees with best [rad], its score, and the score of the best alternative.

    Fills in the seen shape's heading stiffness.
    """
    # the best of evenly spaced headings
    best, best_step = -1.0, 0
    for step in range(HEADING_STEPS):
        score = heading_score(drawn, seen, step * 2.0 * math.pi / HEADING_STEPS)
        if score > best:
            best, best_step = score, step
    # two steps of Gauss-Newton on the moments' angles
    heading = best_step * 2.0 * math.pi / HEADING_STEPS
    for _ in range(2):
        off = strength = 0.0
        for order in range(ORDERS):
            if drawn.weights[order] > 0.0:
                a, b = drawn.moments[order, 0], drawn.moments[order, 1]
                p, q = seen.moments[order, 0], seen.moments[order, 1]
                k = order + 1
                weight = k * k * (a * a + b * b)
                residual = (math.atan2(a * q - b * p, a * p + b * q) - k * heading + math.pi) % (2.0 * math.pi)
                off += weight * (residual - math.pi) / k
                strength += weight
        if strength > 0.0:
            heading += off / strength
    seen.heading_stiffness_m = math.sqrt(strength * (seen.long_m2 + seen.wide_m2))
    # the best of the headings that are clearly different
    alternative = -1.0
    for step in range(HEADING_STEPS):
        apart = abs(step - best_step)
        if min(apart, HEADING_STEPS - apart) >= MIN_STEPS_APART:
            alternative = max(alternative, heading_score(drawn, seen, step * 2.0 * math.pi / HEADING_STEPS))
    return heading, heading_score(drawn, seen, heading), alternative


@kernel
def heading_sd(stiffness_m: float, center_sd_m: float) -> float:
    """Standard deviation of a heading from a shape [rad], given that of the patch's center [m].

    Both come from the same noise at the patch's edge: the center is its mean, the moment of order k its k-th harmonic.
    """
    return EDGE_RADII * center_sd_m / max(stiffness_m, 1e-9)
