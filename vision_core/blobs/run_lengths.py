"""Run lengths and union-find: the classic segmentation as one compiled kernel."""

import numpy as np

from vision_core.geometry import Bytes, Floats
from vision_core.kernels import kernel
from vision_core.settings import BlobSettings
from vision_core.types.blobs import Blobs
from vision_core.types.colors import ColorTable

ROW, START, END, COLOR, PARENT = range(5)
"""Columns of the table of runs. END is exclusive; PARENT points to an earlier run, or to itself."""

AREA, SUM_X, SUM_Y, LEFT, TOP, RIGHT, BOTTOM = range(7)
"""Columns of the table of regions: sums over their pixels, and their bounding box."""


class Segmenter:
    """Finds the blobs of pictures of one size, in memory that is taken once.

    Not to be shared between threads: two calls would write into the same tables.
    """

    def __init__(self, width_px: int, height_px: int, settings: BlobSettings) -> None:
        self._shape = (height_px, width_px, 3)
        self._min_area_px = settings.min_area_px
        self._runs = np.zeros((settings.max_runs, 5), dtype=np.int32)
        self._region_of_run = np.zeros(settings.max_runs, dtype=np.int32)
        self._regions = np.zeros((settings.max_runs, 7), dtype=np.int64)
        self._color = np.zeros(settings.max_blobs, dtype=np.uint8)
        self._area = np.zeros(settings.max_blobs, dtype=np.int64)
        self._center = np.zeros((settings.max_blobs, 2), dtype=np.float64)
        self._box = np.zeros((settings.max_blobs, 4), dtype=np.int64)

    def segment(self, pixels: Bytes, table: ColorTable) -> Blobs:
        """The blobs of a picture: shape (height, width, 3), blue green red."""
        assert pixels.shape == self._shape, f"{pixels.shape} is not {self._shape}"
        count, runs_fit = collect_runs(_read_only(pixels), _read_only(table.classes), self._runs)
        blobs, blobs_fit = collect_blobs(
            self._runs, count, self._min_area_px, self._region_of_run, self._regions,
            self._color, self._area, self._center, self._box,
        )  # fmt: skip
        return Blobs(
            color=self._color[:blobs].copy(),
            area_px=self._area[:blobs].copy(),
            center_px=self._center[:blobs].copy(),
            box_px=self._box[:blobs].copy(),
            complete=runs_fit and blobs_fit,
        )


def _read_only(array: Bytes) -> Bytes:
    """One memory layout for the kernel, which is compiled anew for every other: frames come read-only or not."""
    view = np.ascontiguousarray(array).view()
    view.setflags(write=False)
    return view


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
    runs: np.ndarray, count: int, min_area: int, region_of_run: np.ndarray, regions: np.ndarray,
    out_color: Bytes, out_area: np.ndarray, out_center: Floats, out_box: np.ndarray,
) -> tuple[int, bool]:  # fmt: skip
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
        if kept == len(out_area):
            return kept, False
        region_sums = regions[region_of_run[run]]
        area = region_sums[AREA]
        out_color[kept] = runs[run, COLOR]
        out_area[kept] = area
        out_center[kept, 0] = region_sums[SUM_X] / area
        out_center[kept, 1] = region_sums[SUM_Y] / area
        out_box[kept] = region_sums[LEFT : BOTTOM + 1]
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
