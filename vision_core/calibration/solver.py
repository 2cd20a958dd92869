"""Levenberg-Marquardt for a lens: robust residuals across lines, and priors for what lines alone do not determine."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vision_core.calibration.certainty import sd_by_median
from vision_core.calibration.descent import descend
from vision_core.calibration.lens import COUNT, Lens
from vision_core.geometry import Floats

STEPS = 12
LEAST_NOISE_PX = 0.05


@dataclass(frozen=True, slots=True, eq=False)
class Sights:
    """Points of the floor, and what the picture says about where they are."""

    points_m: Floats
    """By the field's settings, shape (n, 2)."""
    moves: Floats
    """How they move with the field's measures, shape (n, 2, 4)."""
    pixels: Floats
    """Where they were measured, shape (n, 2)."""
    normals: Floats
    """Unit vectors along which they were measured, shape (n, 2)."""

    def __len__(self) -> int:
        return len(self.points_m)

    def places_m(self, lens: Lens) -> Floats:
        """The points by the measures that the lens goes with, shape (n, 2)."""
        places: Floats = self.points_m + self.moves @ lens.stretch
        return places

    def distances(self, lens: Lens) -> Floats:
        """Signed distances [px] along the normals between the projected points and the measured ones, shape (n,)."""
        distances: Floats = ((lens.project(self.places_m(lens)) - self.pixels) * self.normals).sum(axis=1)
        return distances

    def design(self, lens: Lens) -> Floats:
        """Derivatives of the distances by the parameters, shape (n, 17)."""
        design: Floats = np.einsum("nc,ncp->np", self.normals, lens.jacobian(self.places_m(lens), self.moves))
        return design

    def chosen(self, mask: NDArray[Any]) -> "Sights":
        """Some of them, by a mask or by indices."""
        return Sights(self.points_m[mask], self.moves[mask], self.pixels[mask], self.normals[mask])


@dataclass(frozen=True, slots=True, eq=False)
class Prior:
    """What is known without lines: values and standard deviations of all parameters, shape (17,) each.

    The turns have no prior: their deviations only scale the steps.
    """

    values: Floats
    deviations: Floats
    counts: Floats
    """1 where the prior is a measurement, 0 where it only scales."""

    def distances(self, lens: Lens) -> Floats:
        """Shape (17,), in standard deviations."""
        distances: Floats = (lens.values - self.values) / self.deviations * self.counts
        return distances


@dataclass(frozen=True, slots=True, eq=False)
class Fit:
    """A lens that was fitted to sights."""

    lens: Lens
    weights: Floats
    """0..1 per sight: less where it misses the lens by much more than the others."""
    noise_px: float
    """Robust standard deviation of the distances."""
    information: Floats
    """Inverse covariance of the parameters in units of the prior's deviations, shape (17, 17)."""

    @property
    def condition(self) -> float:
        """Ratio of the largest to the smallest eigenvalue of the information: large when parameters cannot be told."""
        sizes = np.linalg.eigvalsh(self.information)
        return float(sizes[-1] / max(sizes[0], 1e-300))

    def covariance(self, prior: Prior) -> Floats:
        """Of the parameters in their own units, shape (17, 17); infinite where the sights do not tell them at all."""
        try:
            inverse = np.linalg.inv(self.information)
        except np.linalg.LinAlgError:
            inverse = np.full((COUNT, COUNT), np.inf)
        covariance: Floats = inverse * np.outer(prior.deviations, prior.deviations)
        return covariance


def fit(
    lens: Lens,
    sights: Sights,
    prior: Prior,
    *,
    noise_px: float | None = None,
    trust: float = 1.0,
    steps: int = STEPS,
) -> Fit:
    """Move a lens so that the sights' distances become small, sights that miss it by much counting less.

    The loss is Cauchy's. noise_px: a usual distance; None: the distances' own robust deviation. trust: how much the
    sights count beside the prior: less than 1 where neighbours share their errors.
    """

    def problem_at(near: Lens) -> _Problem:
        return _Problem(sights, prior, noise_px or _noise(sights.distances(near)), trust)

    found = descend(lens, problem_at, steps)
    problem = problem_at(found)
    _, information = problem.normal_equations(found)
    return Fit(found, _weights(sights.distances(found), problem.noise_px), problem.noise_px, information)


@dataclass(frozen=True, slots=True, eq=False)
class _Problem:
    """Cauchy's loss of sights and prior, as ``descend`` wants it. A parameter's unit is its prior's deviation."""

    sights: Sights
    prior: Prior
    noise_px: float
    trust: float

    def loss(self, lens: Lens) -> float:
        squares = (self.sights.distances(lens) / (2.0 * self.noise_px)) ** 2
        loss = self.trust * 4.0 * np.log1p(squares).sum() + (self.prior.distances(lens) ** 2).sum()
        return float(loss) if np.isfinite(loss) and lens.focal_px > 0.0 and lens.position_m[2] > 0.0 else np.inf

    def normal_equations(self, lens: Lens) -> tuple[Floats, Floats]:
        distances = self.sights.distances(lens)
        design = self.sights.design(lens) * self.prior.deviations / self.noise_px
        weighted = self.trust * design * _weights(distances, self.noise_px)[:, None]
        gradient = weighted.T @ (distances / self.noise_px) + self.prior.distances(lens)
        information = weighted.T @ design + np.diag(self.prior.counts)
        return gradient.reshape(COUNT), information

    def moved(self, lens: Lens, step: Floats) -> Lens:
        return lens.moved(step * self.prior.deviations)


def _noise(distances: Floats) -> float:
    return max(sd_by_median(distances), LEAST_NOISE_PX) if len(distances) else LEAST_NOISE_PX


def _weights(distances: Floats, noise_px: float) -> Floats:
    weights: Floats = 1.0 / (1.0 + (distances / (2.0 * noise_px)) ** 2)
    return weights
