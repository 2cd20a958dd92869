"""Run lengths and union-find: the classic segmentation as one compiled kernel."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from vision_core.geometry import Bytes
from vision_core.native.kernels import kernel, read_only
from vision_core.settings.schema import BlobSettings
from vision_core.types.colors import ColorTable
from vision_core.types.tables import BLOB, Table

ROW, START, END, COLOR, PARENT = range(5)
"""Columns of the table of runs. END is exclusive; PARENT points to an earlier run, or to itself."""

AREA, SUM_X, SUM_Y, LEFT, TOP, RIGHT, BOTTOM = range(7)
"""Columns of the table of regions: sums over their pixels, and their bounding box."""


class RunMemory(NamedTuple):
    """The classic's memory, taken once. A compiled function can take it as an argument."""

    runs: NDArray[np.int32]
    """Shape (max_runs, 5)."""
    region_of_run: NDArray[np.int32]
    regions: NDArray[np.int64]
    """Shape (max_runs, 7)."""


def run_memory(settings: BlobSettings) -> RunMemory:
    """Memory for pictures of any size."""
    return RunMemory(
        runs=np.zeros((settings.max_runs, 5), dtype=np.int32),
        region_of_run=np.zeros(settings.max_runs, dtype=np.int32),
        regions=np.zeros((settings.max_runs, 7), dtype=np.int64),
    )


class Segmenter:
    """Finds the blobs of pictures of one size, in memory that is taken once.

    Not to be shared between threads: two calls would write into the same tables.
    """

    def __init__(self, width_px: int, height_px: int, settings: BlobSettings) -> None:
        self._shape = (height_px, width_px, 3)
        self._min_area_px = settings.min_area_px
        self._memory = run_memory(settings)
        self.blobs: Table = np.zeros(settings.max_blobs, dtype=BLOB)
        """Filled by ``segment``, in scan order."""

    def segment(self, pixels: Bytes, table: ColorTable) -> tuple[int, bool]:
        """Fill ``blobs``: how many there are, and whether all had room.

        pixels: shape (height, width, 3), contiguous, blue green red.
        """
        assert pixels.shape == self._shape, f"{pixels.shape} is not {self._shape}"
        return segment_runs(read_only(pixels), read_only(table.classes), self._min_area_px, self._memory, self.blobs)


@kernel
def segment_runs(pixels: Bytes, classes: Bytes, min_area: int, memory: RunMemory, blobs: Table) -> tuple[int, bool]:
    """Fill a BLOB table with all blobs of a picture: how many, and whether runs and blobs had room.

    pixels: shape (height, width, 3), contiguous; classes: shape (65536,); min_area [px].
    """
    count, runs_fit = collect_runs(pixels, classes, memory.runs)
    found, blobs_fit = collect_blobs(memory.runs, count, min_area, memory.region_of_run, memory.regions, blobs)
    return found, runs_fit and blobs_fit


@kernel
def collect_runs(pixels: Bytes, classes: Bytes, runs: np.ndarray) -> tuple[int, bool]:
    """Cut all rows into runs and join touching ones; how many there are, and whether all had room.

    pixels: shape (height, width, 3), contiguous; classes: shape (65536,); runs: shape (most, 5), filled.
    """
    height, width, _ = pixels.shape
    count = above = above_end = 0
    for y in range(height):
        row_start = count
        row = pixels[y]
        color = 0
        start = 0
        for x in range(width):
            here = classes[(np.intp(row[x, 0]) >> 3) << 11 | (np.intp(row[x, 1]) >> 2) << 5 | np.intp(row[x, 2]) >> 3]
            if here != color:
                if color != 0:
                    if count == len(runs):
                        return count, False
                    above = _append(runs, count, y, start, x, color, above, above_end)
                    count += 1
                color = here
                start = x
        if color != 0:
            if count == len(runs):
                return count, False
            above = _append(runs, count, y, start, width, color, above, above_end)
            count += 1
        above, above_end = row_start, count
    return count, True


@kernel
def _append(runs: np.ndarray, number: int, y: int, start: int, end: int, color: int, above: int, above_end: int) -> int:
    """Write a run and join it to the runs above that it touches; the first of them that may touch the next."""
    runs[number, ROW] = y
    runs[number, START] = start
    runs[number, END] = end
    runs[number, COLOR] = color
    runs[number, PARENT] = number
    while above < above_end and runs[above, END] < start:
        above += 1
    other = above
    while other < above_end and runs[other, START] <= end:
        if runs[other, COLOR] == color:
            one, two = _root(runs, number), _root(runs, other)
            runs[max(one, two), PARENT] = min(one, two)
        other += 1
    return above


@kernel
def _root(runs: np.ndarray, run: int) -> int:
    while runs[run, PARENT] != run:
        runs[run, PARENT] = runs[runs[run, PARENT], PARENT]
        run = runs[run, PARENT]
    return run


@kernel
def collect_blobs(
    runs: np.ndarray, count: int, min_area: int, region_of_run: np.ndarray, regions: np.ndarray, blobs: Table
) -> tuple[int, bool]:
    """Sum the runs of every region; how many blobs there are, and whether all had room.

    A root comes before all other runs of its region, so one pass suffices and keeps the scan order.
    """
    found = 0
    for run in range(count):
        root = _root(runs, run)
        if root == run:
            region_of_run[run] = found
            regions[found, AREA] = regions[found, SUM_X] = regions[found, SUM_Y] = 0
            regions[found, LEFT], regions[found, RIGHT] = runs[run, START], runs[run, END] - 1
            regions[found, TOP] = runs[run, ROW]
            found += 1
        region = region_of_run[root]
        region_of_run[run] = region
        _add_run(regions[region], runs[run, ROW], runs[run, START], runs[run, END])
    kept = 0
    for run in range(count):
        if runs[run, PARENT] != run or regions[region_of_run[run], AREA] < min_area:
            continue
        if kept == len(blobs):
            return kept, False
        sums, blob = regions[region_of_run[run]], blobs[kept]
        area = sums[AREA]
        blob.color, blob.area_px = runs[run, COLOR], area
        blob.x_px, blob.y_px = sums[SUM_X] / area, sums[SUM_Y] / area
        blob.left, blob.top, blob.right, blob.bottom = sums[LEFT], sums[TOP], sums[RIGHT], sums[BOTTOM]
        kept += 1
    return kept, True


@kernel
def _add_run(region: np.ndarray, y: int, start: int, end: int) -> None:
    length = end - start
    region[AREA] += length
    region[SUM_X] += (start + end - 1) * length // 2
    region[SUM_Y] += y * length
    region[LEFT] = min(region[LEFT], start)
    region[RIGHT] = max(region[RIGHT], end - 1)
    region[BOTTOM] = y
