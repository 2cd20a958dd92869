"""The filter is consistent: its covariances are those of its errors, at every frame rate."""

from dataclasses import dataclass

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from vision_core.geometry import Floats
from vision_core.tracks.filters import corrected, density_from_acceleration, predicted, start_variance

DENSITY = density_from_acceleration(4.0)
NOISE_M = 0.002


@dataclass(frozen=True)
class Motion:
    """The filter as its users hold it: values beside the covariances that the axes share."""

    value: Floats
    rate: Floats
    variance: float
    covariance: float
    rate_variance: float

    def predicted(self, t: float, density: float) -> "Motion":
        spread = predicted(self.variance, self.covariance, self.rate_variance, t, density)
        return Motion(self.value + self.rate * t, self.rate, *spread)

    def corrected(self, innovation: Floats, noise: float) -> "Motion":
        gain, rate_gain, *spread = corrected(self.variance, self.covariance, self.rate_variance, noise)
        return Motion(self.value + gain * innovation, self.rate + rate_gain * innovation, *spread)


def started(value: Floats, noise: float, acceleration: float) -> Motion:
    return Motion(value, np.zeros_like(value), noise, 0.0, start_variance(acceleration))


def covariance_of(motion: Motion) -> Floats:
    return np.array([[motion.variance, motion.covariance], [motion.covariance, motion.rate_variance]])


def simulated(rng: np.random.Generator, rate_hz: float, frames: int) -> tuple[Floats, Floats]:
    """Truth (place and velocity, shape (frames, 2, 2)) of white-noise acceleration, and its noisy measurements."""
    t = 1.0 / rate_hz
    shake = np.linalg.cholesky(DENSITY * np.array([[t**3 / 3.0, t**2 / 2.0], [t**2 / 2.0, t]]))
    state = np.stack([rng.normal(0.0, 1.0, 2), rng.normal(0.0, 2.0, 2)])  # as `started` believes: 4.0 * 0.5 s
    truth = []
    for _ in range(frames):
        truth.append(state)
        state = np.array([[1.0, t], [0.0, 1.0]]) @ state + shake @ rng.normal(size=(2, 2))
    places = np.array(truth)
    return places, places[:, 0, :] + rng.normal(0.0, NOISE_M, (frames, 2))


@pytest.mark.parametrize("rate_hz", [10.0, 30.0, 60.0, 200.0])
def test_normalized_errors_are_chi_squared(rate_hz: float) -> None:
    # the normalized squared error of a state (place, rate) has a mean of 2 per axis
    rng = np.random.default_rng(11)
    steps, runs, frames = [], 150, 20
    for _ in range(runs):
        truth, measured = simulated(rng, rate_hz, frames)
        motion = started(measured[0], NOISE_M**2, 4.0)
        for frame in range(1, frames):
            motion = motion.predicted(1.0 / rate_hz, DENSITY)
            motion = motion.corrected(measured[frame] - motion.value, NOISE_M**2)
            error = np.stack([motion.value, motion.rate]) - truth[frame]
            steps.append(np.einsum("ia,ij,ja->a", error, np.linalg.inv(covariance_of(motion)), error))
    per_run = np.array(steps).reshape(runs, -1).mean(axis=1)
    assert per_run.mean() == pytest.approx(2.0, abs=4.0 * per_run.std() / np.sqrt(runs))
    assert per_run.mean() == pytest.approx(2.0, abs=0.15)


@pytest.mark.parametrize("gap_s", [0.05, 0.25, 0.5])
def test_predictions_over_gaps_are_as_unsure_as_they_say(gap_s: float) -> None:
    rng = np.random.default_rng(12)
    errors = []
    for _ in range(600):
        truth, measured = simulated(rng, 1.0 / gap_s, 2)
        ahead = started(measured[0], NOISE_M**2, 4.0).predicted(gap_s, DENSITY)
        errors.append(((ahead.value - truth[1, 0]) ** 2).mean() / ahead.variance)
    assert np.mean(errors) == pytest.approx(1.0, abs=0.15)


@settings(deadline=None)  # the first call loads or compiles the kernel
@given(st.floats(0.001, 0.5), st.floats(0.0, 1.0))
def test_two_predictions_are_one(duration: float, share: float) -> None:
    motion = Motion(np.array([0.3, -0.2]), np.array([1.0, 2.0]), 1e-6, 2e-6, 0.1)
    once = motion.predicted(duration, DENSITY)
    twice = motion.predicted(duration * share, DENSITY).predicted(duration * (1.0 - share), DENSITY)
    np.testing.assert_allclose(twice.value, once.value, atol=1e-12)
    np.testing.assert_allclose(covariance_of(twice), covariance_of(once), rtol=1e-9)


@settings(deadline=None)  # the first call loads or compiles the kernel
@given(st.floats(-0.5, 0.5))
def test_predictions_grow_less_sure_both_ways_and_stay_positive(duration: float) -> None:
    motion = started(np.zeros(2), 1e-6, 4.0).predicted(duration, DENSITY)
    assert (np.linalg.eigvalsh(covariance_of(motion)) > 0.0).all()
    assert motion.variance >= 1e-6


def test_covariances_stay_positive_over_a_long_match() -> None:
    motion = started(np.zeros(1), 1e-6, 4.0)
    for _ in range(20_000):
        motion = motion.predicted(0.005, DENSITY).corrected(np.zeros(1), 1e-6)
    assert (np.linalg.eigvalsh(covariance_of(motion)) > 0.0).all()
    assert motion.variance < 1e-6  # surer than one sighting


def test_a_steady_motion_is_followed_exactly() -> None:
    motion = started(np.array([0.0]), 1e-6, 4.0)
    for frame in range(1, 60):
        motion = motion.predicted(1 / 30, DENSITY)
        motion = motion.corrected(np.array([2.0 * frame / 30]) - motion.value, 1e-6)
    assert motion.rate[0] == pytest.approx(2.0, abs=1e-6)
    assert motion.predicted(0.1, DENSITY).value[0] == pytest.approx(2.0 * (59 / 30 + 0.1), abs=1e-6)
