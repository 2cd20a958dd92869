"""Plane geometry of a marker's patches: colored circles and polygons, in robot space, millimetres.

All follows from one function, the signed depth of points in a patch: whether a point lies inside, how far two patches
are apart, whether a turned patch coincides with another one.
"""

import math
from collections.abc import Sequence
from itertools import pairwise
from typing import Protocol, TypeAlias

import numpy as np
from numpy.typing import NDArray

from vision_core.geometry import Floats, rotation

Mask: TypeAlias = NDArray[np.bool_]
Polygon: TypeAlias = Sequence[tuple[float, float]]
"""Corners, of which the last is the first."""

SAME_MM = 2.0
"""Edges nearer than this to each other look like one to a camera."""
GRID_MM, GRID_STEPS = 0.5, 250
"""Distance between sample points inside of patches, and their largest number along a side."""
ON_EDGE_MM = 1e-6
"""A point so near to an edge lies on it."""
RIM_POINTS = 48
"""Points on the edge of a circle."""


class PatchShape(Protocol):
    """A circle (center x, y, diameter) or a closed polygon, exactly one of them, without what lies over it."""

    @property
    def circle_mm(self) -> tuple[float, float, float] | None: ...
    @property
    def polygon_mm(self) -> Polygon | None: ...
    @property
    def hidden_by(self) -> Sequence["PatchShape"]:
        """Patches that lie over it."""
        ...


def area_mm2(shape: PatchShape) -> float:
    """Area of a patch."""
    if shape.hidden_by:
        return len(inner_points_mm(shape)) * _grid_step_mm(shape) ** 2
    if shape.circle_mm is not None:
        return math.pi * (shape.circle_mm[2] / 2.0) ** 2
    return abs(_signed_area(_corners(shape)))


def centroid_mm(shape: PatchShape) -> tuple[float, float]:
    """Center of area of a patch: where its blob's center is."""
    if shape.hidden_by:
        seen_x, seen_y = inner_points_mm(shape).mean(axis=0)
        return float(seen_x), float(seen_y)
    if shape.circle_mm is not None:
        return shape.circle_mm[:2]
    corners = _corners(shape)
    start, end = corners[:-1], corners[1:]
    weights = start[:, 0] * end[:, 1] - end[:, 0] * start[:, 1]
    x, y = ((start + end) * weights[:, None]).sum(axis=0) / (6.0 * _signed_area(corners))
    return float(x), float(y)


def middle_mm(shapes: Sequence[PatchShape]) -> tuple[float, float]:
    """Center of area of all patches together."""
    areas = np.array([area_mm2(shape) for shape in shapes])
    x, y = areas @ np.array([centroid_mm(shape) for shape in shapes]) / areas.sum()
    return float(x), float(y)


def depth_mm(shape: PatchShape, points_mm: Floats) -> Floats:
    """Depth of points, shape (n, 2), in a patch: distance to the nearest edge, negative outside; shape (n,)."""
    depth = _whole_depth_mm(shape, points_mm)
    for cover in shape.hidden_by:
        depth = np.minimum(depth, -_whole_depth_mm(cover, points_mm))
    return depth


def _whole_depth_mm(shape: PatchShape, points_mm: Floats) -> Floats:
    """``depth_mm`` as if nothing lay over the patch."""
    if shape.circle_mm is not None:
        x, y, diameter = shape.circle_mm
        from_center: Floats = np.hypot(points_mm[:, 0] - x, points_mm[:, 1] - y)
        return diameter / 2.0 - from_center
    corners = _corners(shape)
    start, side = corners[:-1], np.diff(corners, axis=0)
    arm = points_mm[:, None] - start
    length2 = np.maximum((side**2).sum(axis=1), 1e-12)
    along = np.clip((arm * side).sum(axis=2) / length2, 0.0, 1.0)
    gap = arm - along[..., None] * side
    edge: Floats = np.hypot(gap[..., 0], gap[..., 1]).min(axis=1)
    return np.where(_inside(corners, points_mm), edge, -edge)


def contains(shape: PatchShape, points_mm: Floats) -> Mask:
    """Which points, shape (n, 2), lie in a patch; shape (n,)."""
    return np.asarray(depth_mm(shape, points_mm) > 0.0)


def rim_mm(shape: PatchShape, step_mm: float = SAME_MM) -> Floats:
    """Points of its edge, corners included, nearer to each other than a step; shape (n, 2)."""
    rims = [_whole_rim_mm(one, step_mm) for one in (shape, *shape.hidden_by)]
    if len(rims) == 1:
        return rims[0]
    points = np.concatenate(rims)
    return points[np.abs(depth_mm(shape, points)) < ON_EDGE_MM]


