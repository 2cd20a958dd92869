"""One drawing per rule of ``vision_core.views`` for the ball.

Field ssl-2002 unless said; robots of radius 0.09, ball 0.02135.
"""

import dataclasses
import math

import numpy as np
import pytest

from tests.views.scenes import BALL_RADIUS, Observer, fields, obstacle, robot, with_squares, world
from tests.views.scenes import ball as ball_at
from vision_core.types.objects import Team
from vision_core.types.tracks import RobotTrack
from vision_core.types.views import BallView
from vision_core.views.ball import circle_shadow, segment_shadow

WALLED = Observer(fields()["walls"])
SQUARES = Observer(fields()["walls"], with_squares())
OPEN = Observer(fields()["open"])
OWN = robot(Team.BLUE, 1, 0.0, 0.0)


def seen(x: float, y: float, *others: RobotTrack, own: RobotTrack = OWN) -> BallView | None:
    view = WALLED.observe(world(own, *others, ball=ball_at(x, y)), Team.BLUE, 1)
    assert view is not None
    return view.ball


def test_a_free_ball() -> None:
    view = seen(0.3, 0.4)
    assert view is not None
    assert view.distance_m == pytest.approx(0.5)
    assert view.direction_deg == pytest.approx(math.degrees(math.atan2(4.0, 3.0)))
    assert view.size_deg == pytest.approx(2.0 * math.degrees(math.asin(BALL_RADIUS / 0.5)))
    assert not view.partial


def test_the_papers_sample_ball_spans_six_degrees() -> None:
    # mirror.md: 61 px is 373..385 mm, and a 42.7 mm ball there spans 6.4 degrees
    view = seen(0.379, 0.0)
    assert view is not None
    assert round(view.size_deg, 1) in {6.4, 6.5}


def test_direction_is_from_the_heading_and_never_360() -> None:
    view = seen(0.0, 0.5, own=robot(Team.BLUE, 1, 0.0, 0.0, math.pi / 2 + 0.1))
    assert view is not None
    assert view.direction_deg == pytest.approx(360.0 - math.degrees(0.1))
    just_right = seen(0.5, -1e-18)
    assert just_right is not None
    assert just_right.direction_deg == 0.0


def test_a_ball_behind_a_robot_is_hidden_and_before_it_is_not() -> None:
    #  o   (#)   .          o   .   (#)
    assert seen(0.9, 0.0, robot(Team.YELLOW, 1, 0.5, 0.0)) is None
    view = seen(0.3, 0.0, robot(Team.YELLOW, 1, 0.5, 0.0))
    assert view is not None
    assert not view.partial


def test_a_ball_half_behind_a_robot_is_partial_with_its_full_size() -> None:
    # the robot's rim at asin(0.09 / 0.5) goes through the ball's center
    rim = math.asin(0.09 / 0.5)
    view = seen(0.9 * math.cos(rim), 0.9 * math.sin(rim), robot(Team.YELLOW, 1, 0.5, 0.0))
    assert view is not None
    assert view.partial
    assert view.direction_deg == pytest.approx(math.degrees(rim))
    assert view.size_deg == pytest.approx(2.0 * math.degrees(math.asin(BALL_RADIUS / 0.9)))


def test_visibility_is_exact_not_sampled() -> None:
    # both rims of the ball are a thousandth of a degree inside, then outside of the robot's rims
    alpha, sliver = math.asin(BALL_RADIUS / 0.9), math.radians(0.001)
    blocker = robot(Team.YELLOW, 1, 0.5, 0.0)
    for slack, hidden in ((-sliver, True), (sliver, False)):
        at = math.asin(0.09 / 0.5) - alpha + slack
        assert (seen(0.9 * math.cos(at), 0.9 * math.sin(at), blocker) is None) == hidden


def test_two_robots_hide_together_what_neither_hides_alone() -> None:
    #      (#)
    #  o         .
    #      (#)          each hides a half, and they overlap by 0.01 m
    above, below = robot(Team.BLUE, 2, 0.5, 0.085), robot(Team.BLUE, 3, 0.5, -0.085)
    for alone in (above, below):
        view = seen(1.0, 0.0, alone)
        assert view is not None
        assert view.partial
    assert seen(1.0, 0.0, above, below) is None


def test_a_gap_between_two_robots_shows_the_ball() -> None:
    view = seen(1.0, 0.0, robot(Team.BLUE, 2, 0.5, 0.095), robot(Team.BLUE, 3, 0.5, -0.095))
    assert view is not None
    assert view.partial


