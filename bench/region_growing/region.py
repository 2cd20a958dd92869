"""Region growing from an object's last position: it reads as few pixels as possible.

The method of the CAMBADA robots (Neves et al., "A modular vision system", section 3). Each object is searched alone.
The search starts at the object's last position, or at the center of the picture, and tests points on square rings, the
nearest first. From a point of the object's color a region is grown with two queues: *candidates* are pixels whose color
is still to be tested; *members* are pixels of the color, whose neighbors become candidates. A region is valid if its
area is within limits and enough of the pixels around it have a given color; to find these, the front is expanded by
some layers through pixels of any color. Regions that are not valid are marked, and the search goes on.

An object near its last position costs a few hundred pixels. An object that has gone costs a search of the whole
picture: the time varies as in the paper's figure 3. ``budget_px`` limits it.

A color is a set of classes of the color table, or a seed with tolerances. Seeds are for colors that the table cannot
separate: it has only 32 x 64 x 32 cells, for one venue and one light.
"""

import math
from typing import Any, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from vision_core.geometry import Bytes
from vision_core.native.kernels import kernel
from vision_core.types.color_cells import color_cell
from vision_core.types.tables import BLOB, Table

Row: TypeAlias = Any
"""One row of a table. In kernels its fields are attributes."""

NOT_FOUND = -1.0
LAST_SERIAL = (1 << 30) - 1

COLOR = np.dtype(
    [
        ("classes", np.uint8, (256,)), ("by_seed", np.int64),
        ("luma", np.float64), ("cb", np.float64), ("cr", np.float64),
        ("luma_tolerance", np.float64), ("chroma_tolerance", np.float64),
    ]
)  # fmt: skip
"""The color of an object. by_seed = 0: classes holds 1 for each class of the color table that the object may have.
by_seed = 1: all colors within the tolerances of luma, Cb and Cr [grey levels]."""

LIMITS = np.dtype(
    [
        ("search_px", np.int64), ("step_px", np.int64), ("min_area_px", np.int64), ("max_area_px", np.int64),
        ("gap_px", np.int64), ("ring_px", np.int64), ("min_around", np.float64), ("budget_px", np.int64),
    ]
)  # fmt: skip
"""One row: the search reaches search_px from its start, in steps of step_px; a region is valid with an area from
min_area_px to max_area_px, if at least min_around of the pixels gap_px + 1 ... gap_px + ring_px layers outside it have
the color that must surround it; at most budget_px pixels are grown."""


class GrowingBuffers(NamedTuple):
    """Buffers for pictures of one size, allocated once and filled by `grow`."""

    stamps: NDArray[np.int32]
    """Shape (height, width): 2 * the number of the region that last tested a pixel, + 1 if it became a member."""
    serial: NDArray[np.int64]
    """Number of the last region, shape (1,)."""
    members: NDArray[np.int32]
    """Queue of the members at the front of the region, x and y, shape (room, 2)."""
    candidates: NDArray[np.int32]
    """Queue of the neighbors of the front whose color is to be tested."""
    edge: NDArray[np.int32]
    """Candidates of another color: the pixels round the region."""
    blob: Table
    """The region that was found, one row of BLOB."""


def growing_buffers(width_px: int, height_px: int) -> GrowingBuffers:
    """Buffers for pictures of one size. A front longer than eight times the picture's perimeter is not followed."""
    room = 16 * (width_px + height_px)
    return GrowingBuffers(
        stamps=np.zeros((height_px, width_px), dtype=np.int32),
        serial=np.zeros(1, dtype=np.int64),
        members=np.zeros((room, 2), dtype=np.int32),
        candidates=np.zeros((room, 2), dtype=np.int32),
        edge=np.zeros((room, 2), dtype=np.int32),
        blob=np.zeros(1, dtype=BLOB),
    )


def color_of_classes(*numbers: int) -> Table:
    """A color by classes of the color table, shape (1,)."""
    color = np.zeros(1, dtype=COLOR)
    color["classes"][0, list(numbers)] = 1
    return color


def color_of_seed(bgr: tuple[float, float, float], luma_tolerance: float, chroma_tolerance: float) -> Table:
    """A color by an example and tolerances: luma, and distance in the (Cb, Cr) plane [grey levels], shape (1,)."""
    color = np.zeros(1, dtype=COLOR)
    color["luma"], color["cb"], color["cr"] = luma_and_chroma(*bgr)
    color["luma_tolerance"], color["chroma_tolerance"] = luma_tolerance, chroma_tolerance
    color["by_seed"] = 1
    return color


