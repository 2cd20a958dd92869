"""Calibration of the camera from painted lines: 200 rendered pictures by cameras with random lens and pose.

The camera hangs at about 4 m, a pixel covers about 5 mm; lens distortion, robots and clutter are in the picture
(``calibration_views``). Each picture is calibrated twice: from a camera that is off by up to 3 degrees and 100 mm in
every angle and coordinate, and without a click. The error is the largest on the field's floor, against the camera
that took the picture; without a click, whichever end of the field is left.

*Converged* is a result that is accepted and at most 5 mm wrong; *wrong but accepted* is one that is more wrong.
"""

import time
from collections.abc import Sequence

import numpy as np

from bench.calibration_views import floor_error_m, view
from bench.runner import Row
from vision_core.calibration.result import Calibration
from vision_core.calibration.solve import calibrate
from vision_core.calibration.start import start_from_lens

TRIALS = 200
CONVERGED_M = 0.005
GOALS = {"from a start": 0.99, "without a click": 0.95}
"""Least share of converged trials."""

Trial = tuple[Calibration, float, float]
"""Result, largest floor error [m], time [s]."""


def run() -> list[Row]:
    """Calibrate every picture from a start and without a click."""
    trials: dict[str, list[Trial]] = {name: [] for name in GOALS}
    for seed in range(TRIALS):
        shown = view(seed)
        field, size = shown.settings.field, (shown.pixels.shape[1], shown.pixels.shape[0])
        for name, start in zip(GOALS, (start_from_lens(shown.start, size), None), strict=True):
            begin = time.process_time()
            result = calibrate([shown.pixels], field, start)
            seconds = time.process_time() - begin
            trials[name].append((result, floor_error_m(result.camera, shown.truth, field), seconds))
    return [row for name, done in trials.items() for row in _rows(name, done)]


def _rows(name: str, trials: Sequence[Trial]) -> list[Row]:
    accepted = np.array([result.accepted for result, _, _ in trials])
    errors = np.array([error for _, error, _ in trials])
    rms, seconds = (np.array(column) for column in zip(*((t[0].rms_px, t[2]) for t in trials), strict=True))
    converged = accepted & (errors <= CONVERGED_M)
    p50, p95 = (float(np.percentile(errors[accepted] * 1e3, q)) for q in (50, 95))
    share, wrong = float(converged.mean()), int((accepted & ~converged).sum())
    worst_rms, slowest = float(rms[accepted].max()), float(np.percentile(seconds, 95))
    return [
        _row(f"{name}: worst floor error, p50", p50, "mm", "<= 2", p50 <= 2.0),
        _row(f"{name}: worst floor error, p95", p95, "mm", "<= 3", p95 <= 3.0),
        _row(f"{name}: converged", share, "", f">= {GOALS[name]:g}", share >= GOALS[name]),
        _row(f"{name}: wrong but accepted", wrong, "of 200", "0", wrong == 0),
        _row(f"{name}: reprojection rms, worst", worst_rms, "px", "<= 0.5", worst_rms <= 0.5),
        _row(f"{name}: processor time, p95", slowest, "s", "< 1", slowest < 1.0),
    ]


def _row(name: str, value: float, unit: str, goal: str, met: bool) -> Row:
    return {"name": name, "value": value, "unit": unit, "goal": goal, "met": met}
