"""Ways to see a robot of a team at each blob of its color, as compiled kernels."""

import math

from vision_core.geometry import Bytes, Floats
from vision_core.models.camera_kernels import CameraMap, field_and_scale, field_from_pixel
from vision_core.native.kernels import kernel
from vision_core.objects.robots.buffers import (
    ACROSS,
    ALONG,
    ANCHOR,
    BLOB,
    BUCKETS,
    FIRST_LIKENESS,
    FIRST_SLOT,
    HEADING,
    MATCHED,
    MAX_NEAR,
    MAX_ROWS,
    MAX_SLOTS,
    ROOM,
    SCORE,
    SHAPED,
    STEADY,
    TEAM,
    Gates,
    Memory,
    X,
    Y,
)
from vision_core.objects.robots.markers import ANCHOR as MAY_ANCHOR
from vision_core.objects.robots.markers import REFUSED, Marker
from vision_core.objects.robots.markers import SLOT as MAY_FILL
from vision_core.objects.robots.pose_fit import GATHER, gather, is_known, judge, keep, write_blobs
from vision_core.objects.robots.shapes import STEADY as SHAPE_STEADY
from vision_core.objects.robots.shapes import agreement, alike, heading_from, measure_shape
from vision_core.types.tables import Table

SHAPE_SAYS = 0.4
"""How much of a hypothesis' score its anchor's shape decides."""

NEAREST, NEAREST_WHOLE = 0.8, 0.55
"""Centers nearer than this share of their radii's sum cannot both be robots; nor whole markers, whose bodies may be
narrower than their outline says."""

LESS = 0.999
"""A hypothesis that is a part of another one comes after it."""

SURE, OTHER = 0.75, 0.75
"""An anchor's shape tells the heading alone when it agrees so well, and with any other heading so much less."""


@kernel
def place_blobs(blobs: Table, count: int, camera: CameraMap, marker: Marker, gates: Gates, memory: Memory) -> int:
    """Put the blobs that a team may wear on the field, those of its slots into the grid; how many are listed."""
    places, heads = memory.places[marker.team], memory.heads
    for row in range(BUCKETS):
        for column in range(BUCKETS):
            heads[row, column] = -1
    cell = _reach(marker, gates)
    listed = 0
    for blob in range(count):
        worn = marker.wears[blobs[blob].color]
        if worn == 0:
            continue
        x, y, scale2 = field_and_scale(camera, blobs[blob].x_px, blobs[blob].y_px, marker.height_m)
        if not _is_accepted(x, y, marker.radius_m, gates.field_m):
            continue
        area = blobs[blob].area_px / scale2
        if not area >= gates.min_area * marker.least_area_m2:
            continue
        places[blob, 0], places[blob, 1], places[blob, 2] = x, y, area
        memory.listed[listed] = blob
        listed += 1
        if worn & MAY_FILL:
            column, row = _bucket(x, cell), _bucket(y, cell)
            memory.nexts[blob] = heads[row, column]
            heads[row, column] = blob
    return listed


@kernel
def _reach(marker: Marker, gates: Gates) -> float:
    farthest: float = marker.reach_m[1] + GATHER * gates.tolerance_m
    return farthest


@kernel
def _is_accepted(x_m: float, y_m: float, radius_m: float, field_m: Floats) -> bool:
    """Whether a patch of a robot may lie there: at most its radius outside of the field or a goal; False for nan."""
    x, y = abs(x_m) - radius_m, abs(y_m) - radius_m
    accepted: bool = (x <= field_m[0] and y <= field_m[1]) or (x <= field_m[2] and y <= field_m[3])
    return accepted


@kernel
def _bucket(place_m: float, cell_m: float) -> int:
    return math.floor(place_m / cell_m) % BUCKETS


@kernel
def likeness_of(share: float, gates: Gates) -> float:
    """How near an area is to the predicted one, 0..1: the root of the smaller over the larger; 0 beyond the gates."""
    if not gates.min_area <= share <= gates.max_area:
        return 0.0
    return math.sqrt(min(share, 1.0 / share))


@kernel
def propose(
    blobs: Table, listed: int, pixels: Bytes, classes: Bytes, camera: CameraMap, marker: Marker, gates: Gates,
    memory: Memory, count: int,
) -> int:  # fmt: skip
    """Add the hypotheses of a team to those that there are; how many there are then.

    The score is the share of the marker's painted area that is there * (1 - (rms residual / tolerance)^2) * mean
    likeness of the areas * how well the anchor's shape agrees.
    """
    places, rows, filled = memory.places[marker.team], memory.rows, memory.filled
    for slot in range(MAX_SLOTS):
        filled[slot] = -1
    look = marker.pointed or marker.shares[0] >= gates.min_confidence
    for k in range(listed):
        anchor = memory.listed[k]
        like = likeness_of(places[anchor, 2] / marker.anchor_area_m2, gates)
        if like == 0.0 or not marker.wears[blobs[anchor].color] & MAY_ANCHOR:
            continue
        shaped = look and _see_shape(blobs, anchor, pixels, classes, camera, marker.height_m, memory.shape)
        near = _look_round(blobs, anchor, marker, gates, memory) if len(marker.arms_m) else 0
        start = count
        for first in range(near):
            for slot in range(len(marker.arms_m)):
                if count + 2 > MAX_ROWS:
                    return count
                row = rows[count]
                if not gather(memory.near, near, marker.arms_m, gates.tolerance_m, first, slot, filled):
                    continue
                write_blobs(memory.near, filled, anchor, marker.team, row)
                if is_known(rows, start, count):
                    continue
                judge(memory.near, marker.arms_m, marker.shares, gates.tolerance_m, like, filled, row)
                write_blobs(memory.near, filled, anchor, marker.team, row)
                if row[SCORE] >= gates.min_confidence:
                    c, s = math.cos(row[HEADING]), math.sin(row[HEADING])
                    row[X] += places[anchor, 0] - c * marker.anchor_m[0] + s * marker.anchor_m[1]
                    row[Y] += places[anchor, 1] - s * marker.anchor_m[0] - c * marker.anchor_m[1]
                    whole = row[MATCHED] == len(marker.arms_m)
                    row[SHAPED], row[ROOM] = shaped, (NEAREST_WHOLE if whole else NEAREST) * marker.radius_m
                    if shaped:
                        row[SCORE] *= 1.0 - SHAPE_SAYS * (1.0 - agreement(marker.shape, memory.shape, row[HEADING]))
                    count = keep(rows, start, count)
        if marker.shares[0] * like >= gates.min_confidence:
            count += _alone(anchor, like, shaped, marker, gates, memory, start, count)
    return count


