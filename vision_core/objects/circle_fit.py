"""Centers of circles finer than a pixel: a circle is laid through the places where color turns into background.

A blob's centroid counts pixels as in or out and is wrong by a tenth of a pixel; weighing pixels by their color is
better, but what neighbors shed on the rim (a marker's dots lie 5 mm apart, less than a pixel at times) pulls the
center to them. So only the rim is looked at, in sectors, each by itself:

1. The color inside the rim, the color beyond it, and the background that most sectors have between them.
2. In a band over the rim every pixel is unmixed into these three (least squares). The share of the inner color,
   less what the circle as it is supposed would give, sums up to how far the rim lies outside of it there.
3. A circle is fitted to the sectors' displacements; a sector that does not fit (something covers the rim, or what
   lies beyond has the same color) is left out, so that what is hidden does not pull the center away.

The fit's residuals tell the deviation. Unmixing as in Adams, Smith, Johnson, "Spectral mixture modeling", JGR 91
(1986); the fit is the linearized one of Coope, "Circle fitting by linear and nonlinear least squares", JOTA 76 (1993).
"""

import math

import numpy as np

from vision_core.geometry import Bytes, Floats, frozen
from vision_core.native.kernels import kernel

SECTORS = 16
BAND_PX = 1.1
"""Half the width of the band over the rim: what a sharp lens smears it over, and the error of a centroid."""
OUTSIDE_PX = 1.6
PAPER_INSIDE_PX, SPHERE_INSIDE_PX = 1.55, 0.9
"""Where the colors beyond and inside the rim are taken, from the rim: of flat paper where the lens smears nothing
over it; of a ball, whose shade changes within few pixels, nearer to the rim."""
SECOND_INSIDE = 1.4
"""Where the inner color is taken a second time, in distances of the first."""
MIN_RADIUS = 0.3
"""In radii: not nearer to the center, for circles of few pixels."""
RAMP_PX = 1.5
"""Width over which a rim's share falls from 1 to 0."""

ALIKE = 30.0
"""Sum of three channels' differences up to which colors beyond the rim are one background."""
NOISE = 5.0
"""Grey levels: a color beyond the rim that differs by less from the background is the background."""
MIN_CONTRAST = 20.0
MIN_INDEPENDENCE = 0.15
"""Squared sine of the angle between the inner and the outer color, seen from the background."""

SAME_HUE, DARKEST_SHADE = 0.85, 0.4
"""Squared cosine between two colors of one thing at least, and the darker one's share of the other's light."""

MIN_SECTORS = 5
MAX_SHIFT_PX = 1.5
MAX_STEP = 0.8
"""Half bands that a rim may be off the supposed circle: more cannot be measured in the band."""
RIM_SD_PX = 0.075
"""Deviation of a sector's displacement before anything is known of the circle, were its radius one pixel: a longer
rim has more pixels."""
PRIOR_SECTORS = 4.0
RADIUS_SD = 0.05
"""Relative deviation of the radius that the camera model predicts."""
OUTLIER_SD, MIN_OUTLIER_PX = 3.0, 0.1
UNREFINED_SD = 0.05
"""Deviation of a center that could not be refined, in radii."""

COLUMNS = 14
(
    PIXELS, SHARES, IN_B, IN_G, IN_R, OUT_B, OUT_G, OUT_R, WEIGHT_B, WEIGHT_G, WEIGHT_R, OFFSET, USED, BEYOND,
) = range(0, COLUMNS * SECTORS, SECTORS)  # fmt: skip
DISTANCE = WEIGHT_B
"""Where in the memory the values of all sectors start: their pixels, surplus of share (then: displacement), the colors
inside and outside, the weights and the offset that unmix, whether it takes part, and whether the circle's color goes
on beyond it; before there are weights, how far the outer color is from those of the others. Side by side, so that one
instruction can take several sectors; a loop whose length is not known beforehand is compiled to such."""

_TURNS = (np.arange(SECTORS) + 0.5) * (math.tau / SECTORS)
_NORMALS = frozen(np.column_stack([np.cos(_TURNS), np.sin(_TURNS)]))
_EIGHTH = math.tan(math.pi / 8.0)
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
"""Sector by signs, see ``_measure_rim``."""