def _whole_rim_mm(shape: PatchShape, step_mm: float) -> Floats:
    """``rim_mm`` as if nothing lay over the patch."""
    if shape.circle_mm is not None:
        x, y, diameter = shape.circle_mm
        turns = np.arange(RIM_POINTS) * (math.tau / RIM_POINTS)
        return np.array([x, y]) + diameter / 2.0 * np.column_stack([np.cos(turns), np.sin(turns)])
    corners = _corners(shape)
    pieces = []
    for start, end in pairwise(corners):
        count = max(1, math.ceil(math.dist(start, end) / step_mm))
        pieces.append(start + np.arange(count)[:, None] / count * (end - start))
    return np.concatenate(pieces)


def box_mm(shape: PatchShape) -> tuple[Floats, Floats]:
    """Its lower left and upper right corner, shape (2,) each."""
    if shape.circle_mm is not None:
        x, y, diameter = shape.circle_mm
        center = np.array([x, y])
        return center - diameter / 2.0, center + diameter / 2.0
    corners = _corners(shape)
    return corners.min(axis=0), corners.max(axis=0)


def inner_points_mm(shape: PatchShape) -> Floats:
    """An even grid of points in it; shape (n, 2), empty for a sliver."""
    low, high = box_mm(shape)
    step = _grid_step_mm(shape)
    axes = [np.arange(first + step / 2.0, last, step) for first, last in zip(low, high, strict=True)]
    x, y = np.meshgrid(*axes)
    points = np.column_stack([x.ravel(), y.ravel()])
    return points[contains(shape, points)]


def _grid_step_mm(shape: PatchShape) -> float:
    low, high = box_mm(shape)
    return max(GRID_MM, float((high - low).max()) / GRID_STEPS)


def width_mm(shape: PatchShape) -> float:
    """Diameter of the largest disc that fits into it: what a camera must resolve."""
    if shape.circle_mm is not None and not shape.hidden_by:
        return shape.circle_mm[2]
    points = inner_points_mm(shape)
    return 2.0 * float(depth_mm(shape, points).max()) if len(points) else 0.0


def overlap_mm(shape: PatchShape, other: PatchShape) -> float:
    """Width of the overlap of two patches; 0 when they touch or are apart."""
    (low, high), (other_low, other_high) = box_mm(shape), box_mm(other)
    if (high <= other_low).any() or (other_high <= low).any():
        return 0.0
    points = inner_points_mm(shape)
    if not len(points):
        return 0.0
    depth = np.minimum(depth_mm(shape, points), depth_mm(other, points))
    return max(0.0, 2.0 * float(depth.max()))


def gap_mm(shape: PatchShape, other: PatchShape) -> float:
    """Distance between two patches; 0 when they touch."""
    nearest = max(float(depth_mm(shape, rim_mm(other)).max()), float(depth_mm(other, rim_mm(shape)).max()))
    return max(0.0, -nearest)


def reach_mm(shape: PatchShape, outline: str) -> float:
    """Radius of the circle round the robot's center that holds a patch; outline "square": half side of the square."""
    if shape.circle_mm is not None:
        x, y, diameter = shape.circle_mm
        return diameter / 2.0 + (max(abs(x), abs(y)) if outline == "square" else math.hypot(x, y))
    corners = _corners(shape)
    return float(np.abs(corners).max() if outline == "square" else np.hypot(corners[:, 0], corners[:, 1]).max())


def crosses_itself(corners_mm: Polygon) -> bool:
    """Do two sides of a closed polygon meet elsewhere than in their common corner?"""
    sides = list(pairwise(corners_mm))
    for i, side in enumerate(sides):
        for j in range(i + 1, len(sides)):
            neighbors = j == i + 1 or (i == 0 and j == len(sides) - 1)
            if _folds_back(side, sides[j]) if neighbors else _meet(*side, *sides[j]):
                return True
    return False


def turns_onto(shapes: Sequence[PatchShape], others: Sequence[PatchShape]) -> list[tuple[float, list[int]]]:
    """Turns [rad] that lay a set of patches on another one, each with the place of every patch in it; 0 comes first.

    A camera does not see the robot's center, so patches turn round their common center of area. Concentric discs
    coincide after any turn; half a turn then represents all of them.
    """
    middle, other_middle = np.array(middle_mm(shapes)), np.array(middle_mm(others))
    if len(shapes) != len(others):
        return []
    found = []
    for turn in _candidate_turns(shapes, others, middle, other_middle):
        places = [_place_of(shape, turn, middle, others, other_middle) for shape in shapes]
        if None not in places:
            found.append((turn, [place for place in places if place is not None]))
    return found


