"""From a selected hypothesis to a robot: refine the centers of its patches, fit its pose to all of them, and say how
exact the pose is. Compiled kernels.

The pose is a least-squares fit with the weight 1 / variance for every patch (Procrustes in the plane: Umeyama, 1991).
Its covariance follows from the same weights w at p, the patches' places in the robot relative to their weighted mean:
the heading's variance is 1 / sum(w |p|^2), that of the mean place 1 / sum(w) per axis. The robot's center is off the
mean by an arm, so the heading's variance times the squared arm is added across the arm. The residuals of the fit show
whether the weights were right for this robot, which may be blurred or half in a shadow, and scale all of them. The size
of the marker is free in this: patches that touch lose the seam between them and move outwards, which does no harm.
"""

import math
from typing import Any, TypeAlias

from vision_core.models.camera_kernels import field_from_pixel, pixel_from_field, pixels_per_square_metre
from vision_core.native.angles import wrap_angle
from vision_core.native.kernels import kernel
from vision_core.objects.circle_fit import refined_circle
from vision_core.objects.observation import Observation
from vision_core.objects.robots.buffers import HEADING_BY_SHAPE, NO_SHAPE, FinderBuffers, Gates
from vision_core.objects.robots.markers import Marker
from vision_core.objects.robots.shape_reading import code_of_shapes, is_shape_sure, read_shapes, shape_certainty
from vision_core.objects.robots.shapes import heading_sd
from vision_core.types.tables import NO_ID, Table

Row: TypeAlias = Any
"""One row of a table."""

SHAPE_ROUNDS = 2
"""Times that the heading is fitted again when the shapes are known, whose centers lie a little aside."""
PRIOR_FREEDOM = 4.0
"""Degrees of freedom that the expected weights count for, beside those of the residuals."""


@kernel
def refine_pose(
    seen: Observation, marker: Marker, gates: Gates, buffers: FinderBuffers, hypothesis: Row, ambiguous: bool,
    robot: Row,
) -> None:  # fmt: skip
    """Fill in a robot's team, id, place, heading and their deviations.

    robot: a row of ROBOT. Where the heading is not known the robot is put at its anchor, and its deviation includes the
    anchor's distance from the robot's center.
    """
    if marker.has_shapes:
        read_shapes(seen, marker, hypothesis)
    _refine_centers(seen, marker, gates, buffers, hypothesis)
    # do the matched slots, or the anchor's shape, determine the heading?
    has_shape = hypothesis.shape_evidence != NO_SHAPE
    min_slots = marker.min_slots_with_shape if has_shape else marker.min_slots_for_heading
    enough = hypothesis.matched >= min_slots
    if hypothesis.matched == 0:
        enough = hypothesis.shape_evidence == HEADING_BY_SHAPE
    has_heading = enough and not ambiguous
    robot.team, robot.confidence = marker.team, hypothesis.score
    robot.id = id_of(seen.blobs, marker, hypothesis) if has_heading or not marker.has_code else NO_ID
    if marker.has_shapes and robot.id != NO_ID:
        robot.confidence *= shape_certainty(marker, hypothesis)
    centers = buffers.centers
    if not has_heading:
        offset = math.hypot(marker.anchor_m[0], marker.anchor_m[1])
        robot.x_m, robot.y_m, robot.heading_rad = centers[0, 0], centers[0, 1], math.nan
        robot.position_sd_m = math.sqrt(1.0 / centers[0, 2] + 0.5 * offset * offset)
        robot.heading_sd_rad = math.nan
    elif hypothesis.matched == 0:
        _pose_from_shape(marker, buffers, hypothesis, robot)
    elif marker.has_shapes:
        _fit_with_shapes(marker, buffers, hypothesis, robot)
    else:
        fit_pose(marker, buffers, robot)
    robot.x_px, robot.y_px = pixel_from_field(seen.camera, robot.x_m, robot.y_m, marker.height_m)


@kernel
def _refine_centers(
    seen: Observation, marker: Marker, gates: Gates, buffers: FinderBuffers, hypothesis: Row
) -> None:  # fmt: skip
    """Fill in place and weight of each patch: circles by their edges, other patches by their centroids."""
    scale2 = pixels_per_square_metre(seen.camera, hypothesis.x_m, hypothesis.y_m, marker.height_m)
    scale = math.sqrt(scale2)
    centers = buffers.centers
    for patch in range(1 + len(marker.slots_m)):
        blob = hypothesis.anchor if patch == 0 else hypothesis.slot_blobs[patch - 1]
        centers[patch, 2] = 0.0
        if blob < 0:
            continue
        x, y, min_sd = seen.blobs[blob].x_px, seen.blobs[blob].y_px, gates.polygon_sd_px
        sd = 0.0
        if marker.radii_m[patch] > 0.0:
            x, y, sd = refined_circle(seen.pixels, x, y, marker.radii_m[patch] * scale, buffers.circle)
            min_sd = gates.circle_sd_px
        centers[patch, 0], centers[patch, 1] = field_from_pixel(seen.camera, x, y, marker.height_m)
        centers[patch, 2] = scale2 / (sd * sd + min_sd * min_sd)


