"""Centers of circles finer than a pixel: a circle is fitted to the places where its color turns into background.

A blob's centroid counts pixels as in or out and is wrong by a tenth of a pixel. Weighing pixels by their color is
better, but the blurred edges of neighbors (the dots of a marker lie 5 mm apart, sometimes less than a pixel) pull the
center towards them. So only the circle's edge is used, divided into sectors that are measured independently:

1. Each sector has three colors: inside the edge, outside of it, and the background, which most sectors have outside.
2. In a band over the edge every pixel is unmixed into these three colors (least squares). The coverage by the inside
   color, minus what the expected circle would give, sums up to the distance of the edge from the expected circle.
3. A circle is fitted to the sectors' displacements. A sector that does not fit (something covers the edge, or the
   color outside is the same) is left out, so that what is hidden does not pull the center away.

The standard deviation follows from the fit's residuals. Unmixing as in Adams, Smith, Johnson, "Spectral mixture
modeling", JGR 91 (1986); the fit is the linearized one of Coope, "Circle fitting by linear and nonlinear least
squares", JOTA 76 (1993).
"""

import math
from typing import Any, TypeAlias

import numpy as np

from vision_core.geometry import Bytes, frozen
from vision_core.native.kernels import kernel
from vision_core.types.tables import Table

Row: TypeAlias = Any
"""One row of a table."""

SECTORS = 16
BAND_PX = 1.1
"""Half the width of the band over the edge: the blur of a sharp lens and the error of a centroid."""
OUTSIDE_PX = 1.6
PAPER_INSIDE_PX, SPHERE_INSIDE_PX = 1.55, 0.9
"""Distances from the edge at which the colors outside and inside are taken. Inside: of flat paper, beyond the lens's
blur; of a ball, whose shading changes within few pixels, nearer to the edge."""
SECOND_INSIDE = 1.4
"""Distance at which the inside color is taken a second time, as a multiple of the first."""
MIN_RADIUS_SHARE = 0.3
"""The inside color is not taken nearer to the center than this share of the radius."""
RAMP_PX = 1.5
"""Width over which the coverage of a blurred edge falls from 1 to 0."""

SAME_BACKGROUND = 30.0
"""Sum of three channels' differences up to which colors outside belong to one background [grey levels]."""
NOISE = 5.0
"""A color outside that differs by less from the background is the background [grey levels]."""
MIN_CONTRAST = 20.0
"""Distance between inside color and background that a sector needs [grey levels]."""
MIN_INDEPENDENCE = 0.15
"""Squared sine of the angle between the inside and the outside color, seen from the background."""

MIN_HUE_COSINE2, DARKEST_SHADE = 0.85, 0.4
"""Two colors are shades of one color when the squared cosine between them is at least this, and the second has at
least this share of the first one's light."""

MIN_SECTORS = 5
MAX_SHIFT_PX = 1.5
MAX_STEP = 0.8
"""Limit of an edge's displacement, in half bands: more cannot be measured in the band."""
EDGE_SD_PX = 0.075
"""Expected deviation of a sector's displacement for a radius of one pixel; a longer edge has more pixels."""
PRIOR_SECTORS = 4.0
"""Sectors that this expectation counts for, beside the measured ones."""
RADIUS_SD = 0.05
"""Relative deviation of the radius that the camera model predicts."""
OUTLIER_SD, MIN_OUTLIER_PX = 3.0, 0.1
UNREFINED_SD = 0.05
"""Deviation of a center that could not be refined, in radii."""

SECTOR_BUFFER = np.dtype(
    [
        ("count", np.int64),
        *((name, np.float64, (SECTORS,)) for name in (
            "pixels", "displacement", "inside_b", "inside_g", "inside_r", "outside_b", "outside_g", "outside_r",
            "weight_b", "weight_g", "weight_r", "offset", "used", "continues", "distance",
        )),
    ]
)  # fmt: skip
"""All sectors: pixels in the band, displacement of the edge [px] (first the sum of surplus coverage), colors inside and
outside, weights and offset that give a pixel's coverage, whether the sector is used (0 or 1), whether the circle's
color continues outside of it (0 or 1), and distance of the outside color from those of the other sectors. Each quantity
lies side by side for all sectors, so that one instruction takes several; ``count`` is always SECTORS, but the compiler
makes such instructions only of loops whose length it does not know."""

_ANGLES = (np.arange(SECTORS) + 0.5) * (math.tau / SECTORS)
_NORMALS = frozen(np.column_stack([np.cos(_ANGLES), np.sin(_ANGLES)]))
_TAN_EIGHTH = math.tan(math.pi / 8.0)
_IN_QUADRANT = ((1, 2), (0, 3))
_SECTOR_OF = frozen(
    np.array(
        [
            (15 - along if down else along)
            for nearer in (0, 1)
            for steep in (0, 1)
            for down in (0, 1)
            for left in (0, 1)
            for along in [7 - _IN_QUADRANT[nearer][steep] if left else _IN_QUADRANT[nearer][steep]]
        ]
    )
)
"""Sector by the signs of a pixel's offset, see ``_measure_row``."""