def turned_mm(points_mm: Floats, turn_rad: float, middle_mm: Floats) -> Floats:
    """Points, shape (n, 2), turned anticlockwise round a center."""
    turned: Floats = (points_mm - middle_mm) @ rotation(turn_rad).T + middle_mm
    return turned


def misfit_mm(shape: PatchShape, other: PatchShape, turn_rad: float, middle: Floats, other_middle: Floats) -> float:
    """Largest distance between the edge of one patch, turned round a point that comes to another one, and another's."""
    shift = other_middle - middle
    there = np.abs(depth_mm(other, turned_mm(rim_mm(shape), turn_rad, middle) + shift)).max()
    back = np.abs(depth_mm(shape, turned_mm(rim_mm(other), -turn_rad, other_middle) - shift)).max()
    return float(max(there, back))


def _candidate_turns(
    shapes: Sequence[PatchShape], others: Sequence[PatchShape], middle: Floats, other_middle: Floats
) -> list[float]:  # fmt: skip
    """Turns that lay some landmark on another one: patch centers, or corners when all patches share one center."""
    landmarks, targets = (
        np.array([centroid_mm(shape) for shape in part]) - center
        for part, center in ((shapes, middle), (others, other_middle))
    )
    if np.hypot(*landmarks.T).max() < SAME_MM:
        corners, goals = (
            [_corners(shape) for shape in part if shape.polygon_mm is not None] for part in (shapes, others)
        )
        if not corners or not goals:
            return [0.0, math.pi]
        landmarks, targets = np.concatenate(corners) - middle, np.concatenate(goals) - other_middle
    first = landmarks[int(np.argmax(np.hypot(*landmarks.T)))]
    radius, radii = math.hypot(*first), np.hypot(*targets.T)
    bearings = np.arctan2(targets[:, 1], targets[:, 0]) - math.atan2(first[1], first[0])
    turns = bearings[np.abs(radii - radius) < SAME_MM] % math.tau
    least = SAME_MM / radius
    return sorted({round(turn, 6) if least < turn < math.tau - least else 0.0 for turn in turns.tolist()})


def _place_of(
    shape: PatchShape, turn: float, middle: Floats, others: Sequence[PatchShape], other_middle: Floats
) -> int | None:  # fmt: skip
    misfits = [misfit_mm(shape, other, turn, middle, other_middle) for other in others]
    best = int(np.argmin(misfits))
    return best if misfits[best] < SAME_MM else None


def _corners(shape: PatchShape) -> Floats:
    assert shape.polygon_mm is not None
    return np.array(shape.polygon_mm, dtype=np.float64)


def _signed_area(corners: Floats) -> float:
    start, end = corners[:-1], corners[1:]
    return float((start[:, 0] * end[:, 1] - end[:, 0] * start[:, 1]).sum() / 2.0)


def _inside(corners: Floats, points: Floats) -> Mask:
    """Which points lie in a polygon: those whose ray to the right crosses an odd number of sides."""
    (x1, y1), (x2, y2) = corners[:-1].T, corners[1:].T
    x, y = points[:, :1], points[:, 1:]
    spans = (y1 > y) != (y2 > y)
    with np.errstate(divide="ignore", invalid="ignore"):
        crossing = x1 + (y - y1) * (x2 - x1) / (y2 - y1)
    return np.asarray((spans & (x < crossing)).sum(axis=1) % 2 == 1)


Point = tuple[float, float]


def _side_of(a: Point, b: Point, c: Point) -> float:
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


def _on(a: Point, b: Point, c: Point) -> bool:
    """Does c, on the line through a and b, lie between them?"""
    return min(a[0], b[0]) <= c[0] <= max(a[0], b[0]) and min(a[1], b[1]) <= c[1] <= max(a[1], b[1])


def _meet(a: Point, b: Point, c: Point, d: Point) -> bool:
    """Do two segments share a point?"""
    ca, cb, ac, ad = _side_of(c, d, a), _side_of(c, d, b), _side_of(a, b, c), _side_of(a, b, d)
    if ca * cb < 0.0 and ac * ad < 0.0:
        return True
    ends = ((ac, a, b, c), (ad, a, b, d), (ca, c, d, a), (cb, c, d, b))
    return any(side == 0.0 and _on(start, end, point) for side, start, end, point in ends)


def _folds_back(side: tuple[Point, Point], following: tuple[Point, Point]) -> bool:
    """Do two sides with a common corner overlap?"""
    (a, b), (c, d) = side, following
    start, corner, end = (a, b, d) if b == c else (b, a, c)
    back = (start[0] - corner[0]) * (end[0] - corner[0]) + (start[1] - corner[1]) * (end[1] - corner[1])
    return _side_of(start, corner, end) == 0.0 and back >= 0.0
