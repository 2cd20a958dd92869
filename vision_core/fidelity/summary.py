"""A tally as numbers."""

from collections import Counter
from itertools import pairwise
from typing import Any

import numpy as np

from vision_core.fidelity.balls import BallCause
from vision_core.fidelity.causes import Cause
from vision_core.fidelity.experiment import RANGES_MM, Tally


def numbers(tally: Tally) -> dict[str, Any]:
    """Everything that was counted, for JSON. What was not measured, for there was none of it, is None."""
    counted: dict[str, Any] = {
        "field": tally.setup.field,
        "ceiling": tally.setup.ceiling,
        "onboard_px": list(tally.setup.onboard_px),
        "high_robots": tally.setup.tall,
        "worlds": tally.worlds,
        "unserved_worlds": len(tally.unserved),
    }
    if not tally.comparisons:
        return counted
    return counted | {
        "same_type": tally.share_of_type(),
        "within_1_px": tally.share_within(1.0),
        "error_p95_px": tally.error_px(95.0),
        "causes": {str(cause): tally.share_of(cause) for cause in Cause},
        "ranges": [_range(tally, low, high) for low, high in pairwise(RANGES_MM)],
        "ball": _ball(tally),
    }


def _range(tally: Tally, low_mm: float, high_mm: float) -> dict[str, Any]:
    balls, seen, told = tally.balls_seen(low_mm, high_mm)
    return {
        "from_mm": low_mm,
        "to_mm": high_mm,
        "ceiling_rms_mm": _or_none(tally.rms_mm("ceiling_mm", low_mm, high_mm)),
        "onboard_rms_mm": _or_none(tally.rms_mm("onboard_mm", low_mm, high_mm)),
        "balls": balls,
        "balls_seen_on_board": seen,
        "balls_told": told,
    }


def _ball(tally: Tally) -> dict[str, Any]:
    balls = [each.ball for each in tally.comparisons]
    both = [ball for ball in balls if ball.told and ball.seen]
    causes = Counter(ball.cause for ball in balls)
    return {
        "same_hidden": list(tally.hidden_agreement()),
        "same_as_ideal_camera": list(tally.hidden_agreement(ideal=True)),
        "clear_same_hidden": list(tally.hidden_agreement(clear=True)),
        "clear_same_as_ideal_camera": list(tally.hidden_agreement(clear=True, ideal=True)),
        "causes": {str(cause): causes[cause] for cause in BallCause},
        "seen_by_both": len(both),
        "within_1_px": _share([ball.error_px for ball in both]),
        "within_1_deg": _share([ball.direction_deg for ball in both]),
        "size_within_1_deg": _share([ball.size_deg for ball in both]),
    }


def _share(errors: list[Any]) -> float | None:
    """The share of errors of at most 1."""
    return float((np.abs(np.array(errors, dtype=np.float64)) <= 1.0).mean()) if errors else None


def _or_none(value: float) -> float | None:
    return value if np.isfinite(value) else None
