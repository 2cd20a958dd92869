"""Ways to see a robot of a team at each blob of its color, as compiled kernels."""

import math

import numpy as np
from numpy.typing import NDArray

from vision_core.camera_kernels import CameraMap, field_from_pixel, pixels_per_square_metre
from vision_core.geometry import Bytes, Floats
from vision_core.kernels import kernel
from vision_core.objects.finder_memory import (
    ACROSS,
    ALONG,
    ANCHOR,
    BLOB,
    BUCKETS,
    FIRST_LIKENESS,
    FIRST_SLOT,
    HEADING,
    MATCHED,
    MISFIT,
    MOST_NEAR,
    MOST_ROWS,
    MOST_SLOTS,
    ROOM,
    ROW_LENGTH,
    SCORE,
    SHAPED,
    STEADY,
    TEAM,
    Gates,
    Memory,
    X,
    Y,
)
from vision_core.objects.markers import ANCHOR as MAY_ANCHOR
from vision_core.objects.markers import REFUSED, Marker
from vision_core.objects.markers import SLOT as MAY_FILL
from vision_core.objects.shapes import (
    STEADY as SHAPE_STEADY,
)
from vision_core.objects.shapes import agreement, alike, heading_from, measure_shape
from vision_core.types.tables import Table

Indices = NDArray[np.int32]

GATHER = 1.5
"""Before the fit a patch may be this many tolerances off, as one alone fixed the heading."""

KEPT = 8
"""Hypotheses kept per anchor: more are no use to the contest."""

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
        x, y = field_from_pixel(camera, blobs[blob].x_px, blobs[blob].y_px, marker.height_m)
        if not _is_accepted(x, y, marker.radius_m, gates.field_m):
            continue
        area = blobs[blob].area_px / pixels_per_square_metre(camera, x, y, marker.height_m)
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
    for slot in range(MOST_SLOTS):
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
                if count + 2 > MOST_ROWS:
                    return count
                row = rows[count]
                if not _gather(memory.near, near, marker.arms_m, gates.tolerance_m, first, slot, filled):
                    continue
                _write_blobs(memory.near, filled, anchor, marker.team, row)
                if _is_known(rows, start, count):
                    continue
                _judge(memory.near, marker.arms_m, marker.shares, gates.tolerance_m, like, filled, row)
                _write_blobs(memory.near, filled, anchor, marker.team, row)
                if row[SCORE] >= gates.min_confidence:
                    c, s = math.cos(row[HEADING]), math.sin(row[HEADING])
                    row[X] += places[anchor, 0] - c * marker.anchor_m[0] + s * marker.anchor_m[1]
                    row[Y] += places[anchor, 1] - s * marker.anchor_m[0] - c * marker.anchor_m[1]
                    whole = row[MATCHED] == len(marker.arms_m)
                    row[SHAPED], row[ROOM] = shaped, (NEAREST_WHOLE if whole else NEAREST) * marker.radius_m
                    if shaped:
                        row[SCORE] *= 1.0 - SHAPE_SAYS * (1.0 - agreement(marker.shape, memory.shape, row[HEADING]))
                    count = _keep(rows, start, count)
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
                if nearest**2 <= dx * dx + dy * dy <= cell**2 and blob != anchor and count < MOST_NEAR:
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
def _gather(
    near: Floats, count: int, arms: Floats, tolerance: float, first: int, where: int, filled: Indices
) -> bool:  # fmt: skip
    """Take one blob for one slot, and for every other slot the nearest blob within the gate; False if it cannot be."""
    if near[first, FIRST_LIKENESS + where] == 0.0:
        return False
    a, b, u, v = arms[where, 0], arms[where, 1], near[first, ALONG], near[first, ACROSS]
    arm, seen = math.sqrt(a * a + b * b), math.sqrt(u * u + v * v)
    if abs(arm - seen) > GATHER * tolerance:
        return False
    c, s = (a * u + b * v) / (arm * seen), (a * v - b * u) / (arm * seen)
    for slot in range(len(arms)):
        x, y = c * arms[slot, 0] - s * arms[slot, 1], s * arms[slot, 0] + c * arms[slot, 1]
        filled[slot] = -1
        best = (GATHER * tolerance) ** 2
        for blob in range(count):
            dx, dy = near[blob, ALONG] - x, near[blob, ACROSS] - y
            away = dx * dx + dy * dy
            if away <= best and near[blob, FIRST_LIKENESS + slot] > 0.0 and not _holds(filled, slot, blob):
                best = away
                filled[slot] = blob
    return True


