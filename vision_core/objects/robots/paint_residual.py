"""How far a measured patch is from a paint. Compiled kernels.

Where a lamp's reflection lies on a paper its color is mixed with white: red becomes salmon, green mint, yellow nearly
white. So a paint stands for the curve from its chromaticity to that of white; how far along it a patch lies is free, at
a cost (``VEIL_COST``), and the paint's spread shrinks along it, since less of the paint is left.

A saturated channel may be any amount brighter. So a patch with saturated channels stands for a ray or a cone of
chromaticities, and each paint is compared with the nearest of them: green and cyan, both with green and blue at 255,
are alike.
"""

import math

from vision_core.geometry import Floats
from vision_core.native.kernels import kernel
from vision_core.objects.robots.markers import Marker

X, Y, SATURATED, UNEVEN = range(4)
"""Columns of a robot's measured patches: chromaticity, bits of the saturated channels (1 blue, 2 green, 4 red), and the
largest standard deviation of a channel within the patch [grey levels]."""
OFF_X, OFF_Y, STIFF_XX, STIFF_XY, STIFF_YY, COST = range(4, 10)
"""Columns of a patch's residual from a paint: how far it is, the inverse covariance, and the energy of being this
paint: the logarithm of the covariance's determinant and the cost of the white in it."""
COUNT, SUM_X, SUM_Y, SUM_XX, SUM_XY, SUM_YY = range(6)
"""Columns of what was learned of a class."""

MIN_SPREAD = 0.1
"""Least standard deviation of a paint's chromaticity: print and noise."""
PRIOR_COUNT = 0.3
"""Patches that the color table's reference counts for."""
NO_VEIL, VEILS, MAX_VEIL = 1, 10, 0.9
"""How many shares of white are tried, from 0 to the largest; without any: the first one only."""
VEIL_COST = 8.0
"""Energy of white alone."""
MEASURED_SD = 0.04
"""Standard deviation of a measured chromaticity, however much white is in it."""
MAX_BEYOND = 1.2
"""How far beyond saturation a channel may be: three times as bright."""
_DIRECTIONS = ((1.0, 0.0), (-1.0, -1.0), (0.0, 1.0))
"""Where the chromaticity goes when blue, green or red grows."""


@kernel
def measure_residual(marker: Marker, color: int, patch: Floats, learned: Floats, veils: int) -> None:
    """Fill in the columns of a patch's residual from a paint.

    marker: with the references; color: the paint's class; learned: per class, see ``COUNT``; veils: NO_VEIL or VEILS.
    """
    sums, means, spreads = learned[color], marker.references.means, marker.references.spreads
    n, total = sums[COUNT], PRIOR_COUNT + sums[COUNT]
    mean_x = (PRIOR_COUNT * means[color, 0] + sums[SUM_X]) / total
    mean_y = (PRIOR_COUNT * means[color, 1] + sums[SUM_Y]) / total
    # covariance about the common mean
    cxx = sums[SUM_XX] - 2.0 * mean_x * sums[SUM_X] + n * mean_x * mean_x
    cxy = sums[SUM_XY] - mean_x * sums[SUM_Y] - mean_y * sums[SUM_X] + n * mean_x * mean_y
    cyy = sums[SUM_YY] - 2.0 * mean_y * sums[SUM_Y] + n * mean_y * mean_y
    cxx = (PRIOR_COUNT * spreads[color, 0] + cxx + n * MIN_SPREAD**2) / total
    cxy = (PRIOR_COUNT * spreads[color, 1] + cxy) / total
    cyy = (PRIOR_COUNT * spreads[color, 2] + cyy + n * MIN_SPREAD**2) / total
    # the paint in linear coordinates, so that white can be mixed in
    saturated = int(patch[SATURATED])
    blue, red = math.exp(mean_x), math.exp(mean_y)
    mean = (blue + 1.0 + red) / 3.0
    least = math.inf
    for number in range(veils):
        white = MAX_VEIL * number / (VEILS - 1)
        left = 1.0 - white
        green = left / mean + white
        x = patch[X] - math.log((left * blue / mean + white) / green)
        y = patch[Y] - math.log((left * red / mean + white) / green)
        added = MEASURED_SD**2 if number > 0 else 0.0
        vxx, vxy, vyy = left * left * cxx + added, left * left * cxy, left * left * cyy + added
        volume = vxx * vyy - vxy * vxy
        cost = VEIL_COST * white
        if saturated != 0:
            if number > 0:  # a saturated channel hides how much white there is
                break
            x, y = _beyond_saturation(x, y, saturated)
            if _is_between(mean_x, mean_y, saturated):
                x = y = 0.0
        else:  # a cone of chromaticities has as much room in every paint
            cost += math.log(volume)
        energy = cost + (vyy * x * x - 2.0 * vxy * x * y + vxx * y * y) / volume
        if energy < least:
            least = energy
            patch[OFF_X], patch[OFF_Y], patch[COST] = x, y, cost
            patch[STIFF_XX], patch[STIFF_XY], patch[STIFF_YY] = vyy / volume, -vxy / volume, vxx / volume


@kernel
def _beyond_saturation(x: float, y: float, saturated: int) -> tuple[float, float]:
    """The shortest residual when the saturated channels may be brighter, each in turn."""
    for _ in range(2):
        for channel in range(3):
            if saturated >> channel & 1:
                ahead_x, ahead_y = _DIRECTIONS[channel]
                along = -(x * ahead_x + y * ahead_y) / (ahead_x * ahead_x + ahead_y * ahead_y)
                along = min(max(along, 0.0), MAX_BEYOND)
                x, y = x + along * ahead_x, y + along * ahead_y
    return x, y


@kernel
def _is_between(x: float, y: float, saturated: int) -> bool:
    """Are just two channels saturated, and does a paint's hue lie between theirs? Then it is not excluded."""
    if saturated & (saturated - 1) == 0 or saturated == 7:
        return False
    # coordinates along the two channels' directions, written out: blue (1, 0), green (-1, -1), red (0, 1)
    if saturated == 3:
        return y <= 0.0 and x >= y
    if saturated == 6:
        return x <= 0.0 and y >= x
    return x >= 0.0 and y >= 0.0
