"""Hypotheses: ways to see a robot of a team at each blob of the team's color. Compiled kernels."""

import math
from typing import Any, TypeAlias

from vision_core.geometry import Floats
from vision_core.models.camera_kernels import field_and_scale, field_steps
from vision_core.native.kernels import kernel
from vision_core.objects.field_limits import is_accepted
from vision_core.objects.observation import Observation
from vision_core.objects.robots.buffers import (
    GRID_CELLS,
    HEADING_BY_SHAPE,
    MAX_HYPOTHESES,
    MAX_NEIGHBORS,
    MAX_SLOTS,
    NO_BLOB,
    NO_SHAPE,
    SHAPE_MEASURED,
    FinderBuffers,
    Gates,
)
from vision_core.objects.robots.markers import ANCHOR_ROLE, NO_DIGIT, SLOT_ROLE, Marker
from vision_core.objects.robots.pose_fit import (
    GATHER_TOLERANCES,
    assign_blobs,
    fit_and_score,
    is_duplicate,
    keep_best,
    record_blobs,
)
from vision_core.objects.robots.shapes import aspect_score, heading_from_shape, heading_score, measure_shape

Row: TypeAlias = Any
"""One row of a table."""

SHAPE_WEIGHT = 0.4
"""Part of a hypothesis' score that its anchor's shape decides."""

EXCLUSION, EXCLUSION_WHOLE = 0.8, 0.55
"""Exclusion radius as a share of the robot's radius: two robots cannot be nearer than the sum of theirs. It is smaller
for complete markers, whose bodies may be narrower than the outline in the settings."""

ANCHOR_ONLY = 0.999
"""The score of an anchor alone is at most this share of the worst hypothesis with more patches."""

MIN_SHAPE_SCORE, MAX_ALTERNATIVE = 0.75, 0.75
"""An anchor's shape determines the heading when it scores so well, and every clearly different heading at most this
share of it."""


@kernel
def locate_blobs(seen: Observation, marker: Marker, gates: Gates, buffers: FinderBuffers) -> int:
    """List the blobs that may belong to a robot with a marker with their places on the field; how many there are.

    Those that may fill a slot go into the grid, too.
    """
    places, heads = buffers.places[marker.number], buffers.cell_heads
    cell = _max_reach_m(marker, gates)
    listed = 0
    for blob in range(seen.blob_count):
        role = marker.color_roles[seen.blobs[blob].color]
        if role == 0:
            continue
        # reject by place and area, in field units
        x, y, scale2 = field_and_scale(seen.camera, seen.blobs[blob].x_px, seen.blobs[blob].y_px, marker.height_m)
        if not is_accepted(x, y, marker.radius_m, gates.extents_m):
            continue
        area = seen.blobs[blob].area_px / scale2
        if not area >= gates.min_area * marker.min_area_m2:
            continue
        if listed == 0:
            heads.fill(NO_BLOB)
        places[blob, 0], places[blob, 1], places[blob, 2] = x, y, area
        buffers.listed[listed] = blob
        listed += 1
        # each cell of the grid is a linked list of blobs
        if role & SLOT_ROLE:
            column, row = _grid_cell(x, cell), _grid_cell(y, cell)
            buffers.next_in_cell[blob] = heads[row, column]
            heads[row, column] = blob
    return listed


@kernel
def _max_reach_m(marker: Marker, gates: Gates) -> float:
    """How far from the anchor a patch may be; the side of a grid cell."""
    farthest: float = marker.reach_m[1] + GATHER_TOLERANCES * gates.tolerance_m
    return farthest


@kernel
def _grid_cell(place_m: float, cell_m: float) -> int:
    """Index of the cell along one axis; the grid repeats, so it covers any field."""
    return math.floor(place_m / cell_m) % GRID_CELLS


@kernel
def area_score(ratio: float, gates: Gates) -> float:
    """How near an area is to the predicted one, 0..1: the root of the smaller over the larger; 0 beyond the gates.

    ratio: of the area to the predicted one.
    """
    if not gates.min_area <= ratio <= gates.max_area:
        return 0.0
    return math.sqrt(min(ratio, 1.0 / ratio))