def center_memory() -> Floats:
    """What ``refined_circle`` works in, taken once."""
    return np.zeros(COLUMNS * SECTORS)


@kernel
def refined_circle(
    pixels: Bytes, x_px: float, y_px: float, radius_px: float, memory: Floats
) -> tuple[float, float, float]:
    """Center of a circle of one color and its standard deviation per axis: x, y, sd [px].

    pixels: shape (height, width, 3); x_px, y_px: its blob's centroid; radius_px: about as the camera predicts;
    memory: of ``center_memory``. What cannot be refined keeps its centroid, with a large deviation.
    """
    x, y, sd, _ = fitted_circle(pixels, x_px, y_px, radius_px, x_px, y_px, PAPER_INSIDE_PX, memory)
    return x, y, sd


@kernel
def fitted_circle(
    pixels: Bytes, x_px: float, y_px: float, radius_px: float, core_x: float, core_y: float, inside_px: float,
    memory: Floats,
) -> tuple[float, float, float, int]:  # fmt: skip
    """As ``refined_circle``, and the number of sectors that the circle goes through, less those where its color
    goes on beyond the circle (against it, whether they fit or not); 0 when not refined.

    core_x, core_y: where it surely has its color [px]; inside_px: how far inside the rim that is taken.
    """
    height, width, _ = pixels.shape
    if not (0.0 < radius_px < width and 0.0 <= x_px < width and 0.0 <= y_px < height):
        return x_px, y_px, UNREFINED_SD * max(radius_px, 1.0), 0
    _unmix(pixels, x_px, y_px, radius_px, core_x, core_y, inside_px, memory)
    _measure_rim(pixels, x_px, y_px, radius_px, memory)
    dx, dy, sd, used = _fit(radius_px, memory)
    if used < MIN_SECTORS or not dx * dx + dy * dy <= MAX_SHIFT_PX * MAX_SHIFT_PX:
        return x_px, y_px, UNREFINED_SD * radius_px, 0
    for k in range(SECTORS):
        if memory[BEYOND + k] != 0.0:
            used -= 2 if memory[USED + k] != 0.0 else 1
    return x_px + dx, y_px + dy, sd, used


