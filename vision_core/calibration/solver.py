"""Levenberg-Marquardt for a lens: robust residuals across lines, and priors for what lines alone do not determine."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vision_core.calibration.lens import COUNT, Lens
from vision_core.geometry import Floats

STEPS = 12
FIRST_DAMPING, LEAST_DAMPING, MAX_DAMPING = 1e-4, 1e-9, 1e6
SETTLED = 1e-5
"""A step that moves no parameter by more than this share of its prior's deviation is the last one."""
LEAST_NOISE_PX = 0.05
MEDIAN_PER_SIGMA = 0.6745


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
    damping = FIRST_DAMPING
    noise = noise_px or _noise(sights.distances(lens))
    loss = _loss(lens, sights, prior, noise, trust)
    for _ in range(steps):
        gradient, information = _normal_equations(lens, sights, prior, noise, trust)
        while damping < MAX_DAMPING:
            damped = information + damping * np.diag(np.diag(information) + 1.0)
            step = -np.linalg.solve(damped, gradient)
            moved = lens.moved(step * prior.deviations)
            reached = _loss(moved, sights, prior, noise, trust)
            if reached < loss:
                break
            damping *= 10.0
        else:
            break
        lens, damping = moved, max(damping * 0.1, LEAST_DAMPING)
        noise = noise_px or _noise(sights.distances(lens))
        loss = _loss(lens, sights, prior, noise, trust)
        if np.abs(step).max() < SETTLED:
            break
    distances = sights.distances(lens)
    _, information = _normal_equations(lens, sights, prior, noise, trust)
    return Fit(lens, _weights(distances, noise), noise, information)


def _noise(distances: Floats) -> float:
    return (
        max(float(np.median(np.abs(distances))) / MEDIAN_PER_SIGMA, LEAST_NOISE_PX)
        if len(distances)
        else LEAST_NOISE_PX
    )


def _weights(distances: Floats, noise_px: float) -> Floats:
    weights: Floats = 1.0 / (1.0 + (distances / (2.0 * noise_px)) ** 2)
    return weights


def _loss(lens: Lens, sights: Sights, prior: Prior, noise_px: float, trust: float) -> float:
    squares = (sights.distances(lens) / (2.0 * noise_px)) ** 2
    loss = trust * 4.0 * np.log1p(squares).sum() + (prior.distances(lens) ** 2).sum()
    return float(loss) if np.isfinite(loss) and lens.focal_px > 0.0 and lens.position_m[2] > 0.0 else np.inf


def _normal_equations(lens: Lens, sights: Sights, prior: Prior, noise_px: float, trust: float) -> tuple[Floats, Floats]:
    """Gradient, shape (17,), and information, shape (17, 17), in units of the prior's deviations."""
    distances = sights.distances(lens)
    design = sights.design(lens) * prior.deviations / noise_px
    weighted = trust * design * _weights(distances, noise_px)[:, None]
    gradient = weighted.T @ (distances / noise_px) + prior.distances(lens)
    information = weighted.T @ design + np.diag(prior.counts)
    return gradient.reshape(COUNT), information