@kernel
def slot_area_ratio(areas_m2: Floats, slot: int, area_m2: float) -> float:
    """An area over that of a slot's patch; 1 within the areas of the shapes that the patch may have.

    areas_m2: of a Marker.
    """
    ratio: float = area_m2 / min(max(area_m2, areas_m2[slot, 0]), areas_m2[slot, 1])
    return ratio


@kernel
def generate_hypotheses(
    seen: Observation, listed: int, marker: Marker, gates: Gates, buffers: FinderBuffers, count: int
) -> int:
    """Append the hypotheses of a marker to the first ``count``; the new count.

    The score is the coverage of the marker's painted area * (1 - (rms residual / tolerance)^2) * mean area score * how
    well the anchor's shape agrees with the heading. listed: result of ``locate_blobs``.
    """
    places, hypotheses, assigned = buffers.places[marker.number], buffers.hypotheses, buffers.assigned
    anchor_shape = buffers.anchor_shape[0]
    for slot in range(MAX_SLOTS):
        assigned[slot] = NO_BLOB
    needs_shape = marker.has_direction or marker.area_fractions[0] >= gates.min_confidence
    for k in range(listed):
        # every listed blob of the team's color and of about the right area is an anchor
        anchor = buffers.listed[k]
        anchor_score = area_score(places[anchor, 2] / marker.anchor_area_m2, gates)
        if anchor_score == 0.0 or not marker.color_roles[seen.blobs[anchor].color] & ANCHOR_ROLE:
            continue
        has_shape = needs_shape and _measure_anchor_shape(seen, anchor, marker.height_m, anchor_shape)
        near = gather_neighbors(seen, anchor, marker, gates, buffers) if len(marker.slot_offsets_m) else 0
        start = count
        # every pair of a neighbor and a slot fixes a heading
        for first in range(near):
            for slot in range(len(marker.slot_offsets_m)):
                if count + 2 > MAX_HYPOTHESES:
                    return count
                hypothesis = hypotheses[count]
                if not assign_blobs(
                    buffers.neighbors, near, marker.slot_offsets_m, gates.tolerance_m, first, slot, assigned
                ):
                    continue
                record_blobs(buffers.neighbors, assigned, anchor, marker.team, marker.number, hypothesis)
                if is_duplicate(hypotheses, start, count):
                    continue
                fit_and_score(
                    buffers.neighbors, marker.slot_offsets_m, marker.area_fractions, gates.tolerance_m, anchor_score,
                    assigned, hypothesis,
                )  # fmt: skip
                record_blobs(buffers.neighbors, assigned, anchor, marker.team, marker.number, hypothesis)
                if hypothesis.score >= gates.min_confidence:
                    # from the anchor's place to the robot's center
                    c, s = math.cos(hypothesis.heading_rad), math.sin(hypothesis.heading_rad)
                    hypothesis.x_m += places[anchor, 0] - c * marker.anchor_m[0] + s * marker.anchor_m[1]
                    hypothesis.y_m += places[anchor, 1] - s * marker.anchor_m[0] - c * marker.anchor_m[1]
                    whole = hypothesis.matched == len(marker.slot_offsets_m)
                    hypothesis.exclusion_radius_m = (EXCLUSION_WHOLE if whole else EXCLUSION) * marker.radius_m
                    hypothesis.shape_evidence = SHAPE_MEASURED if has_shape else NO_SHAPE
                    if has_shape:
                        agreement = heading_score(marker.shape, anchor_shape, hypothesis.heading_rad)
                        hypothesis.score *= 1.0 - SHAPE_WEIGHT * (1.0 - agreement)
                    count = keep_best(hypotheses, start, count)
        if marker.area_fractions[0] * anchor_score >= gates.min_confidence:
            count += _add_anchor_only(anchor, anchor_score, has_shape, marker, gates, buffers, start, count)
    return count


@kernel
def _measure_anchor_shape(seen: Observation, anchor: int, height_m: float, shape: Row) -> bool:
    """Measure the shape of an anchor blob; False if it cannot be measured."""
    blob = seen.blobs[anchor]
    step = field_steps(seen.camera, blob.x_px, blob.y_px, height_m)
    box = (blob.left, blob.top, blob.right, blob.bottom)
    return measure_shape(seen.pixels, seen.classes, blob.color, blob.area_px, box, step, shape)


