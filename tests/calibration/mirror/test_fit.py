"""The fit reaches the goals of the benchmark on its first trials, and its covariance is that of its errors."""

import numpy as np
import pytest

from bench.mirror import NOISE_PX, SPAN_MM, curve_error_px, trial
from vision_core.calibration.mirror.fit import FocalPrior, fit_mirror, jacobian, radii_of
from vision_core.calibration.mirror.pairs import Pairs, pairs_of
from vision_core.calibration.mirror.rounding import Rounding
from vision_core.models.hyperboloid import Hyperboloid
from vision_core.models.mirror import PAPER_MIRROR, Mirror

VSSS = Hyperboloid(500.0, 150.0, 1.6).mirror()
LARGE = Hyperboloid(600.0, 800.0, 1.6).mirror()
SEEDS = range(20)


def exact(mirror: Mirror, distances_mm: list[float]) -> Pairs:
    rows = [(mirror.px_from_mm(distance), distance) for distance in distances_mm]
    return pairs_of(rows, rounding=Rounding.EXACT)


@pytest.mark.parametrize("mirror", [PAPER_MIRROR, VSSS, LARGE], ids=["paper", "vsss", "large"])
def test_trials_reach_the_goals_and_name_the_outliers(mirror: Mirror) -> None:
    errors = []
    for seed in SEEDS:
        shown = trial(seed, mirror)
        found = fit_mirror(shown.pairs, shown.prior)
        errors.append(curve_error_px(found.shape, mirror))
        assert not found.kept[shown.is_outlier].any()
        assert found.noise_px == pytest.approx(NOISE_PX, rel=0.5)
    assert np.median(errors) <= 0.25
    assert np.percentile(errors, 95) <= 0.5


def test_the_curve_is_as_wrong_as_the_covariance_says() -> None:
    normed = []
    for seed in SEEDS:
        shown = trial(seed)
        found = fit_mirror(shown.pairs, shown.prior)
        off = radii_of(found.shape, SPAN_MM) - PAPER_MIRROR.px_from_mm(SPAN_MM)
        normed.append(off / found.deviation_px(SPAN_MM))
    assert 0.7 < np.sqrt(np.mean(np.square(normed))) < 1.3


def test_the_jacobian_is_the_derivative() -> None:
    logs = np.log([219.0, 1.739, 300.0])
    for parameter in range(3):
        step = np.zeros(3)
        step[parameter] = 1e-6
        high, low = (Hyperboloid(f, h, u) for h, u, f in (np.exp(logs + step), np.exp(logs - step)))
        measured = (radii_of(high, SPAN_MM) - radii_of(low, SPAN_MM)) / 2e-6
        assert jacobian(logs, SPAN_MM)[:, parameter] == pytest.approx(measured, abs=1e-5)


def test_the_covariance_of_the_constants_follows_from_that_of_the_shape() -> None:
    found = fit_mirror(exact(PAPER_MIRROR, [100.0, 200.0, 300.0, 500.0, 900.0, 2000.0]), FocalPrior(300.0, 0.1))
    draws = np.random.default_rng(1).multivariate_normal(found.logs, found.covariance * 1e-4, 4000)
    constants = np.array([Hyperboloid(f, h, u).constants for h, u, f in np.exp(draws)])
    sampled = np.sqrt(np.diag(np.cov(constants.T))) * 1e2
    assert np.sqrt(np.diag(found.constants_covariance())) == pytest.approx(sampled, rel=0.1)


@pytest.mark.parametrize("mirror", [PAPER_MIRROR, VSSS, LARGE], ids=["paper", "vsss", "large"])
def test_a_known_focal_length_gives_the_constants(mirror: Mirror) -> None:
    pairs = exact(mirror, np.geomspace(100.0, 2500.0, 12).tolist())
    found = fit_mirror(pairs, FocalPrior(Hyperboloid.of(mirror).focal_px, 1e-3))
    assert found.shape.constants == pytest.approx((mirror.a, mirror.b, mirror.c), rel=5e-3)
    assert curve_error_px(found.shape, mirror) < 1e-3


def test_whole_radii_are_fitted_without_bias() -> None:
    distances = np.linspace(100.0, 2500.0, 200).tolist()
    rows = [(float(int(PAPER_MIRROR.px_from_mm(distance))), distance) for distance in distances]
    assert curve_error_px(fit_mirror(pairs_of(rows), FocalPrior()).shape, PAPER_MIRROR) < 0.2
    biased = fit_mirror(pairs_of(rows, rounding=Rounding.EXACT), FocalPrior())
    assert curve_error_px(biased.shape, PAPER_MIRROR) > 0.3
