"""A pattern as regions of one color each: what a marker is before any color has a name."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from vision_core.geometry import Floats, frozen
from vision_core.patterns.geometry import depth_mm, inner_points_mm, rim_mm
from vision_core.patterns.pattern import TEAM, Pattern

NEUTRAL = ("white", "pale")
"""Paints without a hue."""
POINTS = 12
"""Per region."""
INNER_DEPTH = 0.4
"""How deep in its patch a point lies at least, as a share of the patch's depth."""
BETWEEN_SHARE = 0.15
"""What lies between the patches is a region of its own where it takes at least this share of their common hull."""
BETWEEN_MM = 5.0
"""Its points are this far from the patches."""
AROUND = 1.12, 1.3
"""Where the surroundings are looked at: multiples of the distance from the middle to the hull."""
GRID = 61
"""Points per side of the grid between patches."""


class Template(NamedTuple):
    """The regions of a pattern, in the robot: x forward, y left. Kernels take it as one argument."""

    points_m: Floats
    """Points well inside of each region: the team's patch, the other patches in their order, what lies between them,
    what lies around them; shape (patches + 2, POINTS, 2)."""
    tinted: NDArray[np.bool_]
    """Which patches differ from the floor by their hue; white and pale ones differ by their brightness; (patches,)."""
    patches: int
    has_between: bool
    """Is there anything between the patches? Otherwise its points are those around."""
    size_m: float
    """Diameter of the circle round the patches' middle that holds all of them."""
    smallest_m: float
    """Twice the depth of the smallest patch."""


def template_of(pattern: Pattern) -> Template:
    """The template of a pattern."""
    anchor = next(index for index, patch in enumerate(pattern.patches) if patch.color == TEAM)
    order = [anchor, *(index for index in range(len(pattern.patches)) if index != anchor)]
    patches = [pattern.patches[index] for index in order]
    rng = np.random.default_rng(1)
    regions, depths = [], []
    for patch in patches:
        points = inner_points_mm(patch)
        depth = depth_mm(patch, points)
        depths.append(float(depth.max()))
        regions.append(_chosen(points[depth >= INNER_DEPTH * depth.max()], rng))
    hull = _hull(np.concatenate([rim_mm(patch) for patch in patches]))
    low, high = hull.min(axis=0), hull.max(axis=0)
    x, y = np.meshgrid(np.linspace(low[0], high[0], GRID), np.linspace(low[1], high[1], GRID))
    grid = np.column_stack([x.ravel(), y.ravel()])
    grid = grid[_in_hull(hull, grid)]
    depth = np.max([depth_mm(patch, grid) for patch in patches], axis=0)
    between = grid[depth < -BETWEEN_MM]
    has_between = len(between) >= BETWEEN_SHARE * len(grid)
    around = _around(hull)
    regions += [_chosen(between, rng) if has_between else around, around]
    middle = (low + high) / 2.0
    reach = float(np.hypot(*(hull - middle).T).max())
    return Template(
        frozen(np.array(regions) / 1000.0), frozen(np.array([patch.color not in NEUTRAL for patch in patches])),
        len(patches), has_between, 2.0 * reach / 1000.0,
        2.0 * min(depths) / 1000.0,
    )  # fmt: skip


def _chosen(points: Floats, rng: np.random.Generator) -> Floats:
    """POINTS of the points, spread: each is the farthest from those chosen before it."""
    chosen = [int(rng.integers(len(points)))]
    away = np.full(len(points), math.inf)
    while len(chosen) < POINTS:
        away = np.minimum(away, np.hypot(*(points - points[chosen[-1]]).T))
        chosen.append(int(away.argmax()))
    return points[chosen]


def _around(hull: Floats) -> Floats:
    """POINTS outside of a hull, evenly round it."""
    middle = (hull.min(axis=0) + hull.max(axis=0)) / 2.0
    turns = np.arange(POINTS) * (math.tau / POINTS)
    found = []
    for number, turn in enumerate(turns):
        ahead = np.array([math.cos(turn), math.sin(turn)])
        edge = max(float(((hull - middle) @ ahead).max()), 1.0)
        found.append(middle + AROUND[number % 2] * edge * ahead)
    return np.array(found)


def _hull(points: Floats) -> Floats:
    """The corners of the convex hull, anticlockwise (A. M. Andrew's monotone chain, 1979)."""
    ordered = sorted(map(tuple, points.tolist()))

    def chain(sequence: list[tuple[float, ...]]) -> list[tuple[float, ...]]:
        kept: list[tuple[float, ...]] = []
        for x, y in sequence:
            while len(kept) > 1 and _turn(kept[-2], kept[-1], (x, y)) <= 0.0:
                kept.pop()
            kept.append((x, y))
        return kept[:-1]

    return np.array([*chain(ordered), *chain(ordered[::-1])])


def _turn(a: tuple[float, ...], b: tuple[float, ...], c: tuple[float, ...]) -> float:
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


def _in_hull(hull: Floats, points: Floats) -> NDArray[np.bool_]:
    sides = np.roll(hull, -1, axis=0) - hull
    arms = points[:, None] - hull
    return np.asarray((sides[:, 0] * arms[..., 1] - sides[:, 1] * arms[..., 0] >= 0.0).all(axis=1))


def disc_template(radius_m: float) -> Template:
    """The template of a ball: a disc, compared with what lies around it."""
    turns = np.arange(POINTS) * (math.tau / POINTS)
    ring = np.column_stack([np.cos(turns), np.sin(turns)])
    inner = ring * (radius_m * np.where(np.arange(POINTS) % 2 == 0, 0.6, 0.25))[:, None]
    around = ring * (1.35 * radius_m)
    return Template(
        frozen(np.array([inner, around, around])),
        frozen(np.ones(1, dtype=np.bool_)),
        1,
        True,
        2.0 * radius_m,
        2.0 * radius_m,
    )
