"""A mirror through pairs of radius and distance: robust, in pixels, with a prior on the focal length.

A, B and C are almost collinear where R is small against f, so (log h, log u, log f) are fitted, and f has a prior from
the camera. Residuals are pixels through the inverse of equation 1: in millimetres they would explode near the horizon.

Several first guesses of f; each gives A and B by the best line through two pairs (``lines``). From each
Levenberg-Marquardt descends on the soft-L1 loss, and the best one counts. Pairs that miss it by much are left out,
and the others are fitted by least squares, until no pair changes sides.
"""

from dataclasses import dataclass

import numpy as np

from vision_core.calibration.certainty import sd_by_median
from vision_core.calibration.descent import descend
from vision_core.calibration.mirror.lines import best_line
from vision_core.calibration.mirror.pairs import Pairs
from vision_core.geometry import Floats, Mask
from vision_core.models.hyperboloid import Hyperboloid
from vision_core.models.mirror import px_from_mm

STARTS_PX = (150.0, 300.0, 600.0)
"""First guesses of the focal length."""
USUAL_FOCAL_PX, ANY_FOCAL = 300.0, 0.7
"""The prior without a focal length, whose deviation is a factor of two."""
USUAL_FOCAL, LEAST_FOCAL = 0.1, 1e-4
"""Deviation of a focal length that came without one, and the least of any, as shares of it."""
USUAL_HEIGHT_MM, USUAL_BEND = 220.0, 1.7
"""Where no two pairs are a mirror."""
STEPS, ROUNDS = 40, 8
"""Steps of the descent; rounds of leaving pairs out."""
OUTLIER_SIGMAS, OUTLIER_PX = 4.0, 1.0
"""A pair that misses the curve by so many deviations, and by so much, does not count."""
LEAST_NOISE_PX, CUT_NOISE_PX = 0.1, 0.2887
"""Nobody measures better; 1/sqrt(12), that of radii that were cut to whole numbers."""
MIN_ALIKE, ALIKE_SIGMAS, MAX_ALIKE = 12, 3.0, 0.95
"""From so many pairs on residuals of neighbours are compared; what is correlated by so many deviations is no noise."""
MAX_LOG = 30.0
"""Of any parameter: beyond it the constants of equation 1 overflow."""
PARAMETERS = 3
"""log h, log u, log f."""


@dataclass(frozen=True, slots=True)
class FocalPrior:
    """What is known of the focal length of the on-board camera, by its intrinsics or its maker."""

    focal_px: float = USUAL_FOCAL_PX
    share: float = ANY_FOCAL
    """Standard deviation as a share of it."""


def focal_prior(focal_px: float, deviation_px: float | None) -> FocalPrior:
    """What is known of a focal length. deviation_px: its standard deviation; None: a tenth of it."""
    share = USUAL_FOCAL if deviation_px is None else deviation_px / focal_px
    return FocalPrior(focal_px, max(share, LEAST_FOCAL))


@dataclass(frozen=True, slots=True, eq=False)
class MirrorFit:
    """A mirror that was fitted."""

    logs: Floats
    """log h, log u, log f; shape (3,)."""
    kept: Mask
    """Pairs that count, shape (n,)."""
    off_px: Floats
    """How much farther from the center each pair lies than the curve, shape (n,)."""
    noise_px: float
    """Standard deviation of the pairs that count."""
    alike: float
    """Correlation of the residuals of neighbours, by distance or in a picture, where it is no accident; otherwise 0."""
    noise_covariance: Floats
    """Of log h, log u, log f by noise; shape (3, 3). Neighbours that are alike count as fewer."""
    shared_covariance: Floats
    """The same by the errors that pairs share, of which more pairs tell nothing."""
    condition: float
    """Of the derivatives of the radii by log h, log u, log f, without the prior."""

    @property
    def shape(self) -> Hyperboloid:
        """Focal length, height and bend."""
        return _shape(self.logs)

    @property
    def covariance(self) -> Floats:
        """Of log h, log u, log f; shape (3, 3)."""
        return self.noise_covariance + self.shared_covariance

    def deviation_px(self, distances_mm: Floats) -> Floats:
        """Standard deviation of the curve at distances on the floor, shape (n,) [mm] -> (n,) [px]."""
        return self._spread_px(self.covariance, distances_mm)

    def shared_deviation_px(self, distances_mm: Floats) -> Floats:
        """The same by the errors that pairs share."""
        return self._spread_px(self.shared_covariance, distances_mm)

    def constants_covariance(self) -> Floats:
        """Of A, B, C by the chain rule, shape (3, 3)."""
        a, b, c = self.shape.constants
        bend = self.shape.bend
        chain = np.array(
            [[-a, b * bend * self.shape.focal_px, a], [-b, a * bend / self.shape.focal_px, 0.0], [0, 0, 2 * c]]
        )
        covariance: Floats = chain @ self.covariance @ chain.T
        return covariance

    def _spread_px(self, covariance: Floats, distances_mm: Floats) -> Floats:
        design = jacobian(self.logs, distances_mm)
        spread: Floats = np.sqrt(np.einsum("np,pq,nq->n", design, covariance, design).clip(min=0.0))
        return spread


