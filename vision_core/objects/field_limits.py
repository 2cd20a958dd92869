"""Where robots and balls are accepted: on the field with its margin, and in the goals. Shared by both finders."""

import numpy as np

from vision_core.geometry import Floats, frozen
from vision_core.models.field import accepted_half_extent, goal_line_x
from vision_core.native.kernels import kernel
from vision_core.settings.schema import FieldSettings


def accepted_extents(field: FieldSettings, margin_m: float = 0.0) -> Floats:
    """Half extents x, y of the accepted field, then x, y of the field with its goals [m]; shape (4,).

    margin_m: added on every side.
    """
    x, y = accepted_half_extent(field)
    goal_x, goal_y = goal_line_x(field) + field.goal.depth_m, field.goal.width_m / 2.0
    return frozen(np.array([x + margin_m, y + margin_m, goal_x + margin_m, goal_y + margin_m]))


@kernel
def is_accepted(x_m: float, y_m: float, tolerance_m: float, extents_m: Floats) -> bool:
    """Whether a place is at most a tolerance outside of the accepted field or of a goal; False for nan."""
    x, y = abs(x_m) - tolerance_m, abs(y_m) - tolerance_m
    accepted: bool = (x <= extents_m[0] and y <= extents_m[1]) or (x <= extents_m[2] and y <= extents_m[3])
    return accepted
