"""Hypotheses compete: best first, a blob serves once, and robots do not stand in one another. Compiled kernels."""

import math

import numpy as np
from numpy.typing import NDArray

from vision_core.geometry import Floats
from vision_core.native.kernels import kernel
from vision_core.objects.robots.buffers import (
    ANCHOR,
    FIRST_SLOT,
    HEADING,
    MATCHED,
    ROOM,
    ROW_LENGTH,
    SCORE,
    TEAM,
    Memory,
    X,
    Y,
)
from vision_core.types.tables import MAX_ROBOTS

RIVAL_SCORE = 0.8
RIVAL_TURN_RAD = math.radians(10.0)
"""A hypothesis for the same anchor with as many patches, this share of the score and this much turned makes the
heading ambiguous."""


@kernel
def compete(count: int, memory: Memory) -> int:
    """List the rows that win, and whether the heading of each is ambiguous; how many there are."""
    rows, order, used = memory.rows, memory.order, memory.used
    for number in range(count):
        order[number] = number
        used[int(rows[number, ANCHOR])] = False
        for column in range(FIRST_SLOT, ROW_LENGTH):
            if rows[number, column] >= 0:
                used[int(rows[number, column])] = False
    _sort(rows, order, count)
    won = int(np.int64(0))  # a plain 0 is a type of its own, for which all that it is passed to is compiled twice
    for place in range(count):
        number = order[place]
        row = rows[number]
        winner = _winner_of(row, rows, memory.winners, won)
        if winner >= 0:
            if _is_rival(row, rows[memory.winners[winner]]):
                memory.ambiguous[winner] = True
        elif won < MAX_ROBOTS and _is_free(row, used) and _has_room(row, rows, memory.winners, won):
            memory.winners[won], memory.ambiguous[won] = number, False
            won += 1
            used[int(row[ANCHOR])] = True
            for column in range(FIRST_SLOT, ROW_LENGTH):
                if row[column] >= 0:
                    used[int(row[column])] = True
    return won


@kernel
def _sort(rows: Floats, order: NDArray[np.int32], count: int) -> None:
    """Shell's sort: in place, and as good as any for some hundred rows; best first, ties as they came."""
    gap = 1
    while gap < count // 3:
        gap = 3 * gap + 1
    while gap > 0:
        for i in range(gap, count):
            here, j = order[i], i
            while j >= gap and _comes_before(rows, here, order[j - gap]):
                order[j] = order[j - gap]
                j -= gap
            order[j] = here
        gap //= 3


@kernel
def _comes_before(rows: Floats, one: int, other: int) -> bool:
    before: bool = rows[one, SCORE] > rows[other, SCORE] or (rows[one, SCORE] == rows[other, SCORE] and one < other)
    return before


@kernel
def _winner_of(row: Floats, rows: Floats, winners: NDArray[np.int32], won: int) -> int:
    """The winner that has the same anchor, -1 for none."""
    for winner in range(won):
        if rows[winners[winner], ANCHOR] == row[ANCHOR] and rows[winners[winner], TEAM] == row[TEAM]:
            return winner
    return -1


@kernel
def _is_rival(row: Floats, winner: Floats) -> bool:
    if row[MATCHED] == 0 or row[MATCHED] < winner[MATCHED] or row[SCORE] < RIVAL_SCORE * winner[SCORE]:
        return False
    turn = (row[HEADING] - winner[HEADING] + math.pi) % (2.0 * math.pi) - math.pi
    turned: bool = abs(turn) > RIVAL_TURN_RAD
    return turned


@kernel
def _is_free(row: Floats, used: NDArray[np.bool_]) -> bool:
    """Whether no winner wears one of its blobs."""
    taken: bool = used[int(row[ANCHOR])]
    for column in range(FIRST_SLOT, ROW_LENGTH):
        taken |= row[column] >= 0 and used[int(row[column])]
    return not taken


@kernel
def _has_room(row: Floats, rows: Floats, winners: NDArray[np.int32], won: int) -> bool:
    """Whether it stands in no winner."""
    for winner in range(won):
        other = rows[winners[winner]]
        spacing = row[ROOM] + other[ROOM]
        if (row[X] - other[X]) ** 2 + (row[Y] - other[Y]) ** 2 < spacing * spacing:
            return False
    return True
