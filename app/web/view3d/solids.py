"""Meshes: upright solids over a plane outline. Metres."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from vision_core.geometry import Floats

CIRCLE_STEPS = 24


class Solid(NamedTuple):
    """A closed surface of triangles."""

    vertices_m: NDArray[np.float32]
    """Shape (n, 3)."""
    faces: NDArray[np.uint32]
    """Indices of each triangle's corners, anticlockwise from outside; shape (m, 3)."""


def circle_m(radius_m: float, center_m: tuple[float, float] = (0.0, 0.0)) -> Floats:
    """Corners of a circle, anticlockwise; shape (CIRCLE_STEPS, 2)."""
    angles = np.linspace(0.0, math.tau, CIRCLE_STEPS, endpoint=False)
    points: Floats = np.column_stack([np.cos(angles), np.sin(angles)]) * radius_m + center_m
    return points


def square_m(half_side_m: float) -> Floats:
    """Corners of a square, anticlockwise; shape (4, 2)."""
    return half_side_m * np.array([[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]])


def flattened(outline_m: Floats, front_m: float) -> Floats:
    """An outline cut by the line x = front_m: a robot's flat front."""
    return np.column_stack([np.minimum(outline_m[:, 0], front_m), outline_m[:, 1]])


def upright(outline_m: Floats, bottom_m: float, top_m: float) -> Solid:
    """The solid over an outline that is star-shaped about the mean of its corners; outline of shape (n, 2)."""
    outline_m = outline_m if _is_anticlockwise(outline_m) else outline_m[::-1]
    n = len(outline_m)
    center = outline_m.mean(axis=0)
    vertices = np.vstack(
        [
            np.column_stack([outline_m, np.full(n, bottom_m)]),
            np.column_stack([outline_m, np.full(n, top_m)]),
            [*center, bottom_m],
            [*center, top_m],
        ]
    )
    here = np.arange(n)
    following = (here + 1) % n
    bottom, top = np.full(n, 2 * n), np.full(n, 2 * n + 1)
    faces = np.vstack(
        [
            np.column_stack([here, following, following + n]),
            np.column_stack([here, following + n, here + n]),
            np.column_stack([following, here, bottom]),
            np.column_stack([here + n, following + n, top]),
        ]
    )
    return Solid(vertices.astype(np.float32), faces.astype(np.uint32))


def _is_anticlockwise(outline_m: Floats) -> bool:
    x, y = outline_m.T
    return bool(np.sum(x * np.roll(y, -1) - y * np.roll(x, -1)) > 0.0)
