"""The rules of ``vision_core.views`` a second time: slow, and simple enough to be checked by reading.

On purpose by other means than the product. The world is moved and turned until the observer stands at the
origin and the ray is the x axis. A circle is met at a root of its quadratic equation; a square where the ray has
entered both of the slabs that it is the intersection of; a segment where its two ends lie on either side of the
axis, by interpolation. The ball is cut into thin slices of azimuth, and each
slice's middle is asked: does the ray in this direction meet something solid before the ball's center distance?
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vision_core.geometry import Floats


@dataclass(frozen=True)
class Scene:
    """Everything around one viewer, in field space [m]."""

    x: float
    y: float
    solid: Floats
    """x1 y1 x2 y2, shape (s, 4)."""
    solid_kinds: NDArray[np.uint8]
    virtual: Floats
    """The limit's segments, shape (v, 4); they are seen from inside only."""
    virtual_kinds: NDArray[np.uint8]
    half_extent: tuple[float, float]
    robots: Floats
    """Centers of the others and of obstacles, shape (c, 2)."""
    robot_kinds: NDArray[np.uint8]
    radii: Floats
    """Of circles; half the sides of squares."""
    headings: Floats
    """Of squares; nan for circles."""
    r_min: float


def holding(scene: Scene) -> NDArray[np.bool_]:
    """Which outlines contain the viewer's center, shape (c,)."""
    offsets = scene.robots - (scene.x, scene.y)
    along, aside = _turned(offsets, scene.headings)
    inside_square = np.maximum(abs(along), abs(aside)) <= scene.radii
    return np.asarray(np.where(np.isnan(scene.headings), np.hypot(*offsets.T) <= scene.radii, inside_square))


def meets_bodies(angles: Floats, scene: Scene) -> Floats:
    """Distance of each ray to each robot and obstacle, shape (n, c)."""
    return np.where(np.isnan(scene.headings), meets_circles(angles, scene), meets_squares(angles, scene))


def meets_squares(angles: Floats, scene: Scene) -> Floats:
    """Distance of each ray to each square, shape (n, c); meaningless for circles."""
    x, y = _turned((scene.x, scene.y) - scene.robots, scene.headings)
    turned = angles[:, None] - scene.headings
    with np.errstate(divide="ignore", invalid="ignore"):
        enters, leaves = [], []
        for start, speed in ((x, np.cos(turned)), (y, np.sin(turned))):
            ends = np.stack([(-scene.radii - start) / speed, (scene.radii - start) / speed])
            enters.append(ends.min(axis=0))
            leaves.append(ends.max(axis=0))
        enter, leave = np.maximum(*enters), np.minimum(*leaves)
    return np.where((enter <= leave) & (enter >= 0.0), enter, np.inf)


def _turned(vectors: Floats, headings: Floats) -> tuple[Floats, Floats]:
    """Vectors (c, 2) along and across headings (c,)."""
    c, s = np.cos(headings), np.sin(headings)
    return vectors[:, 0] * c + vectors[:, 1] * s, vectors[:, 1] * c - vectors[:, 0] * s


def meets_circles(angles: Floats, scene: Scene) -> Floats:
    """Distance of each ray to each robot, shape (n, c)."""
    centers = scene.robots - (scene.x, scene.y)
    directions = np.column_stack([np.cos(angles), np.sin(angles)])
    # |t u - c|^2 = R^2  <=>  t^2 - 2 (u.c) t + |c|^2 - R^2 = 0
    half_b = directions @ centers.T
    discriminant = half_b**2 - ((centers**2).sum(axis=1) - scene.radii**2)
    with np.errstate(invalid="ignore"):
        smaller = half_b - np.sqrt(discriminant)
    return np.where((discriminant >= 0.0) & (smaller >= 0.0), smaller, np.inf)


def meets_segments(angles: Floats, scene: Scene, segments: Floats) -> Floats:
    """Distance of each ray to each segment, shape (n, s)."""
    c, s = np.cos(angles)[:, None], np.sin(angles)[:, None]
    x1, y1, x2, y2 = (segments - (scene.x, scene.y, scene.x, scene.y)).T
    along1, across1 = c * x1 + s * y1, c * y1 - s * x1
    along2, across2 = c * x2 + s * y2, c * y2 - s * x2
    with np.errstate(divide="ignore", invalid="ignore"):
        crossing = along1 + (along2 - along1) * (0.0 - across1) / (across2 - across1)
    return np.where((across1 * across2 <= 0.0) & (across1 != across2) & (crossing >= 0.0), crossing, np.inf)


def edges(angles: Floats, scene: Scene) -> tuple[Floats, NDArray[np.uint8]]:
    """Distance and kind of each ray's nearest edge, shapes (n,)."""
    away = np.linalg.norm(scene.robots - (scene.x, scene.y), axis=1)
    away[~holding(scene)] = np.inf
    if len(away) and np.isfinite(away.min()):
        kind = scene.robot_kinds[away.argmin()]
        return np.full(len(angles), scene.r_min), np.full(len(angles), kind)
    columns = [meets_bodies(angles, scene), meets_segments(angles, scene, scene.solid)]
    kinds = [scene.robot_kinds, scene.solid_kinds]
    if abs(scene.x) <= scene.half_extent[0] and abs(scene.y) <= scene.half_extent[1]:
        columns.append(meets_segments(angles, scene, scene.virtual))
        kinds.append(scene.virtual_kinds)
    table = np.column_stack(columns)
    all_kinds = np.concatenate(kinds)
    nearest = table.argmin(axis=1)
    distances = table.min(axis=1)
    return (
        np.maximum(distances, scene.r_min),
        np.where(np.isfinite(distances), all_kinds[nearest], 0).astype(np.uint8),
    )


def ball_slices(scene: Scene, ball: tuple[float, float], ball_radius: float, slices: int) -> NDArray[np.bool_]:
    """Which slices of the ball's azimuth are visible."""
    dx, dy = ball[0] - scene.x, ball[1] - scene.y
    distance = np.hypot(dx, dy)
    if distance <= ball_radius:
        return np.ones(slices, dtype=np.bool_)
    if holding(scene).any():
        return np.zeros(slices, dtype=np.bool_)
    alpha = np.arcsin(ball_radius / distance)
    angles = np.arctan2(dy, dx) + alpha * ((np.arange(slices) + 0.5) / slices * 2.0 - 1.0)
    obstacles = np.column_stack([meets_bodies(angles, scene), meets_segments(angles, scene, scene.solid)])
    return np.asarray(obstacles.min(axis=1, initial=np.inf) >= distance)