@kernel
def id_of(blobs: Table, marker: Marker, hypothesis: Row) -> int:
    """The id whose code a hypothesis shows, NO_ID for none."""
    code = 0
    for slot in range(len(marker.slots_m)):
        if marker.place_values[slot] > 0:
            blob = hypothesis.slot_blobs[slot]
            if blob < 0:
                return NO_ID
            code += marker.place_values[slot] * marker.digits[slot, blobs[blob].color]
    if marker.has_shapes:
        shapes = code_of_shapes(marker, hypothesis)
        if shapes < 0:
            return NO_ID
        code += shapes
    for number in range(len(marker.codes)):
        if marker.codes[number] == code:
            return int(marker.ids[number])
    return NO_ID


@kernel
def _pose_from_shape(marker: Marker, buffers: FinderBuffers, hypothesis: Row, robot: Row) -> None:
    """The pose of a robot of which only the anchor is seen, by the anchor's place and shape."""
    x, y, variance = buffers.centers[0, 0], buffers.centers[0, 1], 1.0 / buffers.centers[0, 2]
    a, b = marker.anchor_m[0], marker.anchor_m[1]
    c, s = math.cos(hypothesis.heading_rad), math.sin(hypothesis.heading_rad)
    turn_sd = heading_sd(hypothesis.heading_stiffness_m, math.sqrt(variance))
    robot.x_m, robot.y_m = x - c * a + s * b, y - s * a - c * b
    robot.heading_rad = wrap_angle(hypothesis.heading_rad)
    robot.position_sd_m = math.sqrt(variance + 0.5 * turn_sd * turn_sd * (a * a + b * b))
    robot.heading_sd_rad = turn_sd


@kernel
def fit_pose(marker: Marker, buffers: FinderBuffers, robot: Row) -> None:
    """The pose of a robot from all of its patches, weighted."""
    centers, slots = buffers.centers, marker.slots_m
    # weighted means of the seen places and of the marker's
    weight = mean_x = mean_y = model_x = model_y = 0.0
    for patch in range(1 + len(slots)):
        at_x, at_y = place_in_robot(marker, patch)
        w = centers[patch, 2]
        weight += w
        mean_x, mean_y = mean_x + w * centers[patch, 0], mean_y + w * centers[patch, 1]
        model_x, model_y = model_x + w * at_x, model_y + w * at_y
    mean_x, mean_y, model_x, model_y = mean_x / weight, mean_y / weight, model_x / weight, model_y / weight
    # cross-covariance about the means: its direction is the heading
    along = across = inertia = spread = freedom = 0.0
    for patch in range(1 + len(slots)):
        at_x, at_y = place_in_robot(marker, patch)
        w, a, b = centers[patch, 2], at_x - model_x, at_y - model_y
        if w > 0.0:
            u, v = centers[patch, 0] - mean_x, centers[patch, 1] - mean_y
            along += w * (a * u + b * v)
            across += w * (a * v - b * u)
            inertia += w * (a * a + b * b)
            spread += w * (u * u + v * v)
            freedom += 2.0
    heading = math.atan2(across, along)
    c, s = math.cos(heading), math.sin(heading)
    robot.x_m, robot.y_m = mean_x - c * model_x + s * model_y, mean_y - s * model_x - c * model_y
    robot.heading_rad = wrap_angle(heading)
    # the residuals, with the size free, scale the covariance
    residuals = max(spread - (along * along + across * across) / inertia, 0.0)
    scale = (PRIOR_FREEDOM + residuals) / (PRIOR_FREEDOM + freedom - 4.0)
    arm2 = model_x * model_x + model_y * model_y
    robot.position_sd_m = math.sqrt(scale * (1.0 / weight + 0.5 * arm2 / inertia))
    robot.heading_sd_rad = math.sqrt(scale / inertia)


@kernel
def place_in_robot(marker: Marker, patch: int) -> tuple[float, float]:
    """Where a patch is in the robot [m]; patch 0 is the anchor."""
    if patch == 0:
        return marker.anchor_m[0], marker.anchor_m[1]
    return marker.slots_m[patch - 1, 0], marker.slots_m[patch - 1, 1]


@kernel
def _fit_with_shapes(marker: Marker, buffers: FinderBuffers, hypothesis: Row, robot: Row) -> None:
    """The pose of a robot whose patches have some of the code's shapes, each of which has a center of its own."""
    fit_pose(marker, buffers, robot)
    for _ in range(SHAPE_ROUNDS):
        heading = robot.heading_rad
        _shift_centers(marker, buffers, hypothesis, heading, -1.0)
        fit_pose(marker, buffers, robot)
        _shift_centers(marker, buffers, hypothesis, heading, 1.0)


@kernel
def _shift_centers(marker: Marker, buffers: FinderBuffers, hypothesis: Row, heading: float, share: float) -> None:
    """Shift the seen centers of patches in the code's shapes by a share of these shapes' offsets, at a heading."""
    details, c, s = marker.details.value, math.cos(heading), math.sin(heading)
    for slot in range(len(details.shape_values)):
        if details.shape_values[slot] > 0 and is_shape_sure(hypothesis, slot):
            offset = details.code_shapes.offsets_m[hypothesis.shapes[slot]]
            a, b = offset[0], offset[1]
            buffers.centers[1 + slot, 0] += share * (c * a - s * b)
            buffers.centers[1 + slot, 1] += share * (s * a + c * b)
