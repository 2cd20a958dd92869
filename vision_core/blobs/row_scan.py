"""Row scan: sample every n-th row and flood fill the blobs that it hits; most of the picture remains unread.

Theory in the package's docstring. ``segment_picture`` is the kernel, ``segment_buffers`` makes the memory it works in.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from vision_core.blobs.bits import Bits, is_masked, is_set, masked_word
from vision_core.blobs.flood import FLOODED_RUN, OVER_LIMIT, flood
from vision_core.blobs.run_lengths import RunBuffers, run_buffers, segment_runs
from vision_core.blobs.simd import LANES, any_class, prefilter_mask, write_cells
from vision_core.geometry import Bytes
from vision_core.native.kernels import kernel
from vision_core.native.pixel_reads import prefetch
from vision_core.settings.schema import BlobSettings
from vision_core.types.color_cells import color_cell
from vision_core.types.prefilter import ColorPrefilter
from vision_core.types.tables import Table

Boxes = NDArray[np.int32]
Cells = NDArray[np.uint16]
Seeds = NDArray[np.int32]

LEFT, TOP, RIGHT, BOTTOM = range(4)
"""Columns of a table of windows, inclusive, as the boxes of blobs."""
SEED_X, SEED_Y = range(2)
"""Columns of the table of seeds [px]."""
PREFETCH_SEEDS = 4
"""While one seed is flooded, the surroundings of the seed so many places later are prefetched."""
STACK_ROWS = 8
"""Room of the stack of runs, in rows of pixels."""


class SegmentBuffers(NamedTuple):
    """What segmentation needs for pictures of one size, allocated once. Kernels take it as one argument."""

    visited: Bits
    """Flooded in this picture, or masked; between pictures those that are masked. Shape as of ``masked``."""
    boxes: Boxes
    """Of all that was flooded in a picture, however small; columns as of windows. Shape (seeds, 4)."""
    seeds: Seeds
    """Pixels where a run with a class starts, shape (seeds, 2)."""
    stack: Table
    """FLOODED_RUN."""
    cells: Cells
    """Of one row: cells of the color table, 64 by 64."""
    starts: NDArray[np.int64]
    """Column where each 64 of them start."""
    cursor: NDArray[np.int64]
    """Where the rolling scan band starts in the next picture, in sampled rows; shape (1,)."""
    runs: RunBuffers
    """For the reference segmentation, which takes over when too much would be flooded."""
    rows_apart: int
    """Distance of the sampled rows."""
    scan_band_rows: int
    """How many of the sampled rows are in the rolling scan band of one picture."""
    flood_px: int
    """Limit of what is flooded in one picture; beyond it the reference segmentation takes over."""
    min_area_px: int


def min_height_px(smallest_px: float, row_step: float) -> int:
    """Height of the lowest blob that must be found [px], at least 1. Sampled rows may lie this far apart.

    smallest_px: diameter of the smallest dot or patch in the picture; row_step: share of that diameter, under 1,
    because a neighbor may cut a dot, and noise may take its edge.
    """
    return max(1, int(row_step * smallest_px))


def segment_buffers(
    width_px: int, height_px: int, settings: BlobSettings, rows_apart: int, masked: Bits | None = None
) -> SegmentBuffers:  # fmt: skip
    """Buffers for pictures of one size. rows_apart: see ``min_height_px``; masked: what is background, or None."""
    rows = height_px // rows_apart
    return SegmentBuffers(
        visited=np.zeros((height_px, -(-width_px // LANES)), dtype=np.uint64) if masked is None else masked.copy(),
        boxes=np.zeros((settings.max_runs, 4), dtype=np.int32),
        seeds=np.zeros((settings.max_runs, 2), dtype=np.int32),
        stack=np.zeros(STACK_ROWS * width_px, dtype=FLOODED_RUN),
        cells=np.zeros((width_px // LANES + 1) * LANES, dtype=np.uint16),
        starts=np.zeros(width_px // LANES + 1, dtype=np.int64),
        cursor=np.zeros(1, dtype=np.int64),
        runs=run_buffers(settings, masked),
        rows_apart=rows_apart,
        scan_band_rows=max(1, math.ceil(rows * settings.scan_band)),
        flood_px=int(settings.max_flood_fraction * width_px * height_px),
        min_area_px=settings.min_area_px,
    )


@kernel
def segment_picture(
    pixels: Bytes, classes: Bytes, prefilter: ColorPrefilter, windows: Boxes, window_count: int, whole: bool,
    buffers: SegmentBuffers, blobs: Table,
) -> tuple[int, bool]:  # fmt: skip
    """Fill a BLOB table: how many blobs there are, and whether there was room for all.

    pixels: shape (height, width, 3); classes: of the ColorTable, shape (65536,); prefilter: of the same table; windows:
    left, top, right, bottom, shape (n, 4), of which window_count rows hold; whole: search the whole picture and
    ignore the windows.
    """
    height, width, _ = pixels.shape
    flat = pixels.reshape(-1)
    apart = buffers.rows_apart
    rows = height // apart
    seeds = 0
    if whole:
        seeds = find_seeds(flat, width, classes, prefilter, 0, width, 0, rows, buffers, seeds)
    else:
        # the windows, clipped to the picture
        for window in windows[:window_count]:
            left, right = max(window[LEFT], 0), min(window[RIGHT] + 1, width)
            first, after = max(window[TOP], 0) // apart, min(window[BOTTOM] + 1, height) // apart
            seeds = find_seeds(flat, width, classes, prefilter, left, right, first, after, buffers, seeds)
        # the scan band, which moves on from picture to picture
        first = buffers.cursor[0] if buffers.cursor[0] < rows else 0
        after = min(first + buffers.scan_band_rows, rows)
        buffers.cursor[0] = after
        seeds = find_seeds(flat, width, classes, prefilter, 0, width, first, after, buffers, seeds)
    found, all_blobs = flood_seeds(flat, width, height, classes, seeds, buffers, blobs)
    if found == OVER_LIMIT:
        return segment_runs(pixels, classes, buffers.min_area_px, buffers.runs, blobs)
    return found, all_blobs


@kernel
def find_seeds(
    flat: Bytes, width: int, classes: Bytes, prefilter: ColorPrefilter,
    left: int, right: int, first: int, after: int, buffers: SegmentBuffers, count: int,
) -> int:  # fmt: skip
    """Append where runs with a class start in columns left..right and sampled rows first..after, exclusive.

    Returns the new number of seeds, or OVER_LIMIT without room for more.
    """
    margin, level = prefilter.margin_limit, prefilter.level_limit
    limits = (
        margin[0], margin[1], margin[2], margin[3], margin[4], margin[5], margin[6], margin[7],
        level[0], level[1], level[2], level[3], level[4], level[5], level[6], level[7],
    )  # fmt: skip
    # taken out of the tuple once: in the loop every access to an array of it may count references
    apart, cells, starts, table = buffers.rows_apart, buffers.cells, buffers.starts, buffers.seeds
    masked = buffers.runs.masked
    for number in range(first, after):
        y = (number + 1) * apart - 1
        chunks = 0
        x = left
        # pass 1: 64 pixels at a time through the prefilter; the few chunks that pass get their color cells computed
        while x < right:
            start = max(min(x, width - LANES), 0)
            if number + 1 < after:
                below = (y + apart) * width + start
                prefetch(flat, below)  # 64 pixels are three cache lines
                prefetch(flat, below + 21)
                prefetch(flat, below + 42)
            if width < LANES:
                _write_short_row(flat, y * width, width, cells)
                chunks = 1
            elif prefilter_mask(flat, y * width + start, limits) != np.uint64(0):
                write_cells(flat, y * width + start, cells, chunks * LANES)
                starts[chunks] = start
                chunks += 1
            x = start + LANES
        # pass 2: the color table decides
        for chunk in range(chunks):
            if any_class(cells, chunk * LANES, classes) != 0:
                count = _add_seeds(classes, cells, chunk * LANES, starts[chunk], y, left, right, masked, table, count)
    return count


@kernel
def _add_seeds(
    classes: Bytes, cells: Cells, place: int, start: int, y: int, left: int, right: int, masked: Bits | None,
    seeds: Seeds, count: int,
) -> int:  # fmt: skip
    """Append the seeds of 64 pixels that lie in columns left..right, exclusive; the new count, or OVER_LIMIT.

    place: of their first cell; start: column of their first pixel.
    """
    before = 0
    for lane in range(max(left - start, 0), min(right - start, LANES)):
        color = classes[cells[place + lane]]
        if color != 0 and is_masked(masked, y, start + lane):
            color = np.uint8(0)
        if color not in (0, before):
            if count == OVER_LIMIT or count == len(seeds):
                return OVER_LIMIT
            seeds[count, SEED_X], seeds[count, SEED_Y] = start + lane, y
            count += 1
        before = color
    return count


@kernel
def _write_short_row(flat: Bytes, first: int, width: int, cells: Cells) -> None:
    """The color cells of a row with fewer than 64 pixels; the rest repeats the first pixel."""
    for lane in range(LANES):
        pixel = 3 * (first + (lane if lane < width else 0))
        cells[lane] = color_cell(flat[pixel], flat[pixel + 1], flat[pixel + 2])


@kernel
def flood_seeds(
    flat: Bytes, width: int, height: int, classes: Bytes, seeds: int, buffers: SegmentBuffers, blobs: Table
) -> tuple[int, bool]:
    """Fill a BLOB table from the seeds: how many blobs, and whether there was room for all; or (OVER_LIMIT, False)."""
    found, flooded, all_blobs, budget = 0, 0, True, buffers.flood_px
    # taken out of the tuple once: in the loop every access to an array of it may count references
    visited, table, boxes, stack = buffers.visited, buffers.seeds, buffers.boxes, buffers.stack
    apart, min_area, masked = buffers.rows_apart, buffers.min_area_px, buffers.runs.masked
    for seed in range(seeds):
        if seed + PREFETCH_SEEDS < seeds:
            later_x, later_y = int(table[seed + PREFETCH_SEEDS, SEED_X]), int(table[seed + PREFETCH_SEEDS, SEED_Y])
            _prefetch_seed(flat, width, height, later_x, later_y, apart, visited)
        # several seeds lie in one blob: only the first one floods it
        x, y = int(table[seed, SEED_X]), int(table[seed, SEED_Y])
        if is_set(visited, y, x):
            continue
        if found == len(blobs):
            all_blobs = False
            break
        area = flood(flat, width, height, classes, x, y, visited, masked, stack, budget, blobs[found])
        if area == OVER_LIMIT:
            clear_all(visited, masked)
            return OVER_LIMIT, False
        # note the box, to clear its bits afterwards; blobs that are too small are overwritten by the next
        box, blob = boxes[flooded], blobs[found]
        box[LEFT], box[TOP], box[RIGHT], box[BOTTOM] = blob.left, blob.top, blob.right, blob.bottom
        flooded += 1
        budget -= area
        if area >= min_area:
            found += 1
    clear_visited(visited, masked, boxes, flooded)
    return (found, all_blobs) if seeds != OVER_LIMIT else (OVER_LIMIT, False)


@kernel
def clear_all(visited: Bits, masked: Bits | None) -> None:
    """Clear all bits but those of masked pixels."""
    visited[:] = np.uint64(0)
    if masked is not None:
        visited[:] = masked


@kernel
def clear_visited(visited: Bits, masked: Bits | None, boxes: Boxes, flooded: int) -> None:
    """Clear the bits of what was flooded: a few thousand bytes, where the picture has hundreds of thousands."""
    for box in boxes[:flooded]:
        for y in range(box[TOP], box[BOTTOM] + 1):
            for word in range(box[LEFT] >> 6, (box[RIGHT] >> 6) + 1):
                visited[y, word] = masked_word(masked, y, word)


@kernel
def _prefetch_seed(flat: Bytes, width: int, height: int, x: int, y: int, apart: int, visited: Bits) -> None:
    """Prefetch the pixels round a seed, which lie in rows that have not been read yet."""
    if is_set(visited, y, x):
        return
    for row in range(max(y - apart, 0), min(y + 2 * apart, height)):
        prefetch(flat, row * width + x - apart)
        prefetch(flat, row * width + x + apart)