@kernel
def _holds(filled: Indices, slots: int, blob: int) -> bool:
    held = False
    for slot in range(slots):
        held |= filled[slot] == blob
    return held


@kernel
def _write_blobs(near: Floats, filled: Indices, anchor: int, team: int, row: Floats) -> None:
    """Note in a hypothesis which blobs it is made of."""
    row[TEAM], row[ANCHOR], row[MATCHED] = team, anchor, 0
    for slot in range(MOST_SLOTS):
        row[FIRST_SLOT + slot] = near[filled[slot], BLOB] if filled[slot] >= 0 else -1
        row[MATCHED] += filled[slot] >= 0


@kernel
def _is_known(rows: Floats, start: int, count: int) -> bool:
    """Whether the blobs of the last hypothesis have been gathered for the same slots before."""
    for other in range(start, count):
        same = True
        for column in range(FIRST_SLOT, FIRST_SLOT + MOST_SLOTS):
            same &= rows[other, column] == rows[count, column]
        if same:
            return True
    return False


@kernel
def _judge(
    near: Floats, arms: Floats, shares: Floats, tolerance: float, like: float, filled: Indices, row: Floats
) -> None:  # fmt: skip
    """Fit the pose to all patches, leave out what is too far off, and write the score: 0 if nothing is left."""
    row[SCORE], row[STEADY] = 0.0, 0.0
    while True:
        worst = _fit(near, arms, tolerance, filled, row)
        if worst < 0:
            break
        filled[worst] = -1
    number, share, total = 1.0, shares[0], like
    for slot in range(len(arms)):
        if filled[slot] >= 0:
            number += 1.0
            share += shares[1 + slot]
            total += near[filled[slot], FIRST_LIKENESS + slot]
    if number > 1.0:
        row[SCORE] = share * max(1.0 - row[MISFIT] / number, 0.0) * total / number


@kernel
def _fit(near: Floats, arms: Floats, tolerance: float, filled: Indices, row: Floats) -> int:
    """Least-squares pose over the anchor and the gathered patches (Procrustes in the plane: Umeyama, 1991).

    Writes heading, the fitted anchor's place from the seen one's, and the sum of squared residuals in squared
    tolerances; returns the slot whose patch is the farthest beyond the tolerance, -1 if none is.
    """
    number, mean_x, mean_y, model_x, model_y = 1.0, 0.0, 0.0, 0.0, 0.0
    along = across = 0.0
    for slot in range(len(arms)):
        if filled[slot] >= 0:
            a, b, u, v = arms[slot, 0], arms[slot, 1], near[filled[slot], ALONG], near[filled[slot], ACROSS]
            number += 1.0
            mean_x, mean_y, model_x, model_y = mean_x + u, mean_y + v, model_x + a, model_y + b
            along += a * u + b * v
            across += a * v - b * u
    along -= (model_x * mean_x + model_y * mean_y) / number
    across -= (model_x * mean_y - model_y * mean_x) / number
    length = max(math.sqrt(along * along + across * across), 1e-18)
    c, s = along / length, across / length
    x, y = (mean_x - c * model_x + s * model_y) / number, (mean_y - s * model_x - c * model_y) / number
    worst, most, total = -1, tolerance * tolerance, x * x + y * y
    for slot in range(len(arms)):
        if filled[slot] >= 0:
            dx = x + c * arms[slot, 0] - s * arms[slot, 1] - near[filled[slot], ALONG]
            dy = y + s * arms[slot, 0] + c * arms[slot, 1] - near[filled[slot], ACROSS]
            off = dx * dx + dy * dy
            total += off
            if off > most:
                worst, most = slot, off
    row[HEADING], row[X], row[Y], row[MISFIT] = math.atan2(s, c), x, y, total / (tolerance * tolerance)
    return worst


@kernel
def _keep(rows: Floats, start: int, count: int) -> int:
    """Keep the row that was just filled, if need be in place of the worst of its anchor's; how many there are then."""
    if count - start < KEPT:
        return count + 1
    worst = start
    for other in range(start, count):
        if rows[other, SCORE] < rows[worst, SCORE]:
            worst = other
    if rows[count, SCORE] > rows[worst, SCORE]:
        for column in range(ROW_LENGTH):
            rows[worst, column] = rows[count, column]
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
    for slot in range(MOST_SLOTS):
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