def circle_buffer() -> Table:
    """Memory for ``refined_circle``, SECTOR_BUFFER, shape (1,)."""
    buffer = np.zeros(1, dtype=SECTOR_BUFFER)
    buffer["count"] = SECTORS
    return buffer


@kernel
def refined_circle(
    pixels: Bytes, x_px: float, y_px: float, radius_px: float, buffer: Table
) -> tuple[float, float, float]:
    """Center of a circle of one color and its standard deviation per axis: x, y, sd [px].

    pixels: shape (height, width, 3); x_px, y_px: centroid of its blob; radius_px: predicted by the camera model;
    buffer: of ``circle_buffer``. Where it cannot be refined the centroid is returned, with a large deviation.
    """
    x, y, sd, _ = fitted_circle(pixels, x_px, y_px, radius_px, x_px, y_px, PAPER_INSIDE_PX, buffer)
    return x, y, sd


@kernel
def fitted_circle(
    pixels: Bytes, x_px: float, y_px: float, radius_px: float, core_x: float, core_y: float, inside_px: float,
    buffer: Table,
) -> tuple[float, float, float, int]:  # fmt: skip
    """As ``refined_circle``, and the support of the circle: sectors that fit, minus those where its color continues
    outside of the circle; 0 when it is not refined.

    core_x, core_y: a place that surely has the circle's color [px]; inside_px: distance from the edge at which the
    inside color is taken.
    """
    height, width, _ = pixels.shape
    if not (0.0 < radius_px < width and 0.0 <= x_px < width and 0.0 <= y_px < height):
        return x_px, y_px, UNREFINED_SD * max(radius_px, 1.0), 0
    sectors = buffer[0]
    _find_unmixing(pixels, x_px, y_px, radius_px, core_x, core_y, inside_px, sectors)
    _measure_edge(pixels, x_px, y_px, radius_px, sectors)
    dx, dy, sd, support = _fit(radius_px, sectors)
    if support < MIN_SECTORS or not dx * dx + dy * dy <= MAX_SHIFT_PX * MAX_SHIFT_PX:
        return x_px, y_px, UNREFINED_SD * radius_px, 0
    for k in range(SECTORS):
        if sectors.continues[k] != 0.0:
            support -= 2 if sectors.used[k] != 0.0 else 1
    return x_px + dx, y_px + dy, sd, support


@kernel
def _find_unmixing(
    pixels: Bytes, x: float, y: float, radius: float, core_x: float, core_y: float, inside: float, sectors: Row
) -> None:
    """Find each sector's colors and the weights w that give the coverage of a pixel: w (color - background)."""
    _take_colors(pixels, x, y, radius, inside, sectors)
    blue, green, red = _background(sectors)
    v, u = _pixel_at(pixels, core_x, core_y)
    core = np.float64(pixels[v, u, 0]), np.float64(pixels[v, u, 1]), np.float64(pixels[v, u, 2])
    count = sectors.count
    for k in range(count):
        # outside color q and inside color f, relative to the background
        b, g, r = sectors.outside_b[k], sectors.outside_g[k], sectors.outside_r[k]
        sectors.continues[k] = 1.0 if _is_shade(b, g, r, core) else 0.0
        q0, q1, q2 = b - blue, g - green, r - red
        b, g, r = sectors.inside_b[k], sectors.inside_g[k], sectors.inside_r[k]
        has_core_color = _is_shade(b, g, r, core)
        f0, f1, f2 = b - blue, g - green, r - red
        # normal equations of color = background + coverage f + rest q; the sector counts if they can be solved
        ff = f0 * f0 + f1 * f1 + f2 * f2
        fq = f0 * q0 + f1 * q1 + f2 * q2
        qq = q0 * q0 + q1 * q1 + q2 * q2 + NOISE * NOISE
        volume = ff * qq - fq * fq
        distinct = (ff > MIN_CONTRAST * MIN_CONTRAST) & (volume > MIN_INDEPENDENCE * ff * qq)
        sectors.used[k] = 1.0 if has_core_color & distinct else 0.0
        # their solution for the coverage is linear in the pixel's color
        inverse = 1.0 / max(volume, 1.0)
        inner, outer = inverse * qq, inverse * fq
        w0, w1, w2 = inner * f0 - outer * q0, inner * f1 - outer * q1, inner * f2 - outer * q2
        sectors.weight_b[k], sectors.weight_g[k], sectors.weight_r[k] = w0, w1, w2
        sectors.offset[k] = -(w0 * blue + w1 * green + w2 * red)


