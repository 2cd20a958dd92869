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
from vision_core.kernels import kernel

SECTORS = 16
BAND_PX = 1.1
"""Half the width of the band over the rim: what a sharp lens smears it over, and the error of a centroid."""
OUTSIDE_PX = 1.6
PAPER_INSIDE_PX, SPHERE_INSIDE_PX = 1.55, 0.9
"""Where the colors beyond and inside the rim are taken, from the rim: of flat paper where the lens smears nothing
over it; of a ball, whose shade changes within few pixels, nearer to the rim."""
SECOND_INSIDE = 1.4
"""Where the inner color is taken a second time, in distances of the first."""
LEAST_RADIUS = 0.3
"""In radii: not nearer to the center, for circles of few pixels."""
RAMP_PX = 1.5
"""Width over which a rim's share falls from 1 to 0."""

ALIKE = 30.0
"""Sum of three channels' differences up to which colors beyond the rim are one background."""
NOISE = 5.0
"""Grey levels: a color beyond the rim that differs by less from the background is the background."""
LEAST_CONTRAST = 20.0
LEAST_INDEPENDENCE = 0.15
"""Squared sine of the angle between the inner and the outer color, seen from the background."""

SAME_HUE, DARKEST_SHADE = 0.85, 0.4
"""Squared cosine between two colors of one thing at least, and the darker one's share of the other's light."""

FEWEST_SECTORS = 5
LARGEST_SHIFT_PX = 1.5
LARGEST_STEP = 0.8
"""Half bands that a rim may be off the supposed circle: more cannot be measured in the band."""
RIM_SD_PX = 0.075
"""Deviation of a sector's displacement before anything is known of the circle, were its radius one pixel: a longer
rim has more pixels."""
PRIOR_SECTORS = 4.0
RADIUS_SD = 0.05
"""Relative deviation of the radius that the camera model predicts."""
OUTLIER_SD, LEAST_OUTLIER_PX = 3.0, 0.1
UNREFINED_SD = 0.05
"""Deviation of a center that could not be refined, in radii."""

PIXELS, SHARES, RIM_X, RIM_Y, WEIGHT_B, WEIGHT_G, WEIGHT_R, OFFSET, OUT_B, OUT_G, OUT_R, USED, BEYOND = range(13)
COLUMNS = 13
"""Columns of the memory: of each sector its pixels, their surplus of share (then: its displacement), the rim's mean
normal, the weights and the offset that unmix, the color outside, whether it takes part, and whether the circle's
color goes on beyond it."""

_TURNS = (np.arange(SECTORS) + 0.5) * (math.tau / SECTORS)
_NORMALS = frozen(np.column_stack([np.cos(_TURNS), np.sin(_TURNS)]))
_EIGHTH = math.tan(math.pi / 8.0)


def center_memory() -> Floats:
    """What ``refined_circle`` works in, taken once."""
    return np.zeros((SECTORS, COLUMNS))


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
    if used < FEWEST_SECTORS or not dx * dx + dy * dy <= LARGEST_SHIFT_PX * LARGEST_SHIFT_PX:
        return x_px, y_px, UNREFINED_SD * radius_px, 0
    for k in range(SECTORS):
        if memory[k, BEYOND] != 0.0:
            used -= 2 if memory[k, USED] != 0.0 else 1
    return x_px + dx, y_px + dy, sd, used


