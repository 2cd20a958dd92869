"""One hypothesis: the blobs that it consists of, and the pose fitted to them. Compiled kernels."""

import math
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from vision_core.geometry import Floats
from vision_core.native.kernels import kernel
from vision_core.objects.robots.buffers import MAX_SLOTS, NO_BLOB
from vision_core.types.tables import Table

Indices = NDArray[np.int32]
Row: TypeAlias = Any
"""One row of a table."""

GATHER_TOLERANCES = 1.5
"""Before the fit a patch may be this many tolerances off, since one patch alone fixed the heading."""

MAX_PER_ANCHOR = 8
"""Hypotheses kept per anchor: more do not change the result."""


@kernel
def assign_blobs(
    neighbors: Table, count: int, offsets: Floats, tolerance: float, first: int, first_slot: int, assigned: Indices
) -> bool:  # fmt: skip
    """Assign a neighboring blob to a slot, and to every other slot the nearest neighbor within the gate.

    neighbors: NEIGHBOR table of which count rows hold; offsets: of the slots [m]; False if the first neighbor cannot
    fill its slot. assigned: filled, shape (8,).
    """
    if neighbors[first].area_scores[first_slot] == 0.0:
        return False
    # the first pair must be as far from the anchor as in the pattern; its direction fixes the heading
    a, b, u, v = offsets[first_slot, 0], offsets[first_slot, 1], neighbors[first].x_m, neighbors[first].y_m
    expected, seen = math.sqrt(a * a + b * b), math.sqrt(u * u + v * v)
    if abs(expected - seen) > GATHER_TOLERANCES * tolerance:
        return False
    c, s = (a * u + b * v) / (expected * seen), (a * v - b * u) / (expected * seen)
    # each slot takes the nearest suitable neighbor that no earlier slot has
    for slot in range(len(offsets)):
        x, y = c * offsets[slot, 0] - s * offsets[slot, 1], s * offsets[slot, 0] + c * offsets[slot, 1]
        assigned[slot] = NO_BLOB
        nearest = (GATHER_TOLERANCES * tolerance) ** 2
        for number in range(count):
            neighbor = neighbors[number]
            dx, dy = neighbor.x_m - x, neighbor.y_m - y
            distance2 = dx * dx + dy * dy
            if distance2 <= nearest and neighbor.area_scores[slot] > 0.0 and not _is_assigned(assigned, slot, number):
                nearest = distance2
                assigned[slot] = number
    return True


@kernel
def _is_assigned(assigned: Indices, slots: int, number: int) -> bool:
    found = False
    for slot in range(slots):
        found |= assigned[slot] == number
    return found


@kernel
def record_blobs(neighbors: Table, assigned: Indices, anchor: int, team: int, marker: int, hypothesis: Row) -> None:
    """Write into a hypothesis which blobs it consists of."""
    hypothesis.team, hypothesis.marker, hypothesis.anchor = team, marker, anchor
    matched = 0
    for slot in range(MAX_SLOTS):
        hypothesis.slot_blobs[slot] = neighbors[assigned[slot]].blob if assigned[slot] >= 0 else NO_BLOB
        matched += assigned[slot] >= 0
    hypothesis.matched = matched


@kernel
def is_duplicate(hypotheses: Table, start: int, count: int) -> bool:
    """Whether one of the hypotheses start..count has the same blobs in the same slots as the one after them."""
    for other in range(start, count):
        same = True
        for slot in range(MAX_SLOTS):
            same &= hypotheses[other].slot_blobs[slot] == hypotheses[count].slot_blobs[slot]
        if same:
            return True
    return False


@kernel
def fit_and_score(
    neighbors: Table, offsets: Floats, area_fractions: Floats, tolerance: float, anchor_score: float,
    assigned: Indices, hypothesis: Row,
) -> None:  # fmt: skip
    """Fit the pose to all patches, drop those that do not fit, and write pose and score; score 0 if none is left."""
    hypothesis.score, hypothesis.heading_stiffness_m = 0.0, 0.0
    # fit again without the worst patch until all are within the tolerance
    while True:
        worst = _fit(neighbors, offsets, tolerance, assigned, hypothesis)
        if worst < 0:
            break
        assigned[worst] = NO_BLOB
    # coverage of the marker * fit * mean score of the areas
    patches, coverage, total = 1.0, area_fractions[0], anchor_score
    for slot in range(len(offsets)):
        if assigned[slot] >= 0:
            patches += 1.0
            coverage += area_fractions[1 + slot]
            total += neighbors[assigned[slot]].area_scores[slot]
    if patches > 1.0:
        hypothesis.score = coverage * max(1.0 - hypothesis.misfit / patches, 0.0) * total / patches


@kernel
def _fit(neighbors: Table, offsets: Floats, tolerance: float, assigned: Indices, hypothesis: Row) -> int:
    """Least-squares pose over the anchor and the assigned patches (Procrustes in the plane: Umeyama, 1991).

    Returns the slot whose patch is farthest beyond the tolerance. If there is none returns -1 and writes the heading,
    the fitted anchor's place relative to the seen one, and the sum of the squared residuals over squared tolerance.
    """
    # means and cross-covariance of the model's places (a, b) and the seen ones (u, v); the anchor is at the origin
    patches, mean_x, mean_y, model_x, model_y = 1.0, 0.0, 0.0, 0.0, 0.0
    along = across = 0.0
    for slot in range(len(offsets)):
        if assigned[slot] >= 0:
            neighbor = neighbors[assigned[slot]]
            a, b, u, v = offsets[slot, 0], offsets[slot, 1], neighbor.x_m, neighbor.y_m
            patches += 1.0
            mean_x, mean_y, model_x, model_y = mean_x + u, mean_y + v, model_x + a, model_y + b
            along += a * u + b * v
            across += a * v - b * u
    along -= (model_x * mean_x + model_y * mean_y) / patches
    across -= (model_x * mean_y - model_y * mean_x) / patches
    # the turn that maximizes the covariance, and the shift that brings the means together
    length = max(math.sqrt(along * along + across * across), 1e-18)
    c, s = along / length, across / length
    x, y = (mean_x - c * model_x + s * model_y) / patches, (mean_y - s * model_x - c * model_y) / patches
    # residuals
    worst, limit, total = -1, tolerance * tolerance, x * x + y * y
    for slot in range(len(offsets)):
        if assigned[slot] >= 0:
            dx = x + c * offsets[slot, 0] - s * offsets[slot, 1] - neighbors[assigned[slot]].x_m
            dy = y + s * offsets[slot, 0] + c * offsets[slot, 1] - neighbors[assigned[slot]].y_m
            off = dx * dx + dy * dy
            total += off
            if off > limit:
                worst, limit = slot, off
    if worst < 0:
        hypothesis.heading_rad, hypothesis.x_m, hypothesis.y_m = math.atan2(s, c), x, y
        hypothesis.misfit = total / (tolerance * tolerance)
    return worst


@kernel
def keep_best(hypotheses: Table, start: int, count: int) -> int:
    """Keep the hypothesis in row ``count``, in place of its anchor's worst if there are too many; the new count.

    start: the first hypothesis of the same anchor.
    """
    if count - start < MAX_PER_ANCHOR:
        return count + 1
    worst = start
    for other in range(start, count):
        if hypotheses[other].score < hypotheses[worst].score:
            worst = other
    if hypotheses[count].score > hypotheses[worst].score:
        hypotheses[worst] = hypotheses[count]
    return count