def step_for(area_px: int) -> int:
    """Largest step of a grid of points [px] that no disc of an area fits between: (d - 0.5) / sqrt(2) for a diameter d.

    The half pixel is subtracted since a disc made of pixels may be so much narrower.
    """
    diameter = 2.0 * math.sqrt(area_px / math.pi)
    return max(1, math.floor((diameter - 0.5) / math.sqrt(2.0)))


@kernel
def grow(
    pixels: Bytes,
    classes: Bytes,
    x_px: float,
    y_px: float,
    color: Table,
    around: Table,
    limits: Table,
    buffers: GrowingBuffers,
) -> float:
    """Find the valid region of a color that is nearest to a start; write it to buffers.blob.

    pixels: shape (height, width, 3); classes: of a ColorTable; color, around: rows of COLOR; limits: a row of LIMITS.
    Returns the share of the surrounding pixels that have the color `around` (1 when ring_px is 0), or NOT_FOUND.
    """
    # the start, clamped to the picture
    height, width = buffers.stamps.shape
    limit, wanted = limits[0], color[0]
    x, y = min(max(int(x_px + 0.5), 0), width - 1), min(max(int(y_px + 0.5), 0), height - 1)
    first, budget = next_serial(buffers), limit.budget_px
    # test points on square rings, the nearest first, until one has the object's color
    for ring in range(limit.search_px // limit.step_px + 2):
        for side in range(4):
            u, v, du, dv, points = side_of_ring(ring, side, x, y, limit.step_px, width, height)
            for point in range(points):
                px, py = u + point * du, v + point * dv
                if not is_of(wanted, classes, pixels[py, px]):
                    continue
                if buffers.stamps[py, px] & 1 and buffers.stamps[py, px] >> 1 >= first:
                    continue  # it belongs to a region that was not valid
                # grow its region; test the area, then the surroundings
                complete, edge_count = grow_region(pixels, classes, px, py, wanted, buffers, budget)
                area = buffers.blob[0].area_px
                budget -= area
                if not complete:
                    return NOT_FOUND
                if area < limit.min_area_px or area > limit.max_area_px:
                    continue
                share = (
                    surrounding_share(pixels, classes, around[0], limit, buffers, edge_count) if limit.ring_px else 1.0
                )
                if not limit.ring_px or share >= limit.min_around:
                    return share
    return NOT_FOUND


@kernel
def next_serial(buffers: GrowingBuffers) -> int:
    """Number of the next region. Before the numbers overflow all stamps are cleared and counting starts again."""
    if buffers.serial[0] > LAST_SERIAL - buffers.stamps.size:
        buffers.stamps[:] = 0
        buffers.serial[0] = 0
    return int(buffers.serial[0]) + 1


@kernel
def side_of_ring(
    ring: int, side: int, x: int, y: int, step: int, width: int, height: int
) -> tuple[int, int, int, int, int]:
    """Points inside the picture on one side of a square ring round x, y: the first's x and y, steps in x and y, number.

    Each corner of the ring belongs to one side only.
    """
    reach = ring * step
    along_x = side < 2
    if along_x:
        first, limit, fixed, fixed_limit = x - reach, width, (y - reach if side == 0 else y + reach), height
    else:
        first, limit, fixed, fixed_limit = y - reach, height, (x - reach if side == 2 else x + reach), width
    count = 2 * ring if ring or side else 1
    first += step * (side in (1, 2)) * (ring > 0)
    skipped = (-first + step - 1) // step if first < 0 else 0
    first += skipped * step
    count = min(count - skipped, (limit - 1 - first) // step + 1)
    if fixed < 0 or fixed >= fixed_limit:
        count = 0
    if along_x:
        return first, fixed, step, 0, count
    return fixed, first, 0, step, count


@kernel
def is_of(color: Row, classes: Bytes, pixel: Bytes) -> bool:
    """Whether a pixel (blue green red) is of a color (a row of COLOR)."""
    if not color.by_seed:
        return bool(color.classes[classes[color_cell(pixel[0], pixel[1], pixel[2])]])
    luma, cb, cr = luma_and_chroma(float(pixel[0]), float(pixel[1]), float(pixel[2]))
    if abs(luma - color.luma) > color.luma_tolerance:
        return False
    return bool((cb - color.cb) ** 2 + (cr - color.cr) ** 2 <= color.chroma_tolerance**2)


@kernel
def luma_and_chroma(blue: float, green: float, red: float) -> tuple[float, float, float]:
    """Y, Cb and Cr of a color, ITU-R BT.601, full range, Cb and Cr about 0 [grey levels]."""
    luma = 0.299 * red + 0.587 * green + 0.114 * blue
    return luma, (blue - luma) * (0.5 / (1.0 - 0.114)), (red - luma) * (0.5 / (1.0 - 0.299))


@kernel
def grow_region(
    pixels: Bytes, classes: Bytes, x: int, y: int, color: Row, buffers: GrowingBuffers, budget_px: int
) -> tuple[bool, int]:
    """Grow the region of a pixel into buffers.blob. Returns whether it is complete, and the number of pixels round it.

    A region is incomplete if it has more pixels than the budget, or its front is longer than the queues.
    """
    stamps, members, candidates, edge = buffers.stamps, buffers.members, buffers.candidates, buffers.edge
    buffers.serial[0] += 1
    serial = buffers.serial[0]
    members[0, 0], members[0, 1] = x, y
    stamps[y, x] = 2 * serial + 1
    area = sum_x = sum_y = edge_count = 0
    left = right = x
    top = bottom = y
    front, complete = 1, True
    while front and complete:
        # add the members of the front to the region, and queue their neighbors
        waiting = 0
        for member in range(front):
            px, py = members[member, 0], members[member, 1]
            area += 1
            sum_x += px
            sum_y += py
            left, right, top, bottom = min(left, px), max(right, px), min(top, py), max(bottom, py)
            waiting = add_neighbors(px, py, stamps, serial, candidates, waiting)
        complete = area <= budget_px and waiting <= len(candidates) - 8
        # neighbors of the color become the next front, all others lie round the region
        front = 0
        for candidate in range(waiting):
            px, py = candidates[candidate, 0], candidates[candidate, 1]
            if is_of(color, classes, pixels[py, px]):
                stamps[py, px] = 2 * serial + 1
                members[front, 0], members[front, 1] = px, py
                front += 1
            elif edge_count < len(edge):
                edge[edge_count, 0], edge[edge_count, 1] = px, py
                edge_count += 1
    # the region as a blob
    blob = buffers.blob[0]
    blob.color = classes[color_cell(pixels[y, x, 0], pixels[y, x, 1], pixels[y, x, 2])]
    blob.area_px, blob.x_px, blob.y_px = area, sum_x / area, sum_y / area
    blob.left, blob.top, blob.right, blob.bottom = left, top, right, bottom
    return complete, edge_count


@kernel
def add_neighbors(
    x: int, y: int, stamps: NDArray[np.int32], serial: int, queue: NDArray[np.int32], waiting: int
) -> int:
    """Queue the 8-neighbors of a pixel that this region has not tested yet. Returns the new length of the queue.

    Neighbors for which the queue has no room are left out.
    """
    height, width = stamps.shape
    for v in range(max(y - 1, 0), min(y + 2, height)):
        for u in range(max(x - 1, 0), min(x + 2, width)):
            if stamps[v, u] >> 1 == serial or waiting == len(queue):
                continue
            stamps[v, u] = 2 * serial
            queue[waiting, 0], queue[waiting, 1] = u, v
            waiting += 1
    return waiting


@kernel
def surrounding_share(
    pixels: Bytes, classes: Bytes, around: Row, limits: Row, buffers: GrowingBuffers, edge_count: int
) -> float:
    """Share of the pixels that have the color around, gap_px + 1 ... gap_px + ring_px layers outside the last region.

    0 for a region that fills the picture.
    """
    layer, beyond = buffers.edge, buffers.candidates
    serial, count, alike, judged = buffers.serial[0], edge_count, 0, 0
    for distance in range(1, limits.gap_px + limits.ring_px + 1):
        # expand the front by one layer
        if distance > 1:
            waiting = 0
            for pixel in range(count):
                waiting = add_neighbors(layer[pixel, 0], layer[pixel, 1], buffers.stamps, serial, beyond, waiting)
            layer, beyond, count = beyond, layer, waiting
        # count the pixels of the color in layers beyond the gap
        if distance > limits.gap_px:
            judged += count
            for pixel in range(count):
                alike += is_of(around, classes, pixels[layer[pixel, 1], layer[pixel, 0]])
    return alike / judged if judged else 0.0