@kernel
def _unmix(
    pixels: Bytes, x: float, y: float, radius: float, core_x: float, core_y: float, inside: float, memory: Floats
) -> None:
    """Find each sector's colors and the weights that tell the share of the inner one: w (color - background)."""
    for k in range(SECTORS):
        reach = radius + OUTSIDE_PX
        v, u = _pixel_at(pixels, x + reach * _NORMALS[k, 0], y + reach * _NORMALS[k, 1])
        for channel in range(3):
            memory[k, OUT_B + channel] = pixels[v, u, channel]
    blue, green, red = _background(memory)
    v, u = _pixel_at(pixels, core_x, core_y)
    core = np.float64(pixels[v, u, 0]), np.float64(pixels[v, u, 1]), np.float64(pixels[v, u, 2])
    near = max(radius - inside, LEAST_RADIUS * radius)
    far = max(radius - SECOND_INSIDE * inside, LEAST_RADIUS * radius)
    for k in range(SECTORS):
        c, s = _NORMALS[k, 0], _NORMALS[k, 1]
        v, u = _pixel_at(pixels, x + near * c, y + near * s)
        j, i = _pixel_at(pixels, x + far * c, y + far * s)
        f0 = 0.5 * (np.float64(pixels[v, u, 0]) + np.float64(pixels[j, i, 0]))
        f1 = 0.5 * (np.float64(pixels[v, u, 1]) + np.float64(pixels[j, i, 1]))
        f2 = 0.5 * (np.float64(pixels[v, u, 2]) + np.float64(pixels[j, i, 2]))
        alike = _is_shade(f0, f1, f2, core)
        f0, f1, f2 = f0 - blue, f1 - green, f2 - red
        q0, q1, q2 = memory[k, OUT_B] - blue, memory[k, OUT_G] - green, memory[k, OUT_R] - red
        ff = f0 * f0 + f1 * f1 + f2 * f2
        fq = f0 * q0 + f1 * q1 + f2 * q2
        qq = q0 * q0 + q1 * q1 + q2 * q2 + NOISE * NOISE
        volume = ff * qq - fq * fq
        distinct = ff > LEAST_CONTRAST * LEAST_CONTRAST and volume > LEAST_INDEPENDENCE * ff * qq
        memory[k, USED] = alike and distinct
        memory[k, BEYOND] = _is_shade(memory[k, OUT_B], memory[k, OUT_G], memory[k, OUT_R], core)
        inner, outer = qq / max(volume, 1.0), fq / max(volume, 1.0)
        memory[k, WEIGHT_B] = inner * f0 - outer * q0
        memory[k, WEIGHT_G] = inner * f1 - outer * q1
        memory[k, WEIGHT_R] = inner * f2 - outer * q2
        memory[k, OFFSET] = -(memory[k, WEIGHT_B] * blue + memory[k, WEIGHT_G] * green + memory[k, WEIGHT_R] * red)


@kernel
def _is_shade(blue: float, green: float, red: float, core: tuple[float, float, float]) -> bool:
    """Is a color about that of the core, in more or less light?"""
    own = blue * blue + green * green + red * red
    cores = core[0] * core[0] + core[1] * core[1] + core[2] * core[2]
    common = blue * core[0] + green * core[1] + red * core[2]
    return common * common >= SAME_HUE * own * cores and own >= DARKEST_SHADE * DARKEST_SHADE * cores


@kernel
def _pixel_at(pixels: Bytes, x: float, y: float) -> tuple[int, int]:
    """Row and column of the pixel nearest to a place; at the picture's edge the last one."""
    height, width, _ = pixels.shape
    return min(max(int(y + 0.5), 0), height - 1), min(max(int(x + 0.5), 0), width - 1)


@kernel
def _background(memory: Floats) -> tuple[float, float, float]:
    """Mean of the colors beyond the rim that are like the one that is nearest to all others."""
    best, best_distance = 0, np.inf
    for k in range(SECTORS):
        distance = 0.0
        for j in range(SECTORS):
            distance += _difference(memory, k, j)
        if distance < best_distance:
            best, best_distance = k, distance
    count = blue = green = red = 0.0
    for j in range(SECTORS):
        if _difference(memory, best, j) < ALIKE:
            count += 1.0
            blue += memory[j, OUT_B]
            green += memory[j, OUT_G]
            red += memory[j, OUT_R]
    return blue / count, green / count, red / count


@kernel
def _difference(memory: Floats, k: int, j: int) -> float:
    blue, green = abs(memory[k, OUT_B] - memory[j, OUT_B]), abs(memory[k, OUT_G] - memory[j, OUT_G])
    return float(blue + green + abs(memory[k, OUT_R] - memory[j, OUT_R]))


