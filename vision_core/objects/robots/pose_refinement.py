"""From a winning hypothesis to a robot: its patches' centers refined, its pose fitted to all of them, and how well
that is known. Compiled kernels.

A pose is fitted by least squares with the weight 1 / variance for every patch (Procrustes in the plane: Umeyama,
1991). Its covariance follows from the same weights w at p, the patches' places in the robot round their weighted mean:
the heading's variance is 1 / sum(w |p|^2), the mean place's 1 / sum(w) per axis, and the robot's center, off the
mean by an arm, gets the heading's variance times the arm's square across it. What is left over after the fit says
whether the weights were right for this robot, blurred or half in a shadow as it may be, and scales all of them; but
for the size, which is free in this: patches that touch lose their seams, their centers move outwards, and no harm is
done.
"""

import math
from typing import Any

from vision_core.geometry import Bytes, Floats
from vision_core.models.camera_kernels import CameraMap, field_from_pixel, pixel_from_field, pixels_per_square_metre
from vision_core.native.kernels import kernel
from vision_core.objects.circle_fit import refined_circle
from vision_core.objects.robots.buffers import (
    ANCHOR,
    FIRST_SLOT,
    HEADING,
    MATCHED,
    SCORE,
    SHAPED,
    STEADY,
    Gates,
    Memory,
    X,
    Y,
)
from vision_core.objects.robots.markers import Marker
from vision_core.objects.robots.shapes import heading_sd
from vision_core.types.tables import NO_ID, Table

PRIOR = 4.0
"""What is known of the weights beforehand counts as so many degrees of freedom."""


@kernel
def refine_pose(
    blobs: Table, pixels: Bytes, camera: CameraMap, marker: Marker, gates: Gates, memory: Memory, row: Floats,
    ambiguous: bool, robot: Any,
) -> None:  # fmt: skip
    """Fill in a robot's team, id, place, heading and deviations.

    robot: one row. Where only the anchor is known for sure, the robot is put at the anchor, and its deviation says
    how far off its center that may be.
    """
    _refine_centers(blobs, pixels, camera, marker, gates, memory, row)
    enough = marker.enough_shaped if row[SHAPED] > 0 else marker.enough
    told = not ambiguous and (row[MATCHED] >= enough if row[MATCHED] > 0 else row[SHAPED] == 2)
    robot.team, robot.confidence = marker.team, row[SCORE]
    robot.id = code_of(blobs, marker, row) if told or not marker.coded else NO_ID
    centers = memory.centers
    if not told:
        offset = math.hypot(marker.anchor_m[0], marker.anchor_m[1])
        robot.x_m, robot.y_m, robot.heading_rad = centers[0, 0], centers[0, 1], math.nan
        robot.position_sd_m = math.sqrt(1.0 / centers[0, 2] + 0.5 * offset * offset)
        robot.heading_sd_rad = math.nan
    elif row[MATCHED] == 0:
        _pose_by_shape(marker, memory, row, robot)
    else:
        _fit(marker, memory, robot)
    robot.x_px, robot.y_px = pixel_from_field(camera, robot.x_m, robot.y_m, marker.height_m)


@kernel
def _refine_centers(
    blobs: Table, pixels: Bytes, camera: CameraMap, marker: Marker, gates: Gates, memory: Memory, row: Floats
) -> None:
    scale2 = pixels_per_square_metre(camera, row[X], row[Y], marker.height_m)
    scale = math.sqrt(scale2)
    for patch in range(1 + len(marker.slots_m)):
        blob = int(row[ANCHOR] if patch == 0 else row[FIRST_SLOT + patch - 1])
        memory.centers[patch, 2] = 0.0
        if blob < 0:
            continue
        x, y, floor = blobs[blob].x_px, blobs[blob].y_px, gates.edge_floor_px
        sd = 0.0
        if marker.radii_m[patch] > 0.0:
            x, y, sd = refined_circle(pixels, x, y, marker.radii_m[patch] * scale, memory.rim)
            floor = gates.center_floor_px
        memory.centers[patch, 0], memory.centers[patch, 1] = field_from_pixel(camera, x, y, marker.height_m)
        memory.centers[patch, 2] = scale2 / (sd * sd + floor * floor)


@kernel
def code_of(blobs: Table, marker: Marker, row: Floats) -> int:
    """The id whose code a hypothesis shows, NO_ID for none."""
    code = 0
    for slot in range(len(marker.slots_m)):
        if marker.places[slot] > 0:
            blob = int(row[FIRST_SLOT + slot])
            if blob < 0:
                return NO_ID
            code += marker.places[slot] * marker.digits[slot, blobs[blob].color]
    for number in range(len(marker.codes)):
        if marker.codes[number] == code:
            return int(marker.ids[number])
    return NO_ID


@kernel
def _pose_by_shape(marker: Marker, memory: Memory, row: Floats, robot: Any) -> None:
    """A robot whose anchor alone tells where it is and which way it points."""
    x, y, variance = memory.centers[0, 0], memory.centers[0, 1], 1.0 / memory.centers[0, 2]
    a, b = marker.anchor_m[0], marker.anchor_m[1]
    c, s = math.cos(row[HEADING]), math.sin(row[HEADING])
    turn_sd = heading_sd(row[STEADY], math.sqrt(variance))
    robot.x_m, robot.y_m = x - c * a + s * b, y - s * a - c * b
    robot.heading_rad = _wrapped(row[HEADING])
    robot.position_sd_m = math.sqrt(variance + 0.5 * turn_sd * turn_sd * (a * a + b * b))
    robot.heading_sd_rad = turn_sd


@kernel
def _fit(marker: Marker, memory: Memory, robot: Any) -> None:
    """A robot's pose from all of its patches, by their weights."""
    centers, slots = memory.centers, marker.slots_m
    weight = mean_x = mean_y = model_x = model_y = 0.0
    for patch in range(1 + len(slots)):
        at_x, at_y = _place_of(marker, patch)
        w = centers[patch, 2]
        weight += w
        mean_x, mean_y = mean_x + w * centers[patch, 0], mean_y + w * centers[patch, 1]
        model_x, model_y = model_x + w * at_x, model_y + w * at_y
    mean_x, mean_y, model_x, model_y = mean_x / weight, mean_y / weight, model_x / weight, model_y / weight
    along = across = inertia = spread = freedom = 0.0
    for patch in range(1 + len(slots)):
        at_x, at_y = _place_of(marker, patch)
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
    robot.heading_rad = _wrapped(heading)
    left_over = max(spread - (along * along + across * across) / inertia, 0.0)
    scale = (PRIOR + left_over) / (PRIOR + freedom - 4.0)
    arm2 = model_x * model_x + model_y * model_y
    robot.position_sd_m = math.sqrt(scale * (1.0 / weight + 0.5 * arm2 / inertia))
    robot.heading_sd_rad = math.sqrt(scale / inertia)


@kernel
def _place_of(marker: Marker, patch: int) -> tuple[float, float]:
    """Where a patch is in the robot [m]; the anchor is the first."""
    if patch == 0:
        return marker.anchor_m[0], marker.anchor_m[1]
    return marker.slots_m[patch - 1, 0], marker.slots_m[patch - 1, 1]


@kernel
def _wrapped(angle_rad: float) -> float:
    return (angle_rad + math.pi) % (2.0 * math.pi) - math.pi
