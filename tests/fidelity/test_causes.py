"""Every cause has a world made by hand whose disagreement lands in it, and in no other."""

from dataclasses import replace

import pytest

from tests.fidelity.scenes import Lab, cause_at, changed, exact
from vision_core.fidelity.causes import Cause, Evidence
from vision_core.fidelity.reports import Report

AHEAD = 0


@pytest.fixture(scope="module")
def lab() -> Lab:
    return Lab()


@pytest.fixture(scope="module")
def facing(lab: Lab) -> Evidence:
    """Half a metre ahead, yellow 5 turns its flat front to the viewer; a wall stands 1.4 m behind the viewer."""
    return lab.truth(lab.snapshot((0.0, 0.0, 0.0), (0.5, 0.0, 3.1416)))


def wall(truth: Evidence, direction: int) -> float:
    return float(exact(truth).radii_px[direction])


def test_sides_that_agree_need_no_cause(facing: Evidence) -> None:
    assert cause_at(180, exact(facing), exact(facing), facing) is None


def test_a_robots_flat_front_is_the_models(facing: Evidence) -> None:
    assert cause_at(AHEAD, facing.exact_view, exact(facing), facing) is Cause.OUTLINE


def test_a_robot_seen_beside_its_place_is_a_detection_error(lab: Lab, facing: Evidence) -> None:
    beside = lab.truth(lab.snapshot((0.0, 0.0, 0.0), (0.5, 0.15, 0.0))).exact_view
    assert cause_at(352, beside, exact(facing), facing) is Cause.DETECTION


def test_two_small_errors_of_opposite_sign_are_quantization(facing: Evidence) -> None:
    px = wall(facing, 90)
    whole = float(int(px)) + 0.5
    told, seen = (changed(exact(facing), 90, "w", whole + error, 3) for error in (1.0, -1.0))
    assert cause_at(90, told, seen, facing) is Cause.QUANTIZATION


def test_a_border_one_direction_aside_on_both_sides_is_an_edge(facing: Evidence) -> None:
    letters = exact(facing).letters
    border = next(i for i in range(60) if letters[i] == "y" and letters[i + 1] != "y")
    robot, beyond = (exact(facing).radii_px[i] for i in (border, border + 1))
    told = changed(exact(facing), border + 1, "y", float(robot), 0)
    seen = changed(exact(facing), border, "w", float(beyond), 0)
    seen = replace(seen, letters=seen.letters.copy())
    seen.letters[border - 1], seen.radii_px[border - 1] = "w", beyond
    assert cause_at(border + 1, told, exact(facing), facing) is None
    assert {cause_at(place, told, seen, facing) for place in (border, border + 1)} <= {None, Cause.EDGE}
    assert Cause.EDGE in {cause_at(place, told, seen, facing) for place in range(border - 1, border + 2)}


def test_what_the_own_body_hides(lab: Lab) -> None:
    truth = lab.truth(lab.snapshot((0.0, 0.0, 0.0), (0.187, 0.0, 0.0)))
    seen = changed(exact(truth), AHEAD, "y", truth.nearest_px + 1.0)
    assert cause_at(AHEAD, exact(truth), seen, truth) is Cause.OWN_BODY


def test_a_line_at_the_walls_foot(lab: Lab) -> None:
    truth = lab.truth(lab.snapshot((1.2, 0.5, 0.0), (0.0, 0.0, 0.0)))
    assert truth.line_mm == pytest.approx(10.0)
    px = lab.mirror.px_from_mm(200.0 - 10.0)
    assert cause_at(AHEAD, exact(truth), changed(exact(truth), AHEAD, "w", px, 3), truth) is Cause.WALL_LINE


def test_a_ball_before_a_walls_foot(lab: Lab) -> None:
    truth = lab.truth(lab.snapshot((0.0, 0.5, 0.0), (0.0, -0.9, 0.0), ball=(1.37, 0.5)))
    px = wall(truth, AHEAD)
    assert cause_at(AHEAD, exact(truth), changed(exact(truth), AHEAD, "w", px + 2.0), truth) is Cause.BALL


def test_a_wall_seen_over_a_low_robot(facing: Evidence) -> None:
    seen = changed(exact(facing), AHEAD, "v", facing.mirror.px_from_mm(2500.0), 3)
    assert cause_at(AHEAD, exact(facing), seen, facing) is Cause.SEEN_OVER


def test_a_thing_beyond_a_limit() -> None:
    lab = Lab("league")
    truth = lab.truth(lab.snapshot((3.0, 2.0, 0.0), (0.0, 0.0, 0.0)))
    seen = changed(exact(truth), AHEAD, "q", wall(truth, AHEAD) + 8.0)
    assert cause_at(AHEAD, exact(truth), seen, truth) is Cause.BEYOND


@pytest.mark.parametrize(
    ("letter", "further_px", "cause"),
    [
        ("y", 2.5, Cause.MODULE_PLACE),
        ("v", 4.0, Cause.MODULE_SIDE),
        ("y", -15.0, Cause.UNEXPLAINED),
        ("w", -15.0, Cause.UNEXPLAINED),
    ],
)
def test_errors_of_the_onboard_module(facing: Evidence, letter: str, further_px: float, cause: Cause) -> None:
    told: Report = exact(facing)
    seen = changed(told, AHEAD, letter, wall(facing, AHEAD) + further_px)
    assert cause_at(AHEAD, told, seen, facing) is cause