@kernel
def _measure_rim(pixels: Bytes, x: float, y: float, radius: float, memory: Floats) -> None:
    """How far the rim lies outside of the supposed circle in every sector [px], and its mean normal."""
    height, width, _ = pixels.shape
    for k in range(SECTORS):
        memory[k, PIXELS] = memory[k, SHARES] = memory[k, RIM_X] = memory[k, RIM_Y] = 0.0
    outer, inner = radius + BAND_PX, max(radius - BAND_PX, 0.0)
    for v in range(max(math.ceil(y - outer), 0), min(int(y + outer) + 1, height)):
        dy = v - y
        reach = math.sqrt(max(outer * outer - dy * dy, 0.0))
        hole = math.sqrt(max(inner * inner - dy * dy, 0.0))
        last = min(int(x + reach) + 1, width)
        u = max(math.ceil(x - reach), 0)
        while u < last:
            dx = u - x
            if abs(dx) < hole:
                u = max(math.ceil(x + hole), u + 1)
                continue
            rho = max(math.sqrt(dx * dx + dy * dy), 1e-9)
            k = _sector(dx, dy)
            share = (
                memory[k, OFFSET]
                + memory[k, WEIGHT_B] * pixels[v, u, 0]
                + memory[k, WEIGHT_G] * pixels[v, u, 1]
                + memory[k, WEIGHT_R] * pixels[v, u, 2]
            )
            expected = min(max(0.5 + (radius - rho) / RAMP_PX, 0.0), 1.0)
            memory[k, PIXELS] += 1.0
            memory[k, SHARES] += min(max(share, -0.1), 1.1) - expected
            memory[k, RIM_X] += dx / rho
            memory[k, RIM_Y] += dy / rho
            u += 1
    for k in range(SECTORS):
        count = max(memory[k, PIXELS], 1.0)
        memory[k, SHARES] *= 2.0 * BAND_PX / count
        memory[k, RIM_X] /= count
        memory[k, RIM_Y] /= count
        if memory[k, PIXELS] < 2.0 or abs(memory[k, SHARES]) > LARGEST_STEP * BAND_PX:
            memory[k, BEYOND] = max(memory[k, BEYOND], memory[k, USED] * (memory[k, SHARES] > 0.0))
            memory[k, USED] = 0.0


@kernel
def _sector(dx: float, dy: float) -> int:
    """Which sixteenth of the full turn a direction lies in, as ``_NORMALS`` counts."""
    across, along = abs(dx), abs(dy)
    steep = along > across
    less, more = (across, along) if steep else (along, across)
    nearer = less < more * _EIGHTH  # to the axis
    k = (3 if nearer else 2) if steep else (0 if nearer else 1)
    if dx < 0.0:
        k = 7 - k
    return 15 - k if dy < 0.0 else k


@kernel
def _fit(radius: float, memory: Floats) -> tuple[float, float, float, int]:
    """Shift of the circle that fits the sectors' displacements, its deviation [px], and how many sectors fit."""
    rim_variance = RIM_SD_PX * RIM_SD_PX / radius
    trust = rim_variance / (RADIUS_SD * radius) ** 2
    while True:
        cc, ss, cs, c1, s1, n1 = 1e-9, 1e-9, 0.0, 0.0, 0.0, trust
        cd = sd = d1 = 0.0
        used = 0
        for k in range(SECTORS):
            if memory[k, USED] != 0.0:
                c, s, d = memory[k, RIM_X], memory[k, RIM_Y], memory[k, SHARES]
                used += 1
                cc, ss, cs = cc + c * c, ss + s * s, cs + c * s
                c1, s1, n1 = c1 + c, s1 + s, n1 + 1.0
                cd, sd, d1 = cd + c * d, sd + s * d, d1 + d
        if used < FEWEST_SECTORS:
            return 0.0, 0.0, 0.0, used
        cc, ss, cs = cc - c1 * c1 / n1, ss - s1 * s1 / n1, cs - c1 * s1 / n1  # the radius is eliminated
        cd, sd = cd - c1 * d1 / n1, sd - s1 * d1 / n1
        volume = cc * ss - cs * cs
        dx, dy = (ss * cd - cs * sd) / volume, (cc * sd - cs * cd) / volume
        wider = (d1 - c1 * dx - s1 * dy) / n1
        squares, worst, worst_off = PRIOR_SECTORS * rim_variance, 0, 0.0
        for k in range(SECTORS):
            if memory[k, USED] != 0.0:
                off = abs(memory[k, SHARES] - dx * memory[k, RIM_X] - dy * memory[k, RIM_Y] - wider)
                squares += off * off
                if off > worst_off:
                    worst, worst_off = k, off
        variance = squares / (PRIOR_SECTORS + max(used - 3, 0))
        others = (squares - worst_off * worst_off) / (PRIOR_SECTORS + max(used - 4, 0))
        if worst_off <= max(OUTLIER_SD * math.sqrt(others), LEAST_OUTLIER_PX):
            return dx, dy, math.sqrt(0.5 * variance * (cc + ss) / volume), used
        memory[worst, USED] = 0.0
