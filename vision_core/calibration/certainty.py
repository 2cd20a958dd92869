"""How sure places on the field are, and how much of the field the lines span."""

import numpy as np

from vision_core.calibration.lens import HEIGHT, Lens
from vision_core.geometry import Floats, Mask

MEDIAN_PER_SIGMA = 0.6745
"""Of the absolute values of normal deviates."""


def sd_by_median(distances: Floats) -> float:
    """The standard deviation of distances, shape (n,), n > 0, by their median: a few wrong ones do not move it."""
    return float(np.median(np.abs(distances))) / MEDIAN_PER_SIGMA


def is_visible(pixels: Floats, size_px: tuple[int, int]) -> Mask:
    """Which pixels lie in a picture of this width and height, shape (..., 2) -> (...)."""
    with np.errstate(invalid="ignore"):
        inside = (pixels >= 0.0) & (pixels <= np.array(size_px) - 1.0)
    visible: Mask = np.asarray(inside.all(axis=-1))
    return visible


def place_error_m(lens: Lens, covariance: Floats, places_m: Floats, size_px: tuple[int, int], height_m: float) -> float:
    """Two standard deviations of places at a height, the largest of those in the picture [m]; inf: none is.

    covariance: of the parameters, shape (17, 17); places_m: shape (n, 2); size_px: width and height of the picture.
    """
    share = height_m / lens.position_m[2]
    floor = (places_m - lens.position_m[:2] * share) / (1.0 - share)
    floor = floor[is_visible(lens.project(floor), size_px)]
    if not len(floor):
        return float("inf")
    step = 1e-4
    ahead, aside = (
        (lens.project(floor + move) - lens.project(floor - move)) / (2.0 * step)
        for move in (np.array([step, 0.0]), np.array([0.0, step]))
    )
    floor_moves = -np.linalg.solve(np.stack([ahead, aside], axis=-1), lens.jacobian(floor))  # of a fixed pixel
    moves = floor_moves * (1.0 - share)
    moves[:, 0, 7] += share
    moves[:, 1, 8] += share
    moves[:, :, HEIGHT] -= (lens.position_m[:2] - floor) * (share / lens.position_m[2])
    spread = np.einsum("ncp,pq,ncq->n", moves, covariance, moves)
    return 2.0 * float(np.sqrt(spread.max()))


def hull_area(points: Floats) -> float:
    """Area of the convex hull of points, shape (n, 2), in their unit squared."""
    x, y = _hull(points).T
    return float(abs((x * np.roll(y, -1) - y * np.roll(x, -1)).sum()) / 2.0)


def inside_hull(places: Floats, points: Floats) -> Mask:
    """Which places, shape (n, 2), lie in the convex hull of points, shape (k, 2)."""
    corners = _hull(points)
    if len(corners) < 3:
        return np.zeros(len(places), dtype=bool)
    sides = np.roll(corners, -1, axis=0) - corners
    arms = places[:, None] - corners
    turns = sides[:, 0] * arms[..., 1] - sides[:, 1] * arms[..., 0]
    return np.asarray((turns >= 0.0).all(axis=1))


def _hull(points: Floats) -> Floats:
    """Corners of the convex hull, shape (n, 2), in the positive sense of rotation; one at the origin: there is none."""
    ordered = sorted(map(tuple, points.round(6).tolist()))
    hull: list[tuple[float, ...]] = []
    for half in (ordered, ordered[::-1]):
        chain: list[tuple[float, ...]] = []
        for x, y in half:
            while len(chain) > 1 and _is_right(chain[-2], chain[-1], (x, y)):
                chain.pop()
            chain.append((x, y))
        hull += chain[:-1]
    return np.array(hull) if len(hull) > 2 else np.zeros((1, 2))


def _is_right(a: tuple[float, ...], b: tuple[float, ...], c: tuple[float, ...]) -> bool:
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]) <= 0.0