def fit_mirror(pairs: Pairs, prior: FocalPrior) -> MirrorFit:
    """The mirror that explains pairs, of which there are at least three; those that do not fit are left out."""
    radii, distances = pairs.measured_px, pairs.distances_mm
    least = CUT_NOISE_PX if pairs.are_cut else LEAST_NOISE_PX
    everything = _Data(radii, distances, prior, least)
    found = [_descended(everything, start) for start in (*STARTS_PX, prior.focal_px)]
    common = min(everything.robust_noise_px(logs) for logs in found)
    logs = min(found, key=lambda one: _Problem(everything, common, is_robust=True).loss(one))
    kept = np.ones(len(pairs), dtype=bool)
    for number in range(ROUNDS):
        usual = everything.robust_noise_px(logs)
        near = np.abs(everything.off_px(logs)) <= max(OUTLIER_SIGMAS * usual, OUTLIER_PX)
        if near.sum() <= PARAMETERS or (number > 0 and (near == kept).all()):
            break
        kept, data = near, _Data(radii[near], distances[near], prior, least)
        logs = _least_squares(data, logs, data.noise_px(logs))
    noise = _Data(radii[kept], distances[kept], prior, least).noise_px(logs)
    return _result(everything, logs, kept, noise, pairs.shared[kept])


def jacobian(logs: Floats, distances_mm: Floats) -> Floats:
    """Derivatives of the radii [px] by log h, log u, log f; shape (n,) [mm] -> (n, 3).

    R = f r / q with q = h cosh(u) + sinh(u) sqrt(h^2 + r^2), which is the inverse of equation 1.
    """
    shape = _shape(logs)
    height, bend = shape.height_mm, shape.bend
    away = np.hypot(height, distances_mm)
    q = height * np.cosh(bend) + np.sinh(bend) * away
    radii = shape.focal_px * distances_mm / q
    by_height = -radii * height * (np.cosh(bend) + np.sinh(bend) * height / away) / q
    by_bend = -radii * bend * (height * np.sinh(bend) + np.cosh(bend) * away) / q
    return np.stack([by_height, by_bend, radii], axis=-1)


@dataclass(frozen=True, slots=True, eq=False)
class _Data:
    """What is fitted."""

    radii_px: Floats
    distances_mm: Floats
    prior: FocalPrior
    least_noise_px: float

    def off_px(self, logs: Floats) -> Floats:
        """Shape (n,)."""
        return self.radii_px - radii_of(_shape(logs), self.distances_mm)

    def robust_noise_px(self, logs: Floats) -> float:
        """By the median, which outliers do not move."""
        freedom = len(self.radii_px) / max(len(self.radii_px) - PARAMETERS, 1)
        return max(sd_by_median(self.off_px(logs)) * float(np.sqrt(freedom)), self.least_noise_px)

    def noise_px(self, logs: Floats) -> float:
        """By the mean square."""
        freedom = max(len(self.radii_px) - PARAMETERS, 1)
        return max(float(np.sqrt((self.off_px(logs) ** 2).sum() / freedom)), self.least_noise_px)


