"""Run lengths and union-find: the reference segmentation, as one compiled kernel."""

from typing import Any, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from vision_core.blobs.bits import Bits, is_masked
from vision_core.geometry import Bytes
from vision_core.native.kernels import kernel
from vision_core.settings.schema import BlobSettings
from vision_core.types.color_cells import color_cell
from vision_core.types.tables import Table

Row: TypeAlias = Any
"""One row of a table."""

RUN = np.dtype([("row", np.int32), ("start", np.int32), ("end", np.int32), ("color", np.int32), ("parent", np.int32)])
"""Pixels of one class side by side; the end is exclusive. The parent is an earlier run of the same region, or the run
itself: then it is the region's root."""

REGION = np.dtype(
    [
        ("area", np.int64), ("sum_x", np.int64), ("sum_y", np.int64),
        ("left", np.int64), ("top", np.int64), ("right", np.int64), ("bottom", np.int64),
    ]
)  # fmt: skip
"""Sums over a region's pixels, and its bounding box, inclusive."""


class RunBuffers(NamedTuple):
    """Memory of the reference segmentation, allocated once. Kernels take it as one argument."""

    runs: Table
    """RUN, shape (max_runs,)."""
    region_of_run: NDArray[np.int32]
    """Shape (max_runs,)."""
    regions: Table
    """REGION, shape (max_runs,)."""
    masked: Bits | None
    """Pixels that are background, whatever their color; None: there are none."""


def run_buffers(settings: BlobSettings, masked: Bits | None = None) -> RunBuffers:
    """Buffers for pictures of any size, or with masked pixels for those of theirs."""
    return RunBuffers(
        runs=np.zeros(settings.max_runs, dtype=RUN),
        region_of_run=np.zeros(settings.max_runs, dtype=np.int32),
        regions=np.zeros(settings.max_runs, dtype=REGION),
        masked=masked,
    )


@kernel
def segment_runs(pixels: Bytes, classes: Bytes, min_area: int, buffers: RunBuffers, blobs: Table) -> tuple[int, bool]:
    """Fill a BLOB table with all blobs of a picture, in scan order: how many, and whether there was room for all.

    pixels: shape (height, width, 3), contiguous; classes: shape (65536,); min_area [px].
    """
    count, all_runs = collect_runs(pixels, classes, buffers.masked, buffers.runs)
    found, all_blobs = collect_blobs(buffers.runs, count, min_area, buffers.region_of_run, buffers.regions, blobs)
    return found, all_runs and all_blobs


@kernel
def collect_runs(pixels: Bytes, classes: Bytes, masked: Bits | None, runs: Table) -> tuple[int, bool]:
    """Cut all rows into runs and join touching ones; how many there are, and whether there was room for all.

    pixels: shape (height, width, 3), contiguous; classes: shape (65536,); runs: RUN table, filled.
    """
    height, width, _ = pixels.shape
    count = above = above_end = 0
    for y in range(height):
        row_start = count
        row = pixels[y]
        color = 0
        start = 0
        for x in range(width):
            here = classes[color_cell(row[x, 0], row[x, 1], row[x, 2])]
            if here != 0 and is_masked(masked, y, x):
                here = np.uint8(0)
            # where the class changes a run ends
            if here != color:
                if color != 0:
                    if count == len(runs):
                        return count, False
                    above = _append(runs, count, y, start, x, color, above, above_end)
                    count += 1
                color = here
                start = x
        # the last run of the row
        if color != 0:
            if count == len(runs):
                return count, False
            above = _append(runs, count, y, start, width, color, above, above_end)
            count += 1
        above, above_end = row_start, count
    return count, True


@kernel
def _append(runs: Table, number: int, y: int, start: int, end: int, color: int, above: int, above_end: int) -> int:
    """Write a run and join it to the runs of the row above that it touches.

    above, above_end: runs of the row above that may touch it; returns the first of them that may touch the next run.
    """
    run = runs[number]
    run.row, run.start, run.end, run.color, run.parent = y, start, end, color, number
    while above < above_end and runs[above].end < start:
        above += 1
    other = above
    while other < above_end and runs[other].start <= end:
        if runs[other].color == color:
            one, two = _root(runs, number), _root(runs, other)
            runs[max(one, two)].parent = min(one, two)
        other += 1
    return above


@kernel
def _root(runs: Table, run: int) -> int:
    """The root of a run's region; paths are halved on the way."""
    while runs[run].parent != run:
        runs[run].parent = runs[runs[run].parent].parent
        run = runs[run].parent
    return run


@kernel
def collect_blobs(
    runs: Table, count: int, min_area: int, region_of_run: NDArray[np.int32], regions: Table, blobs: Table
) -> tuple[int, bool]:
    """Sum up the runs of every region; how many blobs there are, and whether there was room for all.

    A root comes before all other runs of its region, so one pass is enough and keeps the scan order.
    """
    # a root opens a region, every run is added to its root's
    found = 0
    for run in range(count):
        root = _root(runs, run)
        if root == run:
            region_of_run[run] = found
            region = regions[found]
            region.area = region.sum_x = region.sum_y = 0
            region.left, region.right, region.top = runs[run].start, runs[run].end - 1, runs[run].row
            found += 1
        number = region_of_run[root]
        region_of_run[run] = number
        _add_run(regions[number], runs[run].row, runs[run].start, runs[run].end)
    # regions that are large enough become blobs
    kept = 0
    for run in range(count):
        if runs[run].parent != run or regions[region_of_run[run]].area < min_area:
            continue
        if kept == len(blobs):
            return kept, False
        region, blob = regions[region_of_run[run]], blobs[kept]
        blob.color, blob.area_px = runs[run].color, region.area
        blob.x_px, blob.y_px = region.sum_x / region.area, region.sum_y / region.area
        blob.left, blob.top, blob.right, blob.bottom = region.left, region.top, region.right, region.bottom
        kept += 1
    return kept, True


@kernel
def _add_run(region: Row, y: int, start: int, end: int) -> None:
    length = end - start
    region.area += length
    region.sum_x += (start + end - 1) * length // 2
    region.sum_y += y * length
    region.left = min(region.left, start)
    region.right = max(region.right, end - 1)
    region.bottom = y
