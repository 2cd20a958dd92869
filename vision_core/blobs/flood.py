"""Flood fill by runs: from one pixel to the whole blob, in memory that is taken once."""

from typing import Any

import numpy as np

from vision_core.blobs.simd import class_at
from vision_core.geometry import Bytes
from vision_core.native.kernels import kernel

ROW, START, END, FROM_ROW, FROM_START, FROM_END = range(6)
"""Columns of the stack of runs: a run, END exclusive, and the run next to it that led there."""
STACK_COLUMNS = 6

BROKE_OFF = -1


@kernel
def is_visited(visited: np.ndarray, y: int, x: int) -> bool:
    """Whether a pixel was flooded. visited: uint64, shape (height, width / 64 rounded up), a bit per pixel."""
    return bool((visited[y, x >> 6] >> np.uint64(x & 63)) & np.uint64(1))


@kernel
def _visit(visited: np.ndarray, y: int, start: int, end: int) -> None:
    """Set the bits of a run, END exclusive."""
    every = ~np.uint64(0)
    first, last = start >> 6, (end - 1) >> 6
    front, back = every << np.uint64(start & 63), every >> np.uint64(63 - ((end - 1) & 63))
    if first == last:
        visited[y, first] |= front & back
        return
    visited[y, first] |= front
    visited[y, first + 1 : last] = every
    visited[y, last] |= back


@kernel
def flood(
    flat: Bytes, width: int, height: int, classes: Bytes, x: int, y: int,
    visited: np.ndarray, stack: np.ndarray, budget: int, blob: Any,
) -> int:  # fmt: skip
    """Fill the blob that a pixel with a class belongs to; its area, or BROKE_OFF over budget or without stack.

    flat: shape (height * width * 3,); stack: shape (n, 6), int32; budget [px]; blob: a row of a BLOB table.
    """
    color = class_at(flat, y * width + x, classes)
    start, end = _whole_run(flat, y * width, width, classes, color, x)
    _visit(visited, y, start, end)
    _push(stack, 0, y, start, end, y, 0, 0)
    top = 1
    area = sum_x = sum_y = 0
    left, right, upper, lower = start, end, y, y
    while top > 0:
        top -= 1
        row, start, end = int(stack[top, ROW]), int(stack[top, START]), int(stack[top, END])
        length = end - start
        area += length
        sum_x += (start + end - 1) * length
        sum_y += row * length
        left, right = min(left, start), max(right, end)
        upper, lower = min(upper, row), max(lower, row)
        if area > budget or top + length + 3 > len(stack):
            return BROKE_OFF
        known = int(stack[top, FROM_ROW])
        known_start, known_end = int(stack[top, FROM_START]), int(stack[top, FROM_END])
        for beside in range(row - 1, row + 2, 2):
            if beside < 0 or beside >= height:
                continue
            here, stop = max(start - 1, 0), min(end + 1, width)
            while here < stop:
                if beside == known and known_start - 1 <= here <= known_end:
                    here = known_end + 1
                    continue
                if class_at(flat, beside * width + here, classes) != color or is_visited(visited, beside, here):
                    here += 1
                    continue
                first, after = _whole_run(flat, beside * width, width, classes, color, here)
                _visit(visited, beside, first, after)
                _push(stack, top, beside, first, after, row, start, end)
                top += 1
                here = after + 1
    blob.color, blob.area_px = color, area
    blob.x_px, blob.y_px = sum_x / (2 * area), sum_y / area
    blob.left, blob.top, blob.right, blob.bottom = left, upper, right - 1, lower
    return area


@kernel
def _whole_run(flat: Bytes, base: int, width: int, classes: Bytes, color: int, x: int) -> tuple[int, int]:
    """Start and end, exclusive, of the run of one class that a pixel of a row lies in."""
    start, end = x, x + 1
    while start > 0 and class_at(flat, base + start - 1, classes) == color:
        start -= 1
    while end < width and class_at(flat, base + end, classes) == color:
        end += 1
    return start, end


@kernel
def _push(
    stack: np.ndarray, top: int, row: int, start: int, end: int, from_row: int, from_start: int, from_end: int
) -> None:
    stack[top, ROW], stack[top, START], stack[top, END] = row, start, end
    stack[top, FROM_ROW], stack[top, FROM_START], stack[top, FROM_END] = from_row, from_start, from_end
