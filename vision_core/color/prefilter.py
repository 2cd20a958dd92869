"""A color table -> a test that the processor applies to 64 pixels at once.

Every cell with a class is assigned to the condition of ``ColorPrefilter`` that it meets best: of the six sectors of the
HSV hexcone the one with the largest margin at the cell's worst corner; for cells that are nearly grey, light or dark. A
condition's limits are those of the worst corner of its worst cell. So every 24-bit color of every cell with a class
passes, and most other colors fail: markers are purer or brighter than most of the floor.
"""

import numpy as np

from vision_core.geometry import Bytes, frozen
from vision_core.native.kernels import kernel
from vision_core.types.colors import CELL_SIZE_BGR, ColorTable, cell_corner
from vision_core.types.prefilter import CONDITIONS, ColorPrefilter

LIGHT, DARK = 6, 7
"""The conditions of cells without a hue."""
MIN_CHROMA = 8
"""Cells with a smaller margin in every sector count as grey."""
MIDDLE_LEVEL = 128
"""Grey cells with a mean level from here on are light, others dark."""

_cell_corner = kernel(cell_corner)


def prefilter_from(table: ColorTable) -> ColorPrefilter:
    """The prefilter of a color table. Takes under a millisecond, so it can be made anew while the service runs."""
    margins, levels = np.empty(CONDITIONS, dtype=np.uint8), np.empty(CONDITIONS, dtype=np.uint8)
    fit_conditions(frozen(table.classes.view()), margins, levels)
    return ColorPrefilter(frozen(margins), frozen(levels))


@kernel
def fit_conditions(classes: Bytes, margin_limit: Bytes, level_limit: Bytes) -> None:
    """Fill the limits of a table's prefilter. classes: shape (65536,); limits: shape (8,)."""
    # until a cell needs it, no color meets a condition
    margin_limit[:] = 255
    level_limit[:] = 255
    level_limit[DARK] = 0
    for cell in range(len(classes)):
        if classes[cell] == 0:
            continue
        low = _cell_corner(cell)
        high = (low[0] + CELL_SIZE_BGR[0] - 1, low[1] + CELL_SIZE_BGR[1] - 1, low[2] + CELL_SIZE_BGR[2] - 1)
        condition, margin, level = _best_condition(low, high)
        # widen the cell's condition until the whole cell passes
        if condition == DARK:
            level_limit[DARK] = max(level_limit[DARK], level)
        else:
            level_limit[condition] = min(level_limit[condition], level)
            margin_limit[condition] = min(margin_limit[condition], margin)


@kernel
def _best_condition(low: tuple[int, int, int], high: tuple[int, int, int]) -> tuple[int, int, int]:
    """The condition that a cell meets best, and the limits of margin and level that let the whole cell pass.

    low, high: the cell's corners, blue green red.
    """
    condition, margin, level = -1, MIN_CHROMA - 1, 0
    for channel in range(3):
        one, two = (channel + 1) % 3, (channel + 2) % 3
        ahead, rest = low[channel] - max(high[one], high[two]), min(low[one], low[two])
        if ahead > margin:
            condition, margin, level = channel, ahead, low[channel]
        if rest - high[channel] > margin:
            condition, margin, level = channel + 3, rest - high[channel], rest
    if condition >= 0:
        return condition, margin - 1, level - 1
    if sum(low) >= 3 * MIDDLE_LEVEL:
        return LIGHT, 0, min(low) - 1
    return DARK, 0, min(max(high) + 1, 255)
