"""Some rows of the picture, and flood fill from what they hit: the same blobs, most of the picture unread.

Theory in the package's docstring. ``FastSegmenter`` owns the memory; ``segment_picture`` is the kernel that another
kernel may call with it.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from vision_core.blobs.flood import BROKE_OFF, STACK_COLUMNS, flood, is_visited
from vision_core.blobs.run_lengths import RunMemory, run_memory, segment_runs
from vision_core.blobs.simd import LANES, any_class, candidate_bits, prefetch, write_cells
from vision_core.geometry import Bytes
from vision_core.native.kernels import kernel, read_only
from vision_core.settings.schema import BlobSettings
from vision_core.types.colors import ColorTable
from vision_core.types.prefilter import Candidates
from vision_core.types.tables import BLOB, Table

LEFT, TOP, RIGHT, BOTTOM = range(4)
"""Columns of a table of windows, inclusive, as the boxes of blobs."""
SEED_X, SEED_Y = range(2)
AHEAD = 4
"""Seeds whose surroundings are asked for while another one is flooded."""
STACK_ROWS = 8
"""Room on the stack of runs, in rows of pixels."""


class SegmentMemory(NamedTuple):
    """Everything that segmentation of pictures of one size needs, taken once. A compiled function can take it."""

    visited: NDArray[np.uint64]
    """A bit per pixel: flooded in this picture; none between pictures. Shape (height, width / 64 rounded up)."""
    boxes: NDArray[np.int32]
    """Of all that was flooded in a picture, however small; columns as of windows. Shape (seeds, 4)."""
    seeds: NDArray[np.int32]
    stack: NDArray[np.int32]
    cells: NDArray[np.uint16]
    """Of one row: cells of the color table, 64 by 64, and the column where each 64 start."""
    starts: NDArray[np.int64]
    cursor: NDArray[np.int64]
    """Shape (1,): where the rolling scan band starts in the next picture, in rows looked at."""
    runs: RunMemory
    """For the classic, which takes over when too much would be flooded."""
    rows_apart: int
    """Every so-many-th row is looked at."""
    scan_band_rows: int
    """How many of the rows looked at make the rolling scan band of one picture."""
    flood_px: int
    """More is not flooded in one picture: the classic takes over."""
    min_area_px: int


def least_height_px(smallest_px: float, share: float) -> int:
    """Height from which on blobs must not be missed, at least 1: so far apart may the rows be.

    smallest_px: diameter of the smallest dot or patch in the picture; share: of it, under 1, because a dot may be
    cut by its neighbor or lose its rim to noise.
    """
    return max(1, int(share * smallest_px))


def segment_memory(width_px: int, height_px: int, settings: BlobSettings, rows_apart: int) -> SegmentMemory:
    """Memory for pictures of one size. rows_apart: see ``least_height_px``."""
    rows = height_px // rows_apart
    return SegmentMemory(
        visited=np.zeros((height_px, -(-width_px // LANES)), dtype=np.uint64),
        boxes=np.zeros((settings.max_runs, 4), dtype=np.int32),
        seeds=np.zeros((settings.max_runs, 2), dtype=np.int32),
        stack=np.zeros((STACK_ROWS * width_px, STACK_COLUMNS), dtype=np.int32),
        cells=np.zeros((width_px // LANES + 1) * LANES, dtype=np.uint16),
        starts=np.zeros(width_px // LANES + 1, dtype=np.int64),
        cursor=np.zeros(1, dtype=np.int64),
        runs=run_memory(settings),
        rows_apart=rows_apart,
        scan_band_rows=max(1, math.ceil(rows * settings.scan_band)),
        flood_px=int(settings.max_flood_fraction * width_px * height_px),
        min_area_px=settings.min_area_px,
    )


class FastSegmenter:
    """Finds the blobs of pictures of one size that are at least ``least_height_px`` high, and most of the others.

    Not to be shared between threads. ``blobs`` is filled by ``segment``: the first rows of it are the result.
    """

    def __init__(self, width_px: int, height_px: int, settings: BlobSettings, least_height_px: int) -> None:
        self._shape = (height_px, width_px, 3)
        self.memory = segment_memory(width_px, height_px, settings, least_height_px)
        self.blobs: Table = np.zeros(settings.max_blobs, dtype=BLOB)
        self._no_windows = np.zeros((0, 4), dtype=np.int32)

    def segment(
        self, pixels: Bytes, table: ColorTable, candidates: Candidates, windows: NDArray[np.int32] | None = None
    ) -> tuple[int, bool]:
        """How many blobs were found, and whether all had room; their order is not that of the classic.

        pixels: shape (height, width, 3), blue green red. candidates: made from the same table. windows: shape (n, 4),
        left top right bottom, inclusive: where to look beside the rolling scan band; None looks everywhere.
        """
        assert pixels.shape == self._shape, f"{pixels.shape} is not {self._shape}"
        whole = windows is None
        boxes = self._no_windows if windows is None else np.ascontiguousarray(windows, dtype=np.int32)
        return segment_picture(
            read_only(pixels), read_only(table.classes), candidates, boxes, len(boxes), whole, self.memory, self.blobs
        )


@kernel
def segment_picture(
    pixels: Bytes, classes: Bytes, candidates: Candidates, windows: np.ndarray, window_count: int, whole: bool,
    memory: SegmentMemory, blobs: Table,
) -> tuple[int, bool]:  # fmt: skip
    """Fill a BLOB table: (how many, whether all had room). ``whole`` looks everywhere and ignores the windows."""
    height, width, _ = pixels.shape
    flat = pixels.reshape(-1)
    apart = memory.rows_apart
    rows = height // apart
    seeds = 0
    if whole:
        seeds = find_seeds(flat, width, classes, candidates, 0, width, 0, rows, memory, seeds)
    else:
        for window in windows[:window_count]:
            left, right = max(window[LEFT], 0), min(window[RIGHT] + 1, width)
            first, after = max(window[TOP], 0) // apart, min(window[BOTTOM] + 1, height) // apart
            seeds = find_seeds(flat, width, classes, candidates, left, right, first, after, memory, seeds)
        first = memory.cursor[0] if memory.cursor[0] < rows else 0
        after = min(first + memory.scan_band_rows, rows)
        memory.cursor[0] = after
        seeds = find_seeds(flat, width, classes, candidates, 0, width, first, after, memory, seeds)
    found, fits = flood_seeds(flat, width, height, classes, seeds, memory, blobs)
    if found == BROKE_OFF:
        return segment_runs(pixels, classes, memory.min_area_px, memory.runs, blobs)
    return found, fits


@kernel
def find_seeds(
    flat: Bytes, width: int, classes: Bytes, candidates: Candidates,
    left: int, right: int, first: int, after: int, memory: SegmentMemory, count: int,
) -> int:  # fmt: skip
    """Append where runs with a class start in columns left..right and rows first..after of those looked at, exclusive.

    Returns how many seeds there are then, or BROKE_OFF without room for more.
    """
    step, level = candidates.least_step, candidates.least_level
    limits = (
        step[0], step[1], step[2], step[3], step[4], step[5], step[6], step[7],
        level[0], level[1], level[2], level[3], level[4], level[5], level[6], level[7],
    )  # fmt: skip
    for number in range(first, after):
        y = (number + 1) * memory.rows_apart - 1
        chunks = 0
        x = left
        while x < right:
            start = max(min(x, width - LANES), 0)
            if number + 1 < after:
                below = (y + memory.rows_apart) * width + start
                prefetch(flat, below)
                prefetch(flat, below + 21)
                prefetch(flat, below + 42)
            if width < LANES:
                _copy_cells(flat, y * width, width, memory.cells)
                chunks = 1
            elif candidate_bits(flat, y * width + start, limits) != np.uint64(0):
                write_cells(flat, y * width + start, memory.cells, chunks * LANES)
                memory.starts[chunks] = start
                chunks += 1
            x = start + LANES
        for chunk in range(chunks):
            if any_class(memory.cells, chunk * LANES, classes) != 0:
                count = _add_seeds(classes, chunk, y, left, right, memory, count)
    return count


@kernel
def _add_seeds(classes: Bytes, chunk: int, y: int, left: int, right: int, memory: SegmentMemory, count: int) -> int:
    """Append the seeds of 64 pixels, where they lie in columns left..right, exclusive."""
    start = memory.starts[chunk]
    before = 0
    for lane in range(max(left - start, 0), min(right - start, LANES)):
        color = classes[memory.cells[chunk * LANES + lane]]
        if color not in (0, before):
            if count == BROKE_OFF or count == len(memory.seeds):
                return BROKE_OFF
            memory.seeds[count, SEED_X], memory.seeds[count, SEED_Y] = start + lane, y
            count += 1
        before = color
    return count


@kernel
def _copy_cells(flat: Bytes, first: int, width: int, cells: np.ndarray) -> None:
    """The cells of a row that is shorter than a chunk; what is left over repeats the first."""
    for lane in range(LANES):
        pixel = 3 * (first + (lane if lane < width else 0))
        cells[lane] = (
            np.intp(flat[pixel]) >> 3 << 11 | np.intp(flat[pixel + 1]) >> 2 << 5 | np.intp(flat[pixel + 2]) >> 3
        )


@kernel
def flood_seeds(
    flat: Bytes, width: int, height: int, classes: Bytes, seeds: int, memory: SegmentMemory, blobs: Table
) -> tuple[int, bool]:
    """Fill a BLOB table from the seeds: (how many, whether all had room), or (BROKE_OFF, False)."""
    found, flooded, fits, budget = 0, 0, True, memory.flood_px
    for seed in range(seeds):
        if seed + AHEAD < seeds:
            _ask_ahead(flat, width, height, seed + AHEAD, memory)
        x, y = int(memory.seeds[seed, SEED_X]), int(memory.seeds[seed, SEED_Y])
        if is_visited(memory.visited, y, x):
            continue
        if found == len(blobs):
            fits = False
            break
        area = flood(flat, width, height, classes, x, y, memory.visited, memory.stack, budget, blobs[found])
        if area == BROKE_OFF:
            memory.visited[:] = np.uint64(0)
            return BROKE_OFF, False
        box, blob = memory.boxes[flooded], blobs[found]
        box[LEFT], box[TOP], box[RIGHT], box[BOTTOM] = blob.left, blob.top, blob.right, blob.bottom
        flooded += 1
        budget -= area
        if area >= memory.min_area_px:
            found += 1
    _forget(memory, flooded)
    return (found, fits) if seeds != BROKE_OFF else (BROKE_OFF, False)


@kernel
def _forget(memory: SegmentMemory, flooded: int) -> None:
    """Clear what was flooded: a few thousand bytes where the whole picture has hundreds of thousands."""
    for box in memory.boxes[:flooded]:
        for y in range(box[TOP], box[BOTTOM] + 1):
            for word in range(box[LEFT] >> 6, (box[RIGHT] >> 6) + 1):
                memory.visited[y, word] = np.uint64(0)


@kernel
def _ask_ahead(flat: Bytes, width: int, height: int, seed: int, memory: SegmentMemory) -> None:
    """Ask for the pixels round a seed, which lie in rows that nobody has read yet."""
    x, y = int(memory.seeds[seed, SEED_X]), int(memory.seeds[seed, SEED_Y])
    if is_visited(memory.visited, y, x):
        return
    apart = memory.rows_apart
    for row in range(max(y - apart, 0), min(y + 2 * apart, height)):
        prefetch(flat, row * width + x - apart)
        prefetch(flat, row * width + x + apart)