@kernel
def _take_colors(pixels: Bytes, x: float, y: float, radius: float, inside: float, sectors: Row) -> None:
    """Take each sector's color outside of the edge, and its color inside as the mean of two places."""
    outside = radius + OUTSIDE_PX
    near = max(radius - inside, MIN_RADIUS_SHARE * radius)
    far = max(radius - SECOND_INSIDE * inside, MIN_RADIUS_SHARE * radius)
    for k in range(SECTORS):
        c, s = _NORMALS[k, 0], _NORMALS[k, 1]
        v, u = _pixel_at(pixels, x + outside * c, y + outside * s)
        j, i = _pixel_at(pixels, x + near * c, y + near * s)
        m, n = _pixel_at(pixels, x + far * c, y + far * s)
        sectors.outside_b[k], sectors.outside_g[k], sectors.outside_r[k] = (
            pixels[v, u, 0],
            pixels[v, u, 1],
            pixels[v, u, 2],
        )
        sectors.inside_b[k] = 0.5 * (np.float64(pixels[j, i, 0]) + np.float64(pixels[m, n, 0]))
        sectors.inside_g[k] = 0.5 * (np.float64(pixels[j, i, 1]) + np.float64(pixels[m, n, 1]))
        sectors.inside_r[k] = 0.5 * (np.float64(pixels[j, i, 2]) + np.float64(pixels[m, n, 2]))


@kernel
def _is_shade(blue: float, green: float, red: float, core: tuple[float, float, float]) -> bool:
    """Is a color about that of the core, brighter or darker?"""
    own = blue * blue + green * green + red * red
    cores = core[0] * core[0] + core[1] * core[1] + core[2] * core[2]
    common = blue * core[0] + green * core[1] + red * core[2]
    return (common * common >= MIN_HUE_COSINE2 * own * cores) & (own >= DARKEST_SHADE * DARKEST_SHADE * cores)


@kernel
def _pixel_at(pixels: Bytes, x: float, y: float) -> tuple[int, int]:
    """Row and column of the pixel nearest to a place, clamped to the picture."""
    height, width, _ = pixels.shape
    return min(max(int(y + 0.5), 0), height - 1), min(max(int(x + 0.5), 0), width - 1)


@kernel
def _background(sectors: Row) -> tuple[float, float, float]:
    """The background: mean of the outside colors that are close to the most central one."""
    # sum of each outside color's distances to all others
    count = sectors.count
    for j in range(count):
        sectors.distance[j] = 0.0
    for k in range(count):
        blue, green, red = sectors.outside_b[k], sectors.outside_g[k], sectors.outside_r[k]
        for j in range(count):
            off = abs(blue - sectors.outside_b[j]) + abs(green - sectors.outside_g[j])
            sectors.distance[j] += off + abs(red - sectors.outside_r[j])
    central = 0
    for k in range(1, SECTORS):
        if sectors.distance[k] < sectors.distance[central]:
            central = k
    alike = blue = green = red = 0.0
    for j in range(SECTORS):
        if _difference(sectors, central, j) < SAME_BACKGROUND:
            alike += 1.0
            blue += sectors.outside_b[j]
            green += sectors.outside_g[j]
            red += sectors.outside_r[j]
    return blue / alike, green / alike, red / alike


@kernel
def _difference(sectors: Row, k: int, j: int) -> float:
    """Sum of the channels' differences between two sectors' outside colors."""
    blue, green = abs(sectors.outside_b[k] - sectors.outside_b[j]), abs(sectors.outside_g[k] - sectors.outside_g[j])
    return float(blue + green + abs(sectors.outside_r[k] - sectors.outside_r[j]))


@kernel
def _measure_edge(pixels: Bytes, x: float, y: float, radius: float, sectors: Row) -> None:
    """Measure how far the edge lies outside of the expected circle in every sector [px]."""
    height, width, _ = pixels.shape
    for k in range(SECTORS):
        sectors.pixels[k] = sectors.displacement[k] = 0.0
    # in each row of pixels the band is one piece, or two with the circle's inside between them
    outer, inner = radius + BAND_PX, max(radius - BAND_PX, 0.0)
    for v in range(max(math.ceil(y - outer), 0), min(int(y + outer) + 1, height)):
        dy = v - y
        reach = math.sqrt(max(outer * outer - dy * dy, 0.0))
        hole = math.sqrt(max(inner * inner - dy * dy, 0.0))
        first, after = max(math.ceil(x - reach), 0), min(int(x + reach) + 1, width)
        hole_first = max(math.floor(x - hole) + 1, first)
        hole_after = max(math.ceil(x + hole), hole_first)
        _measure_row(pixels, v, first, min(hole_first, after), x, dy, radius, sectors)
        _measure_row(pixels, v, hole_after, after, x, dy, radius, sectors)
    # mean surplus of coverage times the band's width is the displacement
    for k in range(SECTORS):
        sectors.displacement[k] *= 2.0 * BAND_PX / max(sectors.pixels[k], 1.0)
        if sectors.pixels[k] < 2.0 or abs(sectors.displacement[k]) > MAX_STEP * BAND_PX:
            beyond = sectors.used[k] * (sectors.displacement[k] > 0.0)
            sectors.continues[k] = max(sectors.continues[k], beyond)
            sectors.used[k] = 0.0


