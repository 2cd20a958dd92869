"""The shapes that tell a letter of an id, as the hot path needs them: how deep every point of a grid lies in each."""

import math
from collections.abc import Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from vision_core.geometry import Floats, frozen
from vision_core.patterns.geometry import area_mm2, centroid_mm, depth_mm, reach_mm
from vision_core.patterns.pattern import Patch, Pattern

GRID = 48
"""Points of the grid along a side."""
RIM_SHARE = 0.35
"""The grid reaches beyond the shapes by this share of their reach: there the ground is looked at."""


class CodeShapes(NamedTuple):
    """The shapes of a pattern's code. Kernels take them as one argument."""

    depths_m: Floats
    """Depth of the grid's points in every shape, negative outside; shape (k, GRID, GRID), along y, then x."""
    free_m: Floats
    """Distance of the same points, about each slot, to the nearest other patch and to the robot's outline, negative in
    or beyond them; shape (s, GRID, GRID)."""
    offsets_m: Floats
    """Of each shape's center of area from the slot's place, which is their mean; shape (k, 2)."""
    areas_m2: Floats
    """Shape (k,)."""
    rims_m: Floats
    """How long their edges are, shape (k,)."""
    half_m: float
    """Half of the grid's side; its middle is the slot's place."""


def code_shapes(pattern: Pattern, slots: Sequence[int]) -> CodeShapes:
    """The shapes of a pattern. slots: the patches beside the team's, by their number."""
    shaped = [index for index in slots if pattern.patches[index].shapes]
    if not shaped:
        nothing = frozen(np.zeros((0, 1, 1)))
        return CodeShapes(nothing, nothing, frozen(np.zeros((0, 2))), frozen(np.zeros(0)), frozen(np.zeros(0)), 0.0)
    place, shapes = _place_mm(pattern.patches[shaped[0]]), pattern.patches[shaped[0]].shapes
    # every patch with shapes has the same ones about its place
    around = [_about(shape, place) for shape in shapes]
    half = (1.0 + RIM_SHARE) * max(reach_mm(shape, "square") for shape in around)
    axis = np.linspace(-half, half, GRID)
    x, y = np.meshgrid(axis, axis)
    points = np.column_stack([x.ravel(), y.ravel()])
    depths = np.array([depth_mm(shape, points).reshape(GRID, GRID) for shape in around])
    free = [_free_mm(pattern, index, points).reshape(GRID, GRID) for index in slots]
    return CodeShapes(
        depths_m=frozen(depths / 1e3),
        free_m=frozen(np.array(free) / 1e3),
        offsets_m=frozen(np.array([centroid_mm(shape) for shape in around]) / 1e3),
        areas_m2=frozen(np.array([area_mm2(shape) for shape in around]) / 1e6),
        rims_m=frozen(np.array([_rim_length_mm(shape) for shape in around]) / 1e3),
        half_m=half / 1e3,
    )


def _place_mm(patch: Patch) -> Floats:
    return np.array(centroid_mm(patch))


def _rim_length_mm(patch: Patch) -> float:
    if patch.circle_mm is not None:
        return math.pi * patch.circle_mm[2]
    return sum(math.dist(start, end) for start, end in pairwise(patch.polygon_mm or ()))


def _about(patch: Patch, place: Floats) -> Patch:
    """A patch as seen from a place."""
    x, y = place.tolist()
    if patch.circle_mm is not None:
        return Patch(color=patch.color, circle_mm=(patch.circle_mm[0] - x, patch.circle_mm[1] - y, patch.circle_mm[2]))
    corners = tuple((a - x, b - y) for a, b in patch.polygon_mm or ())
    return Patch(color=patch.color, polygon_mm=corners)


def _free_mm(pattern: Pattern, slot: int, points: Floats) -> Floats:
    """Distance of points about a slot to what is not its ground: other patches, and the robot's outline."""
    there = points + _place_mm(pattern.patches[slot])
    size = 1e3 * pattern.robot.radius_m
    inside = np.abs(there).max(axis=1) if pattern.robot.outline == "square" else np.hypot(*there.T)
    free: Floats = size - inside
    for index, patch in enumerate(pattern.patches):
        for drawn in (patch.shapes or (patch,)) if index != slot else ():
            free = np.minimum(free, -depth_mm(drawn, there))
    return free
