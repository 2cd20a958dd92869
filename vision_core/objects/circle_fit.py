"""Centers of circles finer than a pixel: a circle is fitted to the places where its color turns into background.

A blob's centroid counts pixels as in or out and is wrong by a tenth of a pixel. Weighing pixels by their color is
better, but the blurred edges of neighbors (the dots of a marker lie 5 mm apart, sometimes less than a pixel) pull the
center towards them. So only the circle's edge is used, divided into sectors that are measured independently:

1. Each sector has three colors: inside the edge, outside of it, and the background, which most sectors have outside.
2. In a band over the edge pixels about one apart are unmixed into these three colors (least squares). The coverage by
   the inside color, minus what the expected circle would give, sums up to the distance of the edge from the expected
   circle.
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
from vision_core.native.pixel_reads import word_at
from vision_core.types.tables import Table

Row: TypeAlias = Any
"""One row of a table."""

BYTE = 255
"""Mask of one channel in a pixel's word."""
SECTORS = 16
BAND_PX = 1.35
"""Half the width of the band over the edge: the blur of a sharp lens and the error of a centroid."""
DEPTHS = 4
"""Rings of pixels in the band."""
SMALL_PX, LARGE_PX = 6.5, 13.0
"""Radii from which on every ring has 4 and 8 pixels in a sector, not 2."""
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
MAX_STEP_PX = 0.88
"""Limit of an edge's displacement: more cannot be measured in the band."""
EDGE_SD_PX = 0.08
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
        ("pixel", np.int64, (DEPTHS * SECTORS,)),
        ("rho", np.float64, (DEPTHS * SECTORS,)),
        ("word", np.int64, (DEPTHS * SECTORS,)),
        *((name, np.float64, (SECTORS,)) for name in (
            "displacement", "inside_b", "inside_g", "inside_r", "outside_b", "outside_g", "outside_r",
            "weight_b", "weight_g", "weight_r", "offset", "used", "continues", "distance",
        )),
    ]
)  # fmt: skip
"""All sectors: number of a pixel on each ring, its distance from the center [px], and its color as a word; displacement
of the edge [px] (first the sum of surplus coverage), colors inside and outside, weights and offset that give a pixel's
coverage, whether the sector is used (0 or 1), whether the circle's color continues outside of it (0 or 1), and distance
of the outside color from those of every second sector. Each quantity lies side by side for all sectors, so that one
instruction takes several; ``count`` is always SECTORS, but the compiler makes such instructions only of loops whose
length it does not know."""

TURNS, MIDDLE = 16, 8
"""Parts of a sector's angle, and where the middle is."""
_TURNED = (np.arange(SECTORS) + np.arange(TURNS)[:, None] / TURNS) * (math.tau / SECTORS)
_ALONG, _ACROSS = frozen(np.cos(_TURNED)), frozen(np.sin(_TURNED))
"""Directions of points, shape (TURNS, SECTORS)."""
_NORMALS = frozen(np.column_stack([_ALONG[MIDDLE], _ACROSS[MIDDLE]]))
"""Directions of the sectors' middles, shape (SECTORS, 2)."""


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
    near = max(radius - inside, MIN_RADIUS_SHARE * radius)
    far = max(radius - SECOND_INSIDE * inside, MIN_RADIUS_SHARE * radius)
    _place_ring(pixels, x, y, radius + OUTSIDE_PX, MIDDLE, 0, sectors)
    _place_ring(pixels, x, y, near, MIDDLE, 1, sectors)
    _place_ring(pixels, x, y, far, MIDDLE, 2, sectors)
    _read_rings(pixels, 3, sectors)
    for k in range(sectors.count):
        outer, near_word, far_word = sectors.word[k], sectors.word[SECTORS + k], sectors.word[2 * SECTORS + k]
        sectors.outside_b[k], sectors.outside_g[k] = outer & BYTE, outer >> 8 & BYTE
        sectors.outside_r[k] = outer >> 16 & BYTE
        sectors.inside_b[k] = 0.5 * ((near_word & BYTE) + (far_word & BYTE))
        sectors.inside_g[k] = 0.5 * ((near_word >> 8 & BYTE) + (far_word >> 8 & BYTE))
        sectors.inside_r[k] = 0.5 * ((near_word >> 16 & BYTE) + (far_word >> 16 & BYTE))


