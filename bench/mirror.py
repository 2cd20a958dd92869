"""Fitting the mirror's constants: 200 seeded trials of 40 pairs with noise, outliers and a doubtful focal length.

Distances are uniform over 0.1..2.5 m; radii have 0.5 px of noise, and a tenth of them lies 20 px farther out or in. The
focal length is known to 10 %. The error of a trial is the largest one of the curve between 0.1 and 2.5 m.

The baseline is the Cramer-Rao floor of the same trials: errors drawn from the smallest covariance that any unbiased
estimate can have which knows the outliers.
"""

from dataclasses import dataclass

import numpy as np

from bench.runner import Row
from vision_core.calibration.mirror.fit import FocalPrior, fit_mirror, jacobian, radii_of
from vision_core.calibration.mirror.pairs import Pairs, pairs_of
from vision_core.calibration.mirror.rounding import Rounding
from vision_core.geometry import Floats, Mask
from vision_core.models.hyperboloid import Hyperboloid
from vision_core.models.mirror import PAPER_MIRROR, Mirror

TRIALS = 200
PAIRS, OUTLIERS = 40, 4
NOISE_PX, BESIDE_PX, FOCAL_SHARE = 0.5, 20.0, 0.1
SPAN_MM = np.linspace(100.0, 2500.0, 241)
MAX_MEDIAN_PX, MAX_P95_PX = 0.2, 0.5


@dataclass(frozen=True, slots=True, eq=False)
class Trial:
    """Pairs of a mirror."""

    pairs: Pairs
    prior: FocalPrior
    is_outlier: Mask
    floor_px: float
    """Largest error of the curve in a draw from the Cramer-Rao covariance."""


def trial(seed: int, mirror: Mirror = PAPER_MIRROR) -> Trial:
    """The pairs of a seed."""
    random = np.random.default_rng(seed)
    distances = random.uniform(SPAN_MM[0], SPAN_MM[-1], PAIRS)
    radii = mirror.px_from_mm(distances) + random.normal(0.0, NOISE_PX, PAIRS)
    is_outlier = random.permutation(PAIRS) < OUTLIERS
    radii[is_outlier] += BESIDE_PX * random.choice([-1.0, 1.0], OUTLIERS)
    shape = Hyperboloid.of(mirror)
    prior = FocalPrior(shape.focal_px * (1.0 + FOCAL_SHARE * random.normal()), FOCAL_SHARE)
    names = tuple(f"row {number}" for number in range(1, PAIRS + 1))
    rows = list(zip(np.maximum(radii, 0.5).tolist(), distances.tolist(), strict=True))
    pairs = pairs_of(rows, names, Rounding.EXACT)
    return Trial(pairs, prior, is_outlier, _floor_px(random, shape, distances[~is_outlier]))


def curve_error_px(found: Hyperboloid, mirror: Mirror) -> float:
    """Largest difference of the curves between 0.1 and 2.5 m."""
    return float(np.abs(radii_of(found, SPAN_MM) - mirror.px_from_mm(SPAN_MM)).max())


def run() -> list[Row]:
    """Fit every trial."""
    errors, floors, named, false = [], [], 0, 0
    for seed in range(TRIALS):
        shown = trial(seed)
        found = fit_mirror(shown.pairs, shown.prior)
        errors.append(curve_error_px(found.shape, PAPER_MIRROR))
        floors.append(shown.floor_px)
        named += int((~found.kept & shown.is_outlier).sum())
        false += int((~found.kept & ~shown.is_outlier).sum())
    rows = []
    for name, share, most in (("p50", 50.0, MAX_MEDIAN_PX), ("p95", 95.0, MAX_P95_PX)):
        value, floor = float(np.percentile(errors, share)), float(np.percentile(floors, share))
        row = {"name": f"largest error of the curve, {name}", "value": value, "unit": "px", "baseline": floor}
        rows.append(row | {"ratio": value / floor, "goal": f"<= {most:g}", "met": value <= most})
    planted, good = TRIALS * OUTLIERS, TRIALS * (PAIRS - OUTLIERS)
    rows.append(_count("outliers named", named, planted, named == planted, "all"))
    rows.append(_count("good pairs named as outliers", false, good, false <= 0.01 * good, "<= 1 %"))
    return rows


def _count(name: str, value: int, of: int, met: bool, goal: str) -> Row:
    return {"name": name, "value": value, "unit": f"of {of}", "goal": goal, "met": met}


def _floor_px(random: np.random.Generator, shape: Hyperboloid, distances_mm: Floats) -> float:
    """A draw from the covariance of an efficient estimate by the good pairs and the prior: its largest error."""
    logs = np.log([shape.height_mm, shape.bend, shape.focal_px])
    design = jacobian(logs, distances_mm) / NOISE_PX
    information = design.T @ design + np.diag([0.0, 0.0, FOCAL_SHARE**-2])
    draw = random.multivariate_normal(np.zeros(3), np.linalg.inv(information))
    return float(np.abs(jacobian(logs, SPAN_MM) @ draw).max())
