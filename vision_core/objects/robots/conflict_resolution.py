"""Conflict resolution: which hypotheses are robots. Compiled kernels.

Best first; a blob belongs to one robot at most, and robots do not overlap.
"""

import math
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from vision_core.geometry import Mask
from vision_core.native.angles import wrap_angle
from vision_core.native.kernels import kernel
from vision_core.objects.robots.buffers import MAX_SLOTS, FinderBuffers
from vision_core.types.tables import MAX_ROBOTS, Table

Row: TypeAlias = Any
"""One row of a table."""

RIVAL_SCORE = 0.8
RIVAL_TURN_RAD = math.radians(10.0)
"""A hypothesis with the same anchor makes the selected one's heading ambiguous when it has as many patches, at least
this share of its score, and a heading at least so different."""
MIN_MORE_PX = 4.0
"""Pixels that a marker must explain beyond what another one of the same team explains, if both explain it well."""


@kernel
def select_non_overlapping(count: int, buffers: FinderBuffers) -> int:
    """Select the best of ``count`` hypotheses and mark those whose heading is ambiguous; how many are selected."""
    hypotheses, order, used = buffers.hypotheses, buffers.order, buffers.used
    # best first; no blob is used yet
    for number in range(count):
        order[number] = number
        _mark_blobs(hypotheses[number], used, False)
    _sort(hypotheses, order, count)
    selected = int(np.int64(0))  # a plain 0 has a type of its own, and every function it is passed to compiles twice
    for place in range(count):
        number = order[place]
        hypothesis = hypotheses[number]
        same_anchor = _selected_with_anchor(hypothesis, hypotheses, buffers.selected, selected)
        if same_anchor >= 0:
            # the anchor is a robot already: this one is at most a rival for its heading
            winner = hypotheses[buffers.selected[same_anchor]]
            if hypothesis.marker == winner.marker:
                buffers.ambiguous[same_anchor] |= _is_rival(hypothesis, winner)
            elif _is_alike(hypothesis, winner):
                buffers.alike[same_anchor] = True
                buffers.ambiguous[same_anchor] |= _is_turned(hypothesis, winner)
        elif (
            selected < MAX_ROBOTS
            and _has_free_blobs(hypothesis, used)
            and _has_free_space(hypothesis, hypotheses, buffers.selected, selected)
        ):
            buffers.selected[selected], buffers.ambiguous[selected], buffers.alike[selected] = number, False, False
            selected += 1
            _mark_blobs(hypothesis, used, True)
    return selected


@kernel
def _mark_blobs(hypothesis: Row, used: Mask, value: bool) -> None:
    """Mark the blobs of a hypothesis as used or unused."""
    used[hypothesis.anchor] = value
    for slot in range(MAX_SLOTS):
        if hypothesis.slot_blobs[slot] >= 0:
            used[hypothesis.slot_blobs[slot]] = value


@kernel
def _sort(hypotheses: Table, order: NDArray[np.int32], count: int) -> None:
    """Shellsort in place, fast enough for some hundred rows: best first, equal ones in their order."""
    gap = 1
    while gap < count // 3:
        gap = 3 * gap + 1
    while gap > 0:
        for i in range(gap, count):
            here, j = order[i], i
            while j >= gap and _comes_before(hypotheses, here, order[j - gap]):
                order[j] = order[j - gap]
                j -= gap
            order[j] = here
        gap //= 3


@kernel
def _comes_before(hypotheses: Table, one: int, other: int) -> bool:
    first, second = hypotheses[one].score, hypotheses[other].score
    before: bool = first > second or (first == second and one < other)
    return before


@kernel
def _selected_with_anchor(hypothesis: Row, hypotheses: Table, selected: NDArray[np.int32], count: int) -> int:
    """Number of the selected hypothesis with the same anchor, -1 for none."""
    for number in range(count):
        other = hypotheses[selected[number]]
        if other.anchor == hypothesis.anchor and other.team == hypothesis.team:
            return number
    return -1


@kernel
def _is_rival(hypothesis: Row, selected: Row) -> bool:
    """Whether a hypothesis explains the same anchor about as well with another heading."""
    if hypothesis.matched == 0 or hypothesis.matched < selected.matched:
        return False
    return hypothesis.score >= RIVAL_SCORE * selected.score and _is_turned(hypothesis, selected)


@kernel
def _is_alike(hypothesis: Row, selected: Row) -> bool:
    """Whether another marker explains about as many pixels round the same anchor."""
    few = hypothesis.explained_px > selected.explained_px - MIN_MORE_PX
    alike: bool = few and hypothesis.score >= RIVAL_SCORE * selected.score
    return alike


@kernel
def _is_turned(hypothesis: Row, selected: Row) -> bool:
    turned: bool = abs(wrap_angle(hypothesis.heading_rad - selected.heading_rad)) > RIVAL_TURN_RAD
    return turned


@kernel
def _has_free_blobs(hypothesis: Row, used: Mask) -> bool:
    """Whether no selected hypothesis has one of its blobs."""
    taken: bool = used[hypothesis.anchor]
    for slot in range(MAX_SLOTS):
        taken |= hypothesis.slot_blobs[slot] >= 0 and used[hypothesis.slot_blobs[slot]]
    return not taken


@kernel
def _has_free_space(hypothesis: Row, hypotheses: Table, selected: NDArray[np.int32], count: int) -> bool:
    """Whether it overlaps no selected robot."""
    for number in range(count):
        other = hypotheses[selected[number]]
        spacing = hypothesis.exclusion_radius_m + other.exclusion_radius_m
        dx, dy = hypothesis.x_m - other.x_m, hypothesis.y_m - other.y_m
        if dx**2 + dy**2 < spacing * spacing:
            return False
    return True
