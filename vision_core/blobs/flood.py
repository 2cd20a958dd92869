"""Flood fill by runs: from one pixel to its whole blob, in memory that is allocated once."""

from typing import Any, TypeAlias

import numpy as np

from vision_core.blobs.bits import Bits, is_masked, is_set
from vision_core.geometry import Bytes
from vision_core.native.kernels import kernel
from vision_core.types.color_cells import class_at
from vision_core.types.tables import Table

Row: TypeAlias = Any
"""One row of a table."""

FLOODED_RUN = np.dtype(
    [
        ("row", np.int32), ("start", np.int32), ("end", np.int32),
        ("from_row", np.int32), ("from_start", np.int32), ("from_end", np.int32),
    ]
)  # fmt: skip
"""A run whose neighbors are still to be searched, and the run of an adjacent row from which it was reached; ends are
exclusive."""

OVER_LIMIT = -1
"""The flood was larger than allowed, or there was no memory for it."""


@kernel
def _visit(visited: Bits, y: int, start: int, end: int) -> None:
    """Set the bits of a run, end exclusive."""
    ones = ~np.uint64(0)
    first, last = start >> 6, (end - 1) >> 6
    front, back = ones << np.uint64(start & 63), ones >> np.uint64(63 - ((end - 1) & 63))
    if first == last:
        visited[y, first] |= front & back
        return
    visited[y, first] |= front
    visited[y, first + 1 : last] = ones
    visited[y, last] |= back


@kernel
def flood(
    flat: Bytes, width: int, height: int, classes: Bytes, x: int, y: int,
    visited: Bits, masked: Bits | None, stack: Table, budget: int, blob: Row,
) -> int:  # fmt: skip
    """Fill in the blob of a pixel that has a class; its area, or OVER_LIMIT beyond the budget or the stack.

    flat: pixels, shape (height * width * 3,); visited: a bit per pixel, which masked pixels have from the beginning;
    masked: their bits, or None; stack: FLOODED_RUN table; budget [px]; blob: a row of a BLOB table.
    """
    # the run of the given pixel is the first on the stack
    color = class_at(flat, y * width + x, classes)
    start, end = _whole_run(flat, y * width, width, classes, color, x, masked, y)
    _visit(visited, y, start, end)
    _push(stack, 0, y, start, end, y, 0, 0)
    top = 1
    area = sum_x = sum_y = 0
    left, right, upper, lower = start, end, y, y
    while top > 0:
        # take a run and add it to the blob's sums and box
        top -= 1
        row, start, end = int(stack[top].row), int(stack[top].start), int(stack[top].end)
        length = end - start
        area += length
        sum_x += (start + end - 1) * length
        sum_y += row * length
        left, right = min(left, start), max(right, end)
        upper, lower = min(upper, row), max(lower, row)
        if area > budget or top + length + 3 > len(stack):
            return OVER_LIMIT
        # search the rows above and below for runs that touch it, diagonally too
        known_row = int(stack[top].from_row)
        known_start, known_end = int(stack[top].from_start), int(stack[top].from_end)
        for beside in range(row - 1, row + 2, 2):
            if beside < 0 or beside >= height:
                continue
            here, stop = max(start - 1, 0), min(end + 1, width)
            while here < stop:
                # skip the run from which this one was reached
                if beside == known_row and known_start - 1 <= here <= known_end:
                    here = known_end + 1
                    continue
                if class_at(flat, beside * width + here, classes) != color or is_set(visited, beside, here):
                    here += 1
                    continue
                # a new run: mark it now, search its neighbors later
                first, after = _whole_run(flat, beside * width, width, classes, color, here, masked, beside)
                _visit(visited, beside, first, after)
                _push(stack, top, beside, first, after, row, start, end)
                top += 1
                here = after + 1
    blob.color, blob.area_px = color, area
    blob.x_px, blob.y_px = sum_x / (2 * area), sum_y / area
    blob.left, blob.top, blob.right, blob.bottom = left, upper, right - 1, lower
    return area


@kernel
def _whole_run(
    flat: Bytes, base: int, width: int, classes: Bytes, color: int, x: int, masked: Bits | None, y: int
) -> tuple[int, int]:  # fmt: skip
    """Start and end, exclusive, of the run of one class round pixel x of row y, which starts at pixel ``base``.

    Masked pixels end it.
    """
    start, end = x, x + 1
    while start > 0 and class_at(flat, base + start - 1, classes) == color:
        if is_masked(masked, y, start - 1):
            break
        start -= 1
    while end < width and class_at(flat, base + end, classes) == color:
        if is_masked(masked, y, end):
            break
        end += 1
    return start, end


@kernel
def _push(
    stack: Table, top: int, row: int, start: int, end: int, from_row: int, from_start: int, from_end: int
) -> None:
    run = stack[top]
    run.row, run.start, run.end = row, start, end
    run.from_row, run.from_start, run.from_end = from_row, from_start, from_end