@kernel
def _measure_row(
    pixels: Bytes, v: int, first: int, after: int, x: float, dy: float, radius: float, sectors: Row
) -> None:  # fmt: skip
    """Add up the surplus coverage of the pixels first..after, exclusive, of a row.

    The sector of a pixel follows from signs and comparisons, without a branch.
    """
    row, along = np.uintp(v), abs(dy)
    for u in range(first, after):
        dx = u - x
        across = abs(dx)
        nearer = min(across, along) < _TAN_EIGHTH * max(across, along)  # to an axis than to a diagonal
        k = np.uintp(_SECTOR_OF[np.uintp((dx < 0.0) + 2 * (dy < 0.0) + 4 * (along > across) + 8 * nearer)])
        at = np.uintp(u)
        coverage = (
            sectors.offset[k]
            + sectors.weight_b[k] * pixels[row, at, 0]
            + sectors.weight_g[k] * pixels[row, at, 1]
            + sectors.weight_r[k] * pixels[row, at, 2]
        )
        rho = math.sqrt(dx * dx + dy * dy)
        expected = min(max(0.5 + (radius - rho) * (1.0 / RAMP_PX), 0.0), 1.0)
        sectors.pixels[k] += 1.0
        sectors.displacement[k] += min(max(coverage, -0.1), 1.1) - expected


@kernel
def _fit(radius: float, sectors: Row) -> tuple[float, float, float, int]:
    """Shift of the circle that fits the sectors' displacements, its deviation [px], and how many sectors fit."""
    edge_variance = EDGE_SD_PX * EDGE_SD_PX / radius
    trust = edge_variance / (RADIUS_SD * radius) ** 2
    # sums over the used sectors: of the normals (c, s), their products, and their products with the displacement d
    cc, ss, cs, c1, s1 = 1e-9, 1e-9, 0.0, 0.0, 0.0
    cd = sd = d1 = count = 0.0
    for k in range(SECTORS):
        w = sectors.used[k]  # 0 or 1: no branch
        c, s, d = w * _NORMALS[k, 0], w * _NORMALS[k, 1], w * sectors.displacement[k]
        cc, ss, cs, c1, s1 = cc + c * c, ss + s * s, cs + c * s, c1 + c, s1 + s
        cd, sd, d1, count = cd + c * d, sd + s * d, d1 + d, count + w
    while True:
        used, n1 = int(count), trust + count
        if used < MIN_SECTORS:
            return 0.0, 0.0, 0.0, used
        # solve d = c dx + s dy + wider for the shift, with the radius' change eliminated
        xx, yy, xy = cc - c1 * c1 / n1, ss - s1 * s1 / n1, cs - c1 * s1 / n1
        xd, yd = cd - c1 * d1 / n1, sd - s1 * d1 / n1
        volume = xx * yy - xy * xy
        dx, dy = (yy * xd - xy * yd) / volume, (xx * yd - xy * xd) / volume
        wider = (d1 - c1 * dx - s1 * dy) / n1
        # residuals; done when the largest is no outlier to the others
        squares, worst, worst_off = PRIOR_SECTORS * edge_variance, 0, 0.0
        for k in range(SECTORS):
            residual = sectors.displacement[k] - dx * _NORMALS[k, 0] - dy * _NORMALS[k, 1] - wider
            off = abs(residual) * sectors.used[k]
            squares += off * off
            if off > worst_off:
                worst, worst_off = k, off
        variance = squares / (PRIOR_SECTORS + max(used - 3, 0))
        others = (squares - worst_off * worst_off) / (PRIOR_SECTORS + max(used - 4, 0))
        if worst_off <= max(OUTLIER_SD * math.sqrt(others), MIN_OUTLIER_PX):
            return dx, dy, math.sqrt(0.5 * variance * (xx + yy) / volume), used
        # leave the outlier out and fit again
        sectors.used[worst] = 0.0
        c, s, d = _NORMALS[worst, 0], _NORMALS[worst, 1], sectors.displacement[worst]
        cc, ss, cs, c1, s1 = cc - c * c, ss - s * s, cs - c * s, c1 - c, s1 - s
        cd, sd, d1, count = cd - c * d, sd - s * d, d1 - d, count - 1.0