@kernel
def _see_shape(
    blobs: Table, anchor: int, pixels: Bytes, classes: Bytes, camera: CameraMap, height_m: float, shape: Floats
) -> bool:  # fmt: skip
    """Measure an anchor's shape; False if it has none."""
    blob = blobs[anchor]
    x, y = blob.x_px, blob.y_px
    left_x, left_y = field_from_pixel(camera, x - 1.0, y, height_m)
    right_x, right_y = field_from_pixel(camera, x + 1.0, y, height_m)
    up_x, up_y = field_from_pixel(camera, x, y - 1.0, height_m)
    down_x, down_y = field_from_pixel(camera, x, y + 1.0, height_m)
    step = (0.5 * (right_x - left_x), 0.5 * (right_y - left_y), 0.5 * (down_x - up_x), 0.5 * (down_y - up_y))
    box = (blob.left, blob.top, blob.right, blob.bottom)
    return measure_shape(pixels, classes, blob.color, blob.area_px, box, step, shape)


@kernel
def _look_round(blobs: Table, anchor: int, marker: Marker, gates: Gates, memory: Memory) -> int:
    """List the blobs round an anchor that may fill a slot; how many there are."""
    places, near, cell = memory.places[marker.team], memory.near, _reach(marker, gates)
    x, y = places[anchor, 0], places[anchor, 1]
    nearest = max(marker.reach_m[0] - GATHER * gates.tolerance_m, 0.0)
    column, row = _bucket(x, cell), _bucket(y, cell)
    count = 0
    for across in range(row - 1, row + 2):
        for along in range(column - 1, column + 2):
            blob = memory.heads[across % BUCKETS, along % BUCKETS]
            while blob >= 0:
                dx, dy = places[blob, 0] - x, places[blob, 1] - y
                if nearest**2 <= dx * dx + dy * dy <= cell**2 and blob != anchor and count < MAX_NEAR:
                    near[count, BLOB], near[count, ALONG], near[count, ACROSS] = blob, dx, dy
                    useful = False
                    for slot in range(len(marker.slots_m)):
                        like = 0.0
                        if marker.digits[slot, blobs[blob].color] != REFUSED:
                            like = likeness_of(places[blob, 2] / marker.areas_m2[slot], gates)
                        near[count, FIRST_LIKENESS + slot] = like
                        useful |= like > 0.0
                    count += useful
                blob = memory.nexts[blob]
    return count


@kernel
def _alone(
    anchor: int, like: float, shaped: bool, marker: Marker, gates: Gates, memory: Memory, start: int, count: int
) -> int:  # fmt: skip
    """Fill a row with the anchor alone, which is less than anything with it; 1 if that may be a robot, else 0."""
    least = 1.0
    for other in range(start, count):
        least = min(least, LESS * memory.rows[other, SCORE])
    row = memory.rows[count]
    score = marker.shares[0] * like * (alike(marker.shape, memory.shape) if shaped else 1.0)
    row[SCORE] = min(least, score)
    if score < gates.min_confidence:
        return 0
    row[TEAM], row[ANCHOR], row[MATCHED], row[SHAPED], row[STEADY], row[HEADING] = marker.team, anchor, 0, 0, 0, 0
    for slot in range(MAX_SLOTS):
        row[FIRST_SLOT + slot] = -1
    row[ROOM] = max(NEAREST * marker.radius_m - math.hypot(marker.anchor_m[0], marker.anchor_m[1]), 0.0)
    row[X], row[Y] = memory.places[marker.team, anchor, 0], memory.places[marker.team, anchor, 1]
    if shaped and marker.enough_shaped == 0:
        heading, best, other_best = heading_from(marker.shape, memory.shape)
        if best >= SURE and other_best <= OTHER * best:
            c, s = math.cos(heading), math.sin(heading)
            row[HEADING], row[SHAPED], row[STEADY] = heading, 2, memory.shape[SHAPE_STEADY]
            row[ROOM] = (NEAREST if len(marker.arms_m) else NEAREST_WHOLE) * marker.radius_m
            row[X] -= c * marker.anchor_m[0] - s * marker.anchor_m[1]
            row[Y] -= s * marker.anchor_m[0] + c * marker.anchor_m[1]
    return 1