@kernel
def _unmix(
    pixels: Bytes, x: float, y: float, radius: float, core_x: float, core_y: float, inside: float, memory: Floats
) -> None:
    """Find each sector's colors and the weights that tell the share of the inner one: w (color - background)."""
    _look(pixels, x, y, radius, inside, memory)
    blue, green, red = _background(memory)
    v, u = _pixel_at(pixels, core_x, core_y)
    core = np.float64(pixels[v, u, 0]), np.float64(pixels[v, u, 1]), np.float64(pixels[v, u, 2])
    for k in range(len(memory) // COLUMNS):
        b, g, r = memory[OUT_B + k], memory[OUT_G + k], memory[OUT_R + k]
        memory[BEYOND + k] = 1.0 if _is_shade(b, g, r, core) else 0.0
        q0, q1, q2 = b - blue, g - green, r - red
        b, g, r = memory[IN_B + k], memory[IN_G + k], memory[IN_R + k]
        alike = _is_shade(b, g, r, core)
        f0, f1, f2 = b - blue, g - green, r - red
        ff = f0 * f0 + f1 * f1 + f2 * f2
        fq = f0 * q0 + f1 * q1 + f2 * q2
        qq = q0 * q0 + q1 * q1 + q2 * q2 + NOISE * NOISE
        volume = ff * qq - fq * fq
        distinct = (ff > MIN_CONTRAST * MIN_CONTRAST) & (volume > MIN_INDEPENDENCE * ff * qq)
        memory[USED + k] = 1.0 if alike & distinct else 0.0
        share = 1.0 / max(volume, 1.0)
        inner, outer = share * qq, share * fq
        w0, w1, w2 = inner * f0 - outer * q0, inner * f1 - outer * q1, inner * f2 - outer * q2
        memory[WEIGHT_B + k], memory[WEIGHT_G + k], memory[WEIGHT_R + k] = w0, w1, w2
        memory[OFFSET + k] = -(w0 * blue + w1 * green + w2 * red)


@kernel
def _look(pixels: Bytes, x: float, y: float, radius: float, inside: float, memory: Floats) -> None:
    """Take the colors beyond the rim and inside of it, the mean of two places."""
    beyond = radius + OUTSIDE_PX
    near = max(radius - inside, MIN_RADIUS * radius)
    far = max(radius - SECOND_INSIDE * inside, MIN_RADIUS * radius)
    for k in range(SECTORS):
        c, s = _NORMALS[k, 0], _NORMALS[k, 1]
        v, u = _pixel_at(pixels, x + beyond * c, y + beyond * s)
        j, i = _pixel_at(pixels, x + near * c, y + near * s)
        m, n = _pixel_at(pixels, x + far * c, y + far * s)
        for channel in range(3):
            memory[OUT_B + channel * SECTORS + k] = pixels[v, u, channel]
            both = np.float64(pixels[j, i, channel]) + np.float64(pixels[m, n, channel])
            memory[IN_B + channel * SECTORS + k] = 0.5 * both


@kernel
def _is_shade(blue: float, green: float, red: float, core: tuple[float, float, float]) -> bool:
    """Is a color about that of the core, in more or less light?"""
    own = blue * blue + green * green + red * red
    cores = core[0] * core[0] + core[1] * core[1] + core[2] * core[2]
    common = blue * core[0] + green * core[1] + red * core[2]
    return (common * common >= SAME_HUE * own * cores) & (own >= DARKEST_SHADE * DARKEST_SHADE * cores)


@kernel
def _pixel_at(pixels: Bytes, x: float, y: float) -> tuple[int, int]:
    """Row and column of the pixel nearest to a place; at the picture's edge the last one."""
    height, width, _ = pixels.shape
    return min(max(int(y + 0.5), 0), height - 1), min(max(int(x + 0.5), 0), width - 1)


@kernel
def _background(memory: Floats) -> tuple[float, float, float]:
    """Mean of the colors beyond the rim that are like the one that is nearest to all others."""
    sectors = len(memory) // COLUMNS
    for j in range(sectors):
        memory[DISTANCE + j] = 0.0
    for k in range(sectors):
        blue, green, red = memory[OUT_B + k], memory[OUT_G + k], memory[OUT_R + k]
        for j in range(sectors):
            off = abs(blue - memory[OUT_B + j]) + abs(green - memory[OUT_G + j])
            memory[DISTANCE + j] += off + abs(red - memory[OUT_R + j])
    best = 0
    for k in range(1, SECTORS):
        if memory[DISTANCE + k] < memory[DISTANCE + best]:
            best = k
    count = blue = green = red = 0.0
    for j in range(SECTORS):
        if _difference(memory, best, j) < ALIKE:
            count += 1.0
            blue += memory[OUT_B + j]
            green += memory[OUT_G + j]
            red += memory[OUT_R + j]
    return blue / count, green / count, red / count


@kernel
def _difference(memory: Floats, k: int, j: int) -> float:
    blue, green = abs(memory[OUT_B + k] - memory[OUT_B + j]), abs(memory[OUT_G + k] - memory[OUT_G + j])
    return float(blue + green + abs(memory[OUT_R + k] - memory[OUT_R + j]))


@kernel
def _measure_rim(pixels: Bytes, x: float, y: float, radius: float, memory: Floats) -> None:
    """How far the rim lies outside of the supposed circle in every sector [px]."""
    height, width, _ = pixels.shape
    for place in range(PIXELS, SHARES + SECTORS):
        memory[place] = 0.0
    outer, inner = radius + BAND_PX, max(radius - BAND_PX, 0.0)
    for v in range(max(math.ceil(y - outer), 0), min(int(y + outer) + 1, height)):
        dy = v - y
        reach = math.sqrt(max(outer * outer - dy * dy, 0.0))
        hole = math.sqrt(max(inner * inner - dy * dy, 0.0))
        first, after = max(math.ceil(x - reach), 0), min(int(x + reach) + 1, width)
        hole_first = max(math.floor(x - hole) + 1, first)
        hole_after = max(math.ceil(x + hole), hole_first)
        _measure_row(pixels, v, first, min(hole_first, after), x, dy, radius, memory)
        _measure_row(pixels, v, hole_after, after, x, dy, radius, memory)
    for k in range(SECTORS):
        memory[SHARES + k] *= 2.0 * BAND_PX / max(memory[PIXELS + k], 1.0)
        if memory[PIXELS + k] < 2.0 or abs(memory[SHARES + k]) > MAX_STEP * BAND_PX:
            memory[BEYOND + k] = max(memory[BEYOND + k], memory[USED + k] * (memory[SHARES + k] > 0.0))
            memory[USED + k] = 0.0


@kernel
def _measure_row(
    pixels: Bytes, v: int, first: int, after: int, x: float, dy: float, radius: float, memory: Floats
) -> None:  # fmt: skip
    """Add the pixels first..after, exclusive, of a row. Their sectors are told by signs, without a branch."""
    row, along = np.uintp(v), abs(dy)
    for u in range(first, after):
        dx = u - x
        across = abs(dx)
        nearer = min(across, along) < _EIGHTH * max(across, along)  # to the axis
        k = np.uintp(_SECTOR_OF[np.uintp((dx < 0.0) + 2 * (dy < 0.0) + 4 * (along > across) + 8 * nearer)])
        at = np.uintp(u)
        share = (
            memory[OFFSET + k]
            + memory[WEIGHT_B + k] * pixels[row, at, 0]
            + memory[WEIGHT_G + k] * pixels[row, at, 1]
            + memory[WEIGHT_R + k] * pixels[row, at, 2]
        )
        rho = math.sqrt(dx * dx + dy * dy)
        expected = min(max(0.5 + (radius - rho) * (1.0 / RAMP_PX), 0.0), 1.0)
        memory[PIXELS + k] += 1.0
        memory[SHARES + k] += min(max(share, -0.1), 1.1) - expected


@kernel
def _fit(radius: float, memory: Floats) -> tuple[float, float, float, int]:
    """Shift of the circle that fits the sectors' displacements, its deviation [px], and how many sectors fit."""
    rim_variance = RIM_SD_PX * RIM_SD_PX / radius
    trust = rim_variance / (RADIUS_SD * radius) ** 2
    cc, ss, cs, c1, s1 = 1e-9, 1e-9, 0.0, 0.0, 0.0
    cd = sd = d1 = count = 0.0
    for k in range(SECTORS):
        w = memory[USED + k]  # 0 or 1: no branch
        c, s, d = w * _NORMALS[k, 0], w * _NORMALS[k, 1], w * memory[SHARES + k]
        cc, ss, cs, c1, s1 = cc + c * c, ss + s * s, cs + c * s, c1 + c, s1 + s
        cd, sd, d1, count = cd + c * d, sd + s * d, d1 + d, count + w
    while True:
        used, n1 = int(count), trust + count
        if used < MIN_SECTORS:
            return 0.0, 0.0, 0.0, used
        xx, yy, xy = cc - c1 * c1 / n1, ss - s1 * s1 / n1, cs - c1 * s1 / n1  # the radius is eliminated
        xd, yd = cd - c1 * d1 / n1, sd - s1 * d1 / n1
        volume = xx * yy - xy * xy
        dx, dy = (yy * xd - xy * yd) / volume, (xx * yd - xy * xd) / volume
        wider = (d1 - c1 * dx - s1 * dy) / n1
        squares, worst, worst_off = PRIOR_SECTORS * rim_variance, 0, 0.0
        for k in range(SECTORS):
            off = abs(memory[SHARES + k] - dx * _NORMALS[k, 0] - dy * _NORMALS[k, 1] - wider) * memory[USED + k]
            squares += off * off
            if off > worst_off:
                worst, worst_off = k, off
        variance = squares / (PRIOR_SECTORS + max(used - 3, 0))
        others = (squares - worst_off * worst_off) / (PRIOR_SECTORS + max(used - 4, 0))
        if worst_off <= max(OUTLIER_SD * math.sqrt(others), MIN_OUTLIER_PX):
            return dx, dy, math.sqrt(0.5 * variance * (xx + yy) / volume), used
        memory[USED + worst] = 0.0
        c, s, d = _NORMALS[worst, 0], _NORMALS[worst, 1], memory[SHARES + worst]
        cc, ss, cs, c1, s1 = cc - c * c, ss - s * s, cs - c * s, c1 - c, s1 - s
        cd, sd, d1, count = cd - c * d, sd - s * d, d1 - d, count - 1.0