@kernel
def _place_ring(pixels: Bytes, x: float, y: float, reach: float, turn: int, ring: int, sectors: Row) -> None:
    """Choose the pixel of every sector that is nearest to a point at a distance from the center.

    turn: the point's direction, in parts of the sector; ring: which of the sectors' pixels it is to be.
    """
    height, width, _ = pixels.shape
    right, bottom = width - 2.0, height - 1.0
    # unsigned indices: numba would test every signed one for counting from the end
    row, first = np.uintp(turn), np.uintp(ring * SECTORS)
    for k in range(np.uintp(sectors.count)):
        u = min(max(np.floor(x + reach * _ALONG[row, k] + 0.5), 0.0), right)
        v = min(max(np.floor(y + reach * _ACROSS[row, k] + 0.5), 0.0), bottom)
        sectors.rho[first + k] = math.sqrt((u - x) * (u - x) + (v - y) * (v - y))
        sectors.pixel[first + k] = np.int64(v) * width + np.int64(u)


@kernel
def _read_rings(pixels: Bytes, rings: int, sectors: Row) -> None:
    """Read the chosen pixels, apart from what is computed of them, which then is done for many at once."""
    flat = pixels.reshape(-1)
    for k in range(rings * SECTORS):
        sectors.word[k] = word_at(flat, sectors.pixel[k])


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
    # sum of each outside color's distances to every second one
    count = sectors.count
    for j in range(count):
        sectors.distance[j] = 0.0
    for k in range(0, count, 2):
        blue, green, red = sectors.outside_b[k], sectors.outside_g[k], sectors.outside_r[k]
        for j in range(count):
            off = abs(blue - sectors.outside_b[j]) + abs(green - sectors.outside_g[j])
            sectors.distance[j] += off + abs(red - sectors.outside_r[j])
    central, least = 0, sectors.distance[0]
    for k in range(1, SECTORS):
        if sectors.distance[k] < least:
            central, least = k, sectors.distance[k]
    blue, green, red = sectors.outside_b[central], sectors.outside_g[central], sectors.outside_r[central]
    alike = sum_b = sum_g = sum_r = 0.0
    for j in range(SECTORS):
        b, g, r = sectors.outside_b[j], sectors.outside_g[j], sectors.outside_r[j]
        w = 1.0 if abs(b - blue) + abs(g - green) + abs(r - red) < SAME_BACKGROUND else 0.0
        alike, sum_b, sum_g, sum_r = alike + w, sum_b + w * b, sum_g + w * g, sum_r + w * r
    return sum_b / alike, sum_g / alike, sum_r / alike


@kernel
def _measure_edge(pixels: Bytes, x: float, y: float, radius: float, sectors: Row) -> None:
    """Measure how far the edge lies outside of the expected circle in every sector [px].

    The pixels are those next to points spread over the band, about a pixel apart: DEPTHS rings of them, in so many
    places along the edge of every sector. The pixel's place, not the point's, says what coverage is expected.
    """
    count = sectors.count
    for k in range(count):
        sectors.displacement[k] = 0.0
    places = 2 if radius < SMALL_PX else 4 if radius < LARGE_PX else 8
    for place in range(places):
        turn = (2 * place + 1) * (TURNS // (2 * places))
        for depth in range(DEPTHS):
            # in every other place the rings lie half their distance farther out
            reach = radius + BAND_PX * ((2.0 * depth + 0.5 + place % 2) / DEPTHS - 1.0)
            _place_ring(pixels, x, y, reach, turn, depth, sectors)
        _read_rings(pixels, DEPTHS, sectors)
        for depth in range(DEPTHS):
            for k in range(count):
                word = sectors.word[depth * SECTORS + k]
                coverage = (
                    sectors.offset[k]
                    + sectors.weight_b[k] * (word & BYTE)
                    + sectors.weight_g[k] * (word >> 8 & BYTE)
                    + sectors.weight_r[k] * (word >> 16 & BYTE)
                )
                expected = min(max(0.5 + (radius - sectors.rho[depth * SECTORS + k]) * (1.0 / RAMP_PX), 0.0), 1.0)
                sectors.displacement[k] += min(max(coverage, -0.1), 1.1) - expected
    # mean surplus of coverage times the band's width is the displacement
    for k in range(count):
        sectors.displacement[k] *= 2.0 * BAND_PX / (places * DEPTHS)
        is_beyond = abs(sectors.displacement[k]) > MAX_STEP_PX
        beyond = sectors.used[k] * is_beyond * (sectors.displacement[k] > 0.0)
        sectors.continues[k] = max(sectors.continues[k], beyond)
        sectors.used[k] *= not is_beyond


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
