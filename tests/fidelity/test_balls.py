"""Every cause of a disagreement about a hidden ball, and the area of a ball in the picture."""

import numpy as np
import pytest

from tests.onboard.scenes import Lab, lone_pair
from vision_core.fidelity.balls import BallCause, ball_area_px, compare_balls
from vision_core.fidelity.ceiling import Detection
from vision_core.models.mirror import PAPER_MIRROR
from vision_core.onboard.ray_tracer import BALL
from vision_core.onboard.truth import SeenBall, seen_ball
from vision_core.protocol.messages import HIDDEN, Ball

NEAR, FAR = Ball(61, 121, 6), Ball(99, 121, 1)


def detection(ball_share: float) -> Detection:
    return Detection(np.zeros(10), 0.0, 0.0, ball_share)


@pytest.mark.parametrize(
    ("told", "seen", "exact_view", "distance_mm", "share", "ceiling_share", "cause"),
    [
        (HIDDEN, NEAR, NEAR, 380.0, 1.0, 0.1, BallCause.CEILING),
        (HIDDEN, NEAR, NEAR, 380.0, 1.0, 1.0, BallCause.DETECTION),
        (HIDDEN, NEAR, HIDDEN, 380.0, 0.6, 1.0, BallCause.MODEL),
        (HIDDEN, NEAR, HIDDEN, 380.0, 0.0, 1.0, BallCause.MODULE),
        (NEAR, HIDDEN, NEAR, 380.0, 0.2, 1.0, BallCause.PARTLY),
        (FAR, HIDDEN, FAR, 2500.0, 0.3, 1.0, BallCause.SMALL),
        (NEAR, HIDDEN, NEAR, 380.0, 1.0, 1.0, BallCause.MODULE),
        (NEAR, NEAR, NEAR, 380.0, 1.0, 1.0, None),
    ],
)
def test_why_one_side_says_that_the_ball_is_hidden(
    told: Ball,
    seen: Ball,
    exact_view: Ball,
    distance_mm: float,
    share: float,
    ceiling_share: float,
    cause: BallCause | None,
) -> None:
    truth = SeenBall(distance_mm, 121.0, 2.0 * np.degrees(np.arcsin(21.35 / distance_mm)), share)
    found = compare_balls(told, seen, exact_view, truth, detection(ceiling_share), PAPER_MIRROR, 1.0)
    assert found.cause is cause
    assert found.same_hidden == (cause is None)


def test_directions_are_compared_the_short_way_round() -> None:
    truth = SeenBall(380.0, 0.0, 6.4, 1.0)
    found = compare_balls(
        Ball(61, 359, 6), Ball(60, 1, 7), NEAR, truth, detection(1.0), PAPER_MIRROR, 1.0
    )  # fmt: skip
    assert (found.error_px, found.size_deg) == (1, -1)
    assert found.direction_deg == pytest.approx(-2.0)


@pytest.mark.parametrize("x_m", [0.4, 0.9])
def test_a_balls_area_is_that_of_its_pixels(x_m: float) -> None:
    lab = Lab(lone_pair(), (960, 720))
    scene = lab.scene((0.0, 0.0, 0.0), ball=(x_m, 0.1))
    pixels = int((lab.camera.labels(scene)[0] == BALL).sum())
    assert ball_area_px(seen_ball(scene), lab.mirror, lab.camera.scale) == pytest.approx(pixels, rel=0.1)


@pytest.mark.parametrize(
    ("told", "share", "is_clear", "same"),
    [
        (NEAR, 1.0, True, True),
        (HIDDEN, 0.0, True, True),
        (NEAR, 0.0, True, False),
        (HIDDEN, 1.0, True, False),
        (NEAR, 0.01, False, False),
        (HIDDEN, 0.01, False, True),
    ],
)
def test_an_ideal_camera_sees_what_shows_a_pixel(told: Ball, share: float, *, is_clear: bool, same: bool) -> None:
    truth = SeenBall(380.0, 121.0, 6.4, share)
    found = compare_balls(told, HIDDEN, told, truth, detection(1.0), PAPER_MIRROR, 1.0)
    assert (found.is_clear, found.same_as_ideal) == (is_clear, same)