def test_a_dribbled_ball_is_not_hidden_by_the_own_outline() -> None:
    view = seen(0.085, 0.0)
    assert view is not None
    assert not view.partial
    assert view.distance_m == pytest.approx(0.085)  # not moved out to r_min: that is for edges


@pytest.mark.parametrize("distance", [0.0, 0.01, BALL_RADIUS])
def test_a_ball_under_the_viewer_spans_half_a_turn(distance: float) -> None:
    view = seen(distance, 0.0)
    assert view is not None
    assert view.size_deg == 180.0
    assert not view.partial


def test_under_another_robot_nothing_is_seen() -> None:
    assert seen(0.5, 0.0, robot(Team.YELLOW, 1, -0.05, 0.0)) is None


def test_walls_hide_and_limits_do_not() -> None:
    assert seen(0.0, 1.3) is None
    open_view = OPEN.observe(world(OWN, ball=ball_at(0.0, 1.6)), Team.BLUE, 1)  # the limit is at 1.48
    assert open_view is not None
    assert open_view.ball is not None
    assert not open_view.ball.partial


def test_a_goals_side_hides_from_outside_and_its_mouth_is_open() -> None:
    beside = OPEN.observe(world(robot(Team.BLUE, 1, 1.59, 0.9), ball=ball_at(1.59, 0.3)), Team.BLUE, 1)
    assert beside is not None
    assert beside.ball is None
    before = OPEN.observe(world(OWN, ball=ball_at(1.6, 0.0)), Team.BLUE, 1)
    assert before is not None
    assert before.ball is not None


def test_a_ball_that_touches_a_wall_is_wholly_visible() -> None:
    view = seen(0.2, 1.15 - BALL_RADIUS)
    assert view is not None
    assert not view.partial


def test_obstacles_and_squares_hide_the_ball() -> None:
    here = world(OWN, ball=ball_at(0.9, 0.0))
    assert WALLED.observe(here, Team.BLUE, 1) is not None
    behind = WALLED.observe(dataclasses.replace(here, obstacles=(obstacle(0.5, 0.0, 0.05),)), Team.BLUE, 1)
    assert behind is not None
    assert behind.ball is None
    # a square of sides 0.22 at 0.5: straight it spans +-15.8 degrees, at 45 degrees +-17.3
    for heading, at, hidden in ((0.0, 14.0, True), (0.0, 18.0, False), (math.pi / 4, 15.5, True)):
        place = ball_at(0.9 * math.cos(math.radians(at)), 0.9 * math.sin(math.radians(at)))
        view = SQUARES.observe(world(OWN, robot(Team.YELLOW, 1, 0.5, 0.0, heading), ball=place), Team.BLUE, 1)
        assert view is not None
        assert (view.ball is None) == hidden


def test_no_ball_in_the_world_is_no_ball_in_the_view() -> None:
    view = WALLED.observe(world(OWN), Team.BLUE, 1)
    assert view is not None
    assert view.ball is None


def test_a_circles_shadow_grows_from_its_near_side_to_its_tangents() -> None:
    # radius 0.3 at 0.5: near side 0.2, tangent length 0.4
    assert circle_shadow(0.5, 0.0, 0.3, 0.2)[1] == 0.0
    assert circle_shadow(0.0, 0.5, 0.3, 0.4) == pytest.approx((math.pi / 2, math.asin(0.6)))
    halves = [circle_shadow(0.5, 0.0, 0.3, within)[1] for within in np.linspace(0.2, 0.4, 50)]
    assert (np.diff(halves) > 0.0).all()
    assert circle_shadow(0.5, 0.0, 0.3, 9.0)[1] == pytest.approx(math.asin(0.6))
    assert circle_shadow(0.2, 0.0, 0.3, 0.4)[1] == math.pi


def test_a_segments_shadow_is_what_lies_within() -> None:
    # x = 1 from y = -1 to 1: within sqrt(2) all of it, +-45 degrees; within 2 / sqrt(3), +-30 degrees; within 1 nothing
    for within, half in ((9.0, 45.0), (math.sqrt(2.0) + 1e-12, 45.0), (2.0 / math.sqrt(3.0), 30.0)):
        assert segment_shadow(1.0, -1.0, 1.0, 1.0, within) == pytest.approx((0.0, math.radians(half)), abs=1e-6)
    assert segment_shadow(1.0, -1.0, 1.0, 1.0, 1.0) == (0.0, 0.0)
    # across the negative x axis, where angles wrap
    direction, half_width = segment_shadow(-1.0, 1.0, -1.0, -1.0, 9.0)
    assert math.cos(direction) == pytest.approx(-1.0)
    assert half_width == pytest.approx(math.radians(45.0))