@kernel
def gather_neighbors(seen: Observation, anchor: int, marker: Marker, gates: Gates, buffers: FinderBuffers) -> int:
    """List the blobs round an anchor that may fill a slot in ``buffers.neighbors``; how many there are."""
    places, neighbors, cell = buffers.places[marker.number], buffers.neighbors, _max_reach_m(marker, gates)
    x, y = places[anchor, 0], places[anchor, 1]
    nearest = max(marker.reach_m[0] - GATHER_TOLERANCES * gates.tolerance_m, 0.0)
    column, row = _grid_cell(x, cell), _grid_cell(y, cell)
    count = 0
    # the anchor's cell and the eight round it hold everything in reach
    for cell_row in range(row - 1, row + 2):
        for cell_column in range(column - 1, column + 2):
            blob = buffers.cell_heads[cell_row % GRID_CELLS, cell_column % GRID_CELLS]
            while blob >= 0:
                dx, dy = places[blob, 0] - x, places[blob, 1] - y
                if nearest**2 <= dx * dx + dy * dy <= cell**2 and blob != anchor and count < MAX_NEIGHBORS:
                    neighbor = neighbors[count]
                    neighbor.blob, neighbor.x_m, neighbor.y_m = blob, dx, dy
                    # by its color and area, which slots may it fill?
                    useful = False
                    for slot in range(len(marker.slots_m)):
                        score = 0.0
                        if marker.digits[slot, seen.blobs[blob].color] != NO_DIGIT:
                            score = area_score(slot_area_ratio(marker.areas_m2, slot, places[blob, 2]), gates)
                        neighbor.area_scores[slot] = score
                        useful |= score > 0.0
                    count += useful
                blob = buffers.next_in_cell[blob]
    return count


@kernel
def _add_anchor_only(
    anchor: int, anchor_score: float, has_shape: bool, marker: Marker, gates: Gates, buffers: FinderBuffers,
    start: int, count: int,
) -> int:  # fmt: skip
    """Write the hypothesis of an anchor without other patches into row ``count``; 1 if it may be a robot, else 0.

    Its score is lower than that of every other hypothesis of the same anchor, start..count.
    """
    limit = 1.0
    for other in range(start, count):
        limit = min(limit, ANCHOR_ONLY * buffers.hypotheses[other].score)
    hypothesis, shape = buffers.hypotheses[count], buffers.anchor_shape[0]
    score = marker.area_fractions[0] * anchor_score * (aspect_score(marker.shape, shape) if has_shape else 1.0)
    hypothesis.score = min(limit, score)
    if score < gates.min_confidence:
        return 0
    hypothesis.team, hypothesis.anchor, hypothesis.matched = marker.team, anchor, 0
    hypothesis.marker = marker.number
    hypothesis.shape_evidence = SHAPE_MEASURED if has_shape else NO_SHAPE
    hypothesis.heading_stiffness_m, hypothesis.heading_rad = 0.0, 0.0
    for slot in range(MAX_SLOTS):
        hypothesis.slot_blobs[slot] = NO_BLOB
    # without a heading the robot is taken to be at its anchor
    offset = math.hypot(marker.anchor_m[0], marker.anchor_m[1])
    hypothesis.exclusion_radius_m = max(EXCLUSION * marker.radius_m - offset, 0.0)
    hypothesis.x_m, hypothesis.y_m = buffers.places[marker.number, anchor, 0], buffers.places[marker.number, anchor, 1]
    # where the anchor's shape shows the heading, the robot's center follows from it
    if has_shape and marker.min_slots_with_shape == 0:
        heading, best, alternative = heading_from_shape(marker.shape, shape)
        if best >= MIN_SHAPE_SCORE and alternative <= MAX_ALTERNATIVE * best:
            c, s = math.cos(heading), math.sin(heading)
            hypothesis.heading_rad, hypothesis.shape_evidence = heading, HEADING_BY_SHAPE
            hypothesis.heading_stiffness_m = shape.heading_stiffness_m
            exclusion = EXCLUSION if len(marker.slot_offsets_m) else EXCLUSION_WHOLE
            hypothesis.exclusion_radius_m = exclusion * marker.radius_m
            hypothesis.x_m -= c * marker.anchor_m[0] - s * marker.anchor_m[1]
            hypothesis.y_m -= s * marker.anchor_m[0] + c * marker.anchor_m[1]
    return 1
