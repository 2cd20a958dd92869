"""A color table -> a test that 64 pixels pass or fail at once.

Every cell of a class is given to the form of ``Candidates`` that it fits best: of the hexcone's six sectors the one
whose step is largest at the cell's worst corner, or, for cells that are nearly grey, light or dark. A form asks what
the worst corner of its worst cell can do. So every 24-bit color of every cell passes, and most others fail: a
marker is purer or brighter than most of what it drives on.
"""

import numpy as np

from vision_core.geometry import Bytes, frozen
from vision_core.native.kernels import kernel
from vision_core.types.colors import ColorTable
from vision_core.types.prefilter import FORMS, Candidates

LIGHT, DARK = 6, 7
MIN_CHROMA = 8
"""Cells whose largest step is smaller count as grey."""
MIDDLE = 128


def candidate_test(table: ColorTable) -> Candidates:
    """The test of a table, quickly enough to be made anew while running (under a millisecond)."""
    steps, levels = np.empty(FORMS, dtype=np.uint8), np.empty(FORMS, dtype=np.uint8)
    fit_forms(frozen(table.classes.view()), steps, levels)
    return Candidates(frozen(steps), frozen(levels))


@kernel
def fit_forms(classes: Bytes, least_step: Bytes, least_level: Bytes) -> None:
    """Fill the limits of a table's test. classes: shape (65536,); limits: shape (8,)."""
    least_step[:] = 255
    least_level[:] = 255
    least_level[DARK] = 0
    for cell in range(len(classes)):
        if classes[cell] == 0:
            continue
        low = ((cell >> 11) * 8, (cell >> 5 & 63) * 4, (cell & 31) * 8)
        high = (low[0] + 7, low[1] + 3, low[2] + 7)
        form, step, level = _best_form(low, high)
        if form == DARK:
            least_level[DARK] = max(least_level[DARK], level)
        else:
            least_level[form] = min(least_level[form], level)
            least_step[form] = min(least_step[form], step)


@kernel
def _best_form(low: tuple[int, int, int], high: tuple[int, int, int]) -> tuple[int, int, int]:
    """The form that a cell of these corners fits best, and its limits there."""
    form, step, level = -1, MIN_CHROMA - 1, 0
    for channel in range(3):
        one, two = (channel + 1) % 3, (channel + 2) % 3
        ahead, rest = low[channel] - max(high[one], high[two]), min(low[one], low[two])
        if ahead > step:
            form, step, level = channel, ahead, low[channel]
        if rest - high[channel] > step:
            form, step, level = channel + 3, rest - high[channel], rest
    if form >= 0:
        return form, step - 1, level - 1
    if sum(low) >= 3 * MIDDLE:
        return LIGHT, 0, min(low) - 1
    return DARK, 0, min(max(high) + 1, 255)