@dataclass(frozen=True, slots=True, eq=False)
class _Problem:
    """Soft-L1 loss or squares of pairs, and the prior, as ``descend`` wants them."""

    data: _Data
    noise_px: float
    is_robust: bool

    def loss(self, logs: Floats) -> float:
        if np.abs(logs).max() > MAX_LOG or logs[1] > np.log(MAX_LOG):
            return np.inf
        squares = (self.data.off_px(logs) / self.noise_px) ** 2
        losses = 2.0 * (np.sqrt(1.0 + squares) - 1.0) if self.is_robust else squares
        return float(losses.sum() + self._pull(logs) ** 2)

    def normal_equations(self, logs: Floats) -> tuple[Floats, Floats]:
        off = self.data.off_px(logs) / self.noise_px
        design = jacobian(logs, self.data.distances_mm) / self.noise_px
        weights = 1.0 / np.sqrt(1.0 + off**2) if self.is_robust else np.ones_like(off)
        weighted = design * weights[:, None]
        information = weighted.T @ design
        gradient = -weighted.T @ off
        gradient[2] += self._pull(logs) / self.data.prior.share
        information[2, 2] += self.data.prior.share**-2
        return gradient, information

    def moved(self, logs: Floats, step: Floats) -> Floats:
        return logs + step

    def _pull(self, logs: Floats) -> float:
        """Of the prior, in its deviations."""
        return float(logs[2] - np.log(self.data.prior.focal_px)) / self.data.prior.share


def radii_of(shape: Hyperboloid, distances_mm: Floats) -> Floats:
    """f^-1 of distances on the floor, shape (n,) [mm] -> (n,) [px], of shapes that are no allowed mirrors too."""
    scale = (shape.focal_px / shape.height_mm) ** 2
    radii: Floats = np.asarray(px_from_mm(distances_mm, *shape.constants, scale))
    return radii


def px_per_mm(shape: Hyperboloid, distances_mm: Floats) -> Floats:
    """How fast the radius grows with the distance, shape (n,) [mm] -> (n,)."""
    height, bend = shape.height_mm, shape.bend
    away = np.hypot(height, distances_mm)
    q = height * np.cosh(bend) + np.sinh(bend) * away
    slopes: Floats = shape.focal_px / q * (1.0 - np.sinh(bend) * distances_mm**2 / (q * away))
    return slopes


def _descended(data: _Data, focal_px: float) -> Floats:
    """From a first guess of the focal length down the robust loss."""
    line = best_line(data.radii_px, data.distances_mm, focal_px)
    height, bend = USUAL_HEIGHT_MM, USUAL_BEND
    if line is not None:
        a, b = line
        bend = float(np.arctanh(focal_px * b / a))
        height = float(np.sinh(bend)) / b
    start = np.log([height, bend, focal_px])

    def problem_at(logs: Floats) -> _Problem:
        return _Problem(data, data.robust_noise_px(logs), is_robust=True)

    return descend(start, problem_at, STEPS)


def _least_squares(data: _Data, logs: Floats, noise_px: float) -> Floats:
    """Down the squares, from a state nearby."""
    problem = _Problem(data, noise_px, is_robust=False)
    return descend(logs, lambda _: problem, STEPS)


def _result(data: _Data, logs: Floats, kept: Mask, noise_px: float, shared: Floats) -> MirrorFit:
    distances, off = data.distances_mm[kept], data.off_px(logs)[kept]
    design = jacobian(logs, distances)
    alike = max(_alike(off), _alike(off[np.argsort(distances, kind="stable")]))
    weighted = design.T / noise_px**2 * (1.0 - alike) / (1.0 + alike)
    information = weighted @ design
    information[2, 2] += data.prior.share**-2
    sizes = np.linalg.svd(design, compute_uv=False)
    covariance = np.asarray(np.linalg.pinv(information, rcond=1e-15, hermitian=True), dtype=np.float64)
    slopes = px_per_mm(_shape(logs), distances)
    moves = covariance @ weighted @ np.stack([slopes * shared[:, 0], shared[:, 1]], axis=-1)
    return MirrorFit(
        logs=logs,
        kept=kept,
        off_px=data.off_px(logs),
        noise_px=noise_px,
        alike=alike,
        noise_covariance=covariance,
        shared_covariance=moves @ moves.T,
        condition=float(sizes[0] / max(sizes[-1], 1e-300)) if len(sizes) == PARAMETERS else np.inf,
    )


def _alike(off_px: Floats) -> float:
    """Correlation of neighbours among residuals in some order."""
    if len(off_px) < MIN_ALIKE:
        return 0.0
    alike = float((off_px[:-1] * off_px[1:]).mean() / max(float((off_px**2).mean()), 1e-12))
    return min(alike, MAX_ALIKE) if alike > ALIKE_SIGMAS / np.sqrt(len(off_px)) else 0.0


def _shape(logs: Floats) -> Hyperboloid:
    height, bend, focal = (float(value) for value in np.exp(logs))
    return Hyperboloid(focal, height, bend)
