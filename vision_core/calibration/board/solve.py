"""A lens from the corners of boards in several pictures, with its covariance."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from vision_core.calibration.board.corners import BoardView
from vision_core.geometry import Floats
from vision_core.native.charuco import Views, fit_views, pose_of, seen_points, turn_matrix

SIGMAS = 4.0
"""Corners that miss the lens by more standard deviations are left out."""
LEAST_NOISE_PX = 0.05
MEDIAN_PER_SIGMA = 1.1774
"""Median length of a distance in the plane, in standard deviations of one coordinate."""
K3_GAIN, K3_KNOWN = 0.9, 0.3
"""k3 is solved when the rms falls to less than so much of it, and k3's deviation is below this share of its value."""
LENS = slice(0, 7)
"""Focal length, center and k1, k2, p1, p2 among the parameters of the lens."""
GRID = 9
UNITS = np.array([0.05, 0.02, 0.02, 0.1, 0.1, 1e-3, 1e-3, 0.1])
"""Usual deviations of the parameters: focal length and center as shares of the longer side."""


@dataclass(frozen=True, slots=True, eq=False)
class LensFit:
    """A lens that was fitted to boards."""

    views: Views
    seen: tuple[BoardView, ...]
    """The corners that count."""
    covariance: Floats
    """Of focal length, center (2), k1, k2, p1, p2, k3; shape (8, 8); zero for a k3 that is not solved."""
    condition: float

    @property
    def distances(self) -> list[Floats]:
        """From every corner to where the lens puts it, shape (n, 2) each [px]."""
        poses = zip(self.seen, self.views.turns, self.views.places, strict=True)
        return [seen_points(self.views, turn, place, view.points)[0] - view.pixels for view, turn, place in poses]

    @property
    def rms_px(self) -> float:
        """Of the distances' lengths."""
        return rms(np.concatenate(self.distances))

    def normals(self) -> Floats:
        """The boards' normals in camera space, shape (n, 3)."""
        return np.array([turn_matrix(turn)[:, 2] for turn in self.views.turns])

    def bend_error_px(self, size_px: tuple[int, int]) -> float:
        """Two standard deviations of a place in the picture, where it is largest.

        What the pose of a floor that is seen from above can make good does not count.
        """
        width, height = size_px
        x, y = np.linspace(0.0, width, GRID), np.linspace(0.0, height, GRID)
        grid = np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2)
        floor = (grid - self.views.center_px) / self.views.focal_px
        _, pose, lens = seen_points(self.views, np.zeros(3), np.array([0.0, 0.0, 1.0]), floor)
        left = lens - pose @ np.linalg.lstsq(pose, lens, rcond=None)[0]
        spread = np.einsum("np,pq,nq->n", left, self.covariance, left).reshape(-1, 2).sum(axis=1)
        return 2.0 * float(np.sqrt(max(spread.max(), 0.0)))


def fit_lens(seen: Sequence[BoardView], size_px: tuple[int, int]) -> LensFit | None:
    """The lens that sees the boards; corners that miss it by much more than the others are left out.

    size_px: width and height of the pictures. None: no lens explains them.
    """
    first = _fit(seen, size_px, frees_k3=False)
    if first is None:
        return None
    limit = SIGMAS * max(_noise(first.distances), LEAST_NOISE_PX)
    kept = [
        replace(view, numbers=view.numbers[near], pixels=view.pixels[near])
        for view, distances in zip(seen, first.distances, strict=True)
        if (near := np.hypot(*distances.T) <= limit).sum() > 3
    ]
    if len(kept) < len(seen):  # a picture with hardly a good corner is told by its rms
        kept = list(seen)
    second = _fit(kept, size_px, frees_k3=False) or first
    third = _fit(kept, size_px, frees_k3=True)
    if third is not None and third.rms_px < K3_GAIN * second.rms_px:
        k3 = abs(float(third.views.distortion[4]))
        if np.sqrt(third.covariance[7, 7]) < K3_KNOWN * k3:
            return third
    return second


def held_out_px(seen: Sequence[BoardView], size_px: tuple[int, int], number: int) -> float | None:
    """The rms of one picture's corners by the lens of all others [px]; None where these do not suffice."""
    others = [view for index, view in enumerate(seen) if index != number]
    views = fit_views([view.points for view in others], [view.pixels for view in others], size_px, frees_k3=False)
    pose = pose_of(views, seen[number].points, seen[number].pixels) if views is not None else None
    if views is None or pose is None:
        return None
    return rms(seen_points(views, *pose, seen[number].points)[0] - seen[number].pixels)


def rms(distances: Floats) -> float:
    """Root mean square length of distances, shape (n, 2)."""
    return float(np.sqrt((distances**2).sum(axis=1).mean()))


def _fit(seen: Sequence[BoardView], size_px: tuple[int, int], *, frees_k3: bool) -> LensFit | None:
    views = fit_views([view.points for view in seen], [view.pixels for view in seen], size_px, frees_k3=frees_k3)
    if views is None:
        return None
    units = UNITS * np.array([*[max(size_px)] * 3, *[1.0] * 5])
    count = 8 if frees_k3 else 7
    information = np.zeros((count, count))
    for view, turn, place in zip(seen, views.turns, views.places, strict=True):
        _, pose, lens = seen_points(views, turn, place, view.points)
        lens = (lens * units)[:, :count]
        left = lens - pose @ np.linalg.lstsq(pose, lens, rcond=None)[0]
        information += left.T @ left
    fitted = LensFit(views, tuple(seen), np.zeros((8, 8)), np.inf)
    noise = max(_noise(fitted.distances), LEAST_NOISE_PX)
    sizes = np.linalg.eigvalsh(information)
    covariance = np.zeros((8, 8))
    covariance[:count, :count] = np.linalg.pinv(information, rcond=1e-15) * noise**2
    covariance *= np.outer(units, units)
    return replace(fitted, covariance=covariance, condition=float(sizes[-1] / max(sizes[0], 1e-300)))


def _noise(distances: Sequence[Floats]) -> float:
    """Robust standard deviation of one coordinate [px]."""
    return float(np.median(np.hypot(*np.concatenate(distances).T))) / MEDIAN_PER_SIGMA
