"""What becomes of every blob of the ball's color. Slow, and never on the hot path."""

from collections.abc import Iterator

import numpy as np

from vision_core.objects.ball.finder import (
    GATES,
    OFF_FIELD,
    PASSED,
    TOO_LARGE,
    TOO_SMALL,
    BallFinder,
    judged,
    stopping_gate,
)
from vision_core.objects.ball.reasons import found_and_accepted
from vision_core.objects.observation import Observation
from vision_core.objects.verdicts import size_words
from vision_core.types.overlay import Hypothesis
from vision_core.types.tables import Table

BALL = "ball"


def ball_verdicts(
    seen: Observation, robots: Table, robot_count: int, finder: BallFinder
) -> Iterator[tuple[int, Hypothesis]]:
    """Of every blob of the ball's color: how many gates it passed, and the verdict. The arguments of ``find_balls``."""
    for blob in seen.blobs[: seen.blob_count]:
        if blob["color"] != finder.color:
            continue
        candidate = judged(blob, seen, robots, robot_count, finder)
        gate = stopping_gate(candidate, finder)
        found, accepted = "", ""
        if gate in (TOO_SMALL, TOO_LARGE):
            expected_px = float(blob["area_px"]) / candidate.area_ratio
            shares = (finder.min_area, finder.max_area)
            found, accepted = size_words(float(blob["area_px"]), expected_px, shares, is_disc=True)
        elif gate != PASSED:
            found, accepted = found_and_accepted(gate, candidate, finder)
        radius_px = finder.radius_m * candidate.scale
        yield (
            gate,
            Hypothesis(
                what=BALL,
                id=None,
                is_accepted=gate == PASSED,
                x_px=float(blob["x_px"]),
                y_px=float(blob["y_px"]),
                radius_px=radius_px if np.isfinite(radius_px) else 0.0,
                box_px=tuple(blob[["left", "top", "right", "bottom"]].tolist()),
                confidence=float(candidate.confidence) if gate > OFF_FIELD else None,
                gate="" if gate == PASSED else GATES[gate],
                found=found,
                accepted=accepted,
            ),
        )
