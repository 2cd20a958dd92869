"""Points all over a robot's top, and the patch that each lies in: what ``marker_weighing`` looks at."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from vision_core.geometry import Floats
from vision_core.patterns.geometry import depth_mm
from vision_core.patterns.pattern import Pattern

SIDE = 15
"""Points along a side."""
EDGE_SHARE = 0.035
"""Points nearer to an edge of a patch than this share of the robot's radius are left out."""
GROUND = -1
"""What lies in no patch."""


def body_points_of(pattern: Pattern, order: Sequence[int]) -> tuple[Floats, NDArray[np.int64]]:
    """Points [m], shape (p, 2), and for each the place of its patch in an order of the patches, or GROUND."""
    size = 1e3 * pattern.robot.radius_m
    axis = (np.arange(SIDE) + 0.5) / SIDE * 2.0 * size - size
    x, y = np.meshgrid(axis, axis)
    points = np.column_stack([x.ravel(), y.ravel()])
    if pattern.robot.outline == "circle":
        points = points[np.hypot(*points.T) < size]
    labels, is_clear = np.full(len(points), GROUND, dtype=np.int64), np.ones(len(points), dtype=np.bool_)
    for place, index in enumerate(order):
        patch = pattern.patches[index]
        depths = np.array([depth_mm(shape, points) for shape in patch.shapes or (patch,)])
        # in each of the shapes that it may have, or in none of them
        is_in, is_out = (depths > EDGE_SHARE * size).all(axis=0), (depths < -EDGE_SHARE * size).all(axis=0)
        is_clear &= is_in | is_out
        labels[is_in] = place
    return points[is_clear] / 1e3, labels[is_clear]
