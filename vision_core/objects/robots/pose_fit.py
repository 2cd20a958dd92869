"""One hypothesis: which blobs it is made of, and the pose fitted to them. Compiled kernels."""

import math

import numpy as np
from numpy.typing import NDArray

from vision_core.geometry import Floats
from vision_core.native.kernels import kernel
from vision_core.objects.robots.buffers import (
    ACROSS,
    ALONG,
    ANCHOR,
    BLOB,
    FIRST_LIKENESS,
    FIRST_SLOT,
    HEADING,
    MATCHED,
    MAX_SLOTS,
    MISFIT,
    ROW_LENGTH,
    SCORE,
    STEADY,
    TEAM,
    X,
    Y,
)

Indices = NDArray[np.int32]

GATHER = 1.5
"""Before the fit a patch may be this many tolerances off, as one alone fixed the heading."""

KEPT = 8
"""Hypotheses kept per anchor: more are no use to the contest."""


@kernel
def gather(
    near: Floats, count: int, arms: Floats, tolerance: float, first: int, where: int, filled: Indices
) -> bool:  # fmt: skip
    """Take one blob for one slot, and for every other slot the nearest blob within the gate; False if it cannot be."""
    if near[first, FIRST_LIKENESS + where] == 0.0:
        return False
    a, b, u, v = arms[where, 0], arms[where, 1], near[first, ALONG], near[first, ACROSS]
    arm, seen = math.sqrt(a * a + b * b), math.sqrt(u * u + v * v)
    if abs(arm - seen) > GATHER * tolerance:
        return False
    c, s = (a * u + b * v) / (arm * seen), (a * v - b * u) / (arm * seen)
    for slot in range(len(arms)):
        x, y = c * arms[slot, 0] - s * arms[slot, 1], s * arms[slot, 0] + c * arms[slot, 1]
        filled[slot] = -1
        best = (GATHER * tolerance) ** 2
        for blob in range(count):
            dx, dy = near[blob, ALONG] - x, near[blob, ACROSS] - y
            away = dx * dx + dy * dy
            if away <= best and near[blob, FIRST_LIKENESS + slot] > 0.0 and not _holds(filled, slot, blob):
                best = away
                filled[slot] = blob
    return True


@kernel
def _holds(filled: Indices, slots: int, blob: int) -> bool:
    held = False
    for slot in range(slots):
        held |= filled[slot] == blob
    return held


@kernel
def write_blobs(near: Floats, filled: Indices, anchor: int, team: int, row: Floats) -> None:
    """Note in a hypothesis which blobs it is made of."""
    row[TEAM], row[ANCHOR], row[MATCHED] = team, anchor, 0
    for slot in range(MAX_SLOTS):
        row[FIRST_SLOT + slot] = near[filled[slot], BLOB] if filled[slot] >= 0 else -1
        row[MATCHED] += filled[slot] >= 0


@kernel
def is_known(rows: Floats, start: int, count: int) -> bool:
    """Whether the blobs of the last hypothesis have been gathered for the same slots before."""
    for other in range(start, count):
        same = True
        for column in range(FIRST_SLOT, FIRST_SLOT + MAX_SLOTS):
            same &= rows[other, column] == rows[count, column]
        if same:
            return True
    return False


@kernel
def judge(
    near: Floats, arms: Floats, shares: Floats, tolerance: float, like: float, filled: Indices, row: Floats
) -> None:  # fmt: skip
    """Fit the pose to all patches, leave out what is too far off, and write the score: 0 if nothing is left."""
    row[SCORE], row[STEADY] = 0.0, 0.0
    while True:
        worst = _fit(near, arms, tolerance, filled, row)
        if worst < 0:
            break
        filled[worst] = -1
    number, share, total = 1.0, shares[0], like
    for slot in range(len(arms)):
        if filled[slot] >= 0:
            number += 1.0
            share += shares[1 + slot]
            total += near[filled[slot], FIRST_LIKENESS + slot]
    if number > 1.0:
        row[SCORE] = share * max(1.0 - row[MISFIT] / number, 0.0) * total / number


@kernel
def _fit(near: Floats, arms: Floats, tolerance: float, filled: Indices, row: Floats) -> int:
    """Least-squares pose over the anchor and the gathered patches (Procrustes in the plane: Umeyama, 1991).

    Returns the slot whose patch is the farthest beyond the tolerance, -1 if none is; then it has written heading, the
    fitted anchor's place from the seen one's, and the sum of squared residuals in squared tolerances.
    """
    number, mean_x, mean_y, model_x, model_y = 1.0, 0.0, 0.0, 0.0, 0.0
    along = across = 0.0
    for slot in range(len(arms)):
        if filled[slot] >= 0:
            a, b, u, v = arms[slot, 0], arms[slot, 1], near[filled[slot], ALONG], near[filled[slot], ACROSS]
            number += 1.0
            mean_x, mean_y, model_x, model_y = mean_x + u, mean_y + v, model_x + a, model_y + b
            along += a * u + b * v
            across += a * v - b * u
    along -= (model_x * mean_x + model_y * mean_y) / number
    across -= (model_x * mean_y - model_y * mean_x) / number
    length = max(math.sqrt(along * along + across * across), 1e-18)
    c, s = along / length, across / length
    x, y = (mean_x - c * model_x + s * model_y) / number, (mean_y - s * model_x - c * model_y) / number
    worst, most, total = -1, tolerance * tolerance, x * x + y * y
    for slot in range(len(arms)):
        if filled[slot] >= 0:
            dx = x + c * arms[slot, 0] - s * arms[slot, 1] - near[filled[slot], ALONG]
            dy = y + s * arms[slot, 0] + c * arms[slot, 1] - near[filled[slot], ACROSS]
            off = dx * dx + dy * dy
            total += off
            if off > most:
                worst, most = slot, off
    if worst < 0:
        row[HEADING], row[X], row[Y], row[MISFIT] = math.atan2(s, c), x, y, total / (tolerance * tolerance)
    return worst


@kernel
def keep(rows: Floats, start: int, count: int) -> int:
    """Keep the row that was just filled, if need be in place of the worst of its anchor's; how many there are then."""
    if count - start < KEPT:
        return count + 1
    worst = start
    for other in range(start, count):
        if rows[other, SCORE] < rows[worst, SCORE]:
            worst = other
    if rows[count, SCORE] > rows[worst, SCORE]:
        for column in range(ROW_LENGTH):
            rows[worst, column] = rows[count, column]
    return count
