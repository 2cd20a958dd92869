"""Steps of single bodies: rolling, walls, collisions, the dribbler."""

import math

import numpy as np
import pytest

from vision_core.capture.synthetic.bodies import NOBODY, STEP_S, Drivers, Tally, new_tally, no_bodies, no_drivers
from vision_core.capture.synthetic.contacts import RESTITUTION_WALL, holds_ball
from vision_core.capture.synthetic.physics import ROLLING_DECELERATION_M_S2, move
from vision_core.geometry import Floats

RADII = np.array([0.09, 0.021])
HALF = np.array([2.0, 2.0])
WALL = np.array([[1.0, -2.0, 1.0, 2.0]])
NO_SOLIDS = np.empty((0, 4))


OMNI = np.array([3.0, 40.0, 0.0])
TWO_WHEELS = np.array([3.0, 40.0, 1.0])


def roll(
    robots: Floats,
    ball: Floats,
    solids: Floats,
    duration_s: float,
    commands: Floats | None = None,
    drivers: Drivers | None = None,
) -> Tally:
    tally = new_tally(len(robots))
    move(
        robots,
        np.zeros((len(robots), 3)) if commands is None else commands,
        drivers or no_drivers(len(robots), OMNI),
        ball,
        solids,
        HALF,
        RADII,
        tally,
        round(duration_s / STEP_S),
    )
    return tally


def driver(
    vx: float, vy: float, turn: float, *, limits: Floats = OMNI, kick: float = 0.0, dribbles: bool = False
) -> Drivers:
    """Of the first and only robot."""
    drivers = no_drivers(1, limits)
    drivers.driven[0], drivers.dribbles[0], drivers.kicks_m_s[0] = True, dribbles, kick
    drivers.wanted[0] = vx, vy, turn
    return drivers


def body(*values: float) -> Floats:
    row: Floats = no_bodies(1)[0]
    row[: len(values)] = values
    return row


def test_a_ball_rolls_until_friction_has_stopped_it() -> None:
    ball = body(0.0, 0.0, 0.0, 0.7, 0.0)
    roll(no_bodies(0), ball, NO_SOLIDS, 5.0)
    assert ball[3] == 0.0
    assert ball[0] == pytest.approx(0.7**2 / (2.0 * ROLLING_DECELERATION_M_S2), rel=0.02)


@pytest.mark.parametrize("speed", [0.5, 3.5, 8.0])
def test_a_ball_bounces_off_a_wall_with_the_coefficient_of_restitution(speed: float) -> None:
    ball = body(0.9, 0.0, 0.0, speed, 0.3)
    roll(no_bodies(0), ball, WALL, 0.2)
    assert ball[0] < 1.0
    assert ball[3] == pytest.approx(-RESTITUTION_WALL * speed, abs=0.2)
    assert ball[4] > 0.2


def test_two_robots_that_meet_stop_where_they_touch() -> None:
    robots = np.array([body(-0.5, 0.0), body(0.5, 0.0)])
    commands = np.array([[1.0, 0.0, 0.0], [-1.0, 0.0, 0.0]])
    roll(robots, body(0.0, 1.5), NO_SOLIDS, 2.0, commands)
    assert math.dist(robots[0, :2], robots[1, :2]) == pytest.approx(0.18, abs=0.005)


def test_the_dribbler_holds_the_ball_and_the_back_does_not() -> None:
    robots = np.array([body(0.0, 0.0)])
    for start, held in ((0.09, True), (-0.115, False)):
        robots[:] = body(0.0, 0.0)
        ball = body(start, 0.0)
        roll(robots, ball, NO_SOLIDS, 0.3, np.array([[0.5, 0.0, 0.0]]))
        assert holds_ball(robots[0], ball, *RADII) is held
    assert not holds_ball(body(0.0, 0.0, math.pi), body(0.09, 0.0), *RADII)


def test_no_ball_stays_inside_a_robot() -> None:
    robots = np.array([body(0.0, 0.0, 0.4)])
    for angle in np.linspace(0.0, math.tau, 40):
        ball = body(0.05 * math.cos(angle), 0.05 * math.sin(angle))
        roll(robots, ball, NO_SOLIDS, 0.1)
        assert math.hypot(*ball[:2]) > 0.085


def test_a_ball_pressed_against_a_wall_does_not_slip_through_and_stops_the_robot() -> None:
    for aside in (0.0, 0.03, 0.06):
        robots = np.array([body(0.7, aside, math.pi)])
        ball = body(0.9, 0.0)
        for _ in range(50):
            roll(robots, ball, WALL, 0.02, np.array([[2.0, 0.0, 0.0]]))
            assert ball[0] < 1.0
            assert math.dist(robots[0, :2], ball[:2]) > 0.1


def test_a_driven_robot_moves_in_its_own_frame() -> None:
    robots = np.array([body(0.0, 0.0, math.pi / 2.0)])
    roll(robots, body(1.5, 1.5), NO_SOLIDS, 2.0, drivers=driver(0.5, 0.2, 0.0))
    assert robots[0, 3:5] == pytest.approx([-0.2, 0.5])
    roll(robots, body(1.5, 1.5), NO_SOLIDS, 1.0, drivers=driver(0.0, 0.0, 1.0))
    assert robots[0, 3:6] == pytest.approx([0.0, 0.0, 1.0], abs=1e-9)


def test_a_driven_robot_accelerates_as_its_wheels_can() -> None:
    robots = np.array([body(0.0, 0.0)])
    roll(robots, body(1.5, 1.5), NO_SOLIDS, 0.1, drivers=driver(2.0, 0.0, 10.0))
    assert robots[0, 3] < 0.31
    assert robots[0, 5] == pytest.approx(4.0)


def test_two_wheels_never_slip_sideways() -> None:
    robots = np.array([body(0.0, 0.0)])
    for _ in range(20):
        roll(robots, body(1.5, 1.5), NO_SOLIDS, 0.1, drivers=driver(0.5, 0.3, 2.0, limits=TWO_WHEELS))
        heading, vx, vy = robots[0, 2:5]
        assert abs(math.cos(heading) * vy - math.sin(heading) * vx) < 0.02
    assert math.hypot(*robots[0, 3:5]) == pytest.approx(0.5, abs=0.02)


def test_a_kick_is_carried_out_when_the_ball_is_at_the_front_and_once() -> None:
    for start, kicked in ((0.09, True), (-0.115, False)):
        robots, ball, drivers = np.array([body(0.0, 0.0)]), body(start, 0.0), driver(0.0, 0.0, 0.0, kick=2.0)
        tally = roll(robots, ball, NO_SOLIDS, 0.1, drivers=drivers)
        assert bool(ball[3] > 1.9) is kicked
        assert bool(drivers.kicks_m_s[0] == 0.0) is kicked
        assert tally.touched[0] == (0 if kicked else NOBODY)


def test_only_a_dribbling_robot_takes_the_ball_along_when_it_turns_away() -> None:
    held = []
    for dribbles in (True, False):
        robots, ball = np.array([body(0.0, 0.0)]), body(0.088, 0.0)
        roll(robots, ball, NO_SOLIDS, 0.5, drivers=driver(0.0, 0.0, 2.0, dribbles=dribbles))
        held.append(holds_ball(robots[0], ball, *RADII))
    assert held == [True, False]


def test_a_contact_that_goes_on_is_one_collision() -> None:
    robots = np.array([body(-0.3, 0.0), body(0.3, 0.0)])
    apart = np.array([[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0]])
    assert roll(robots, body(0.0, 1.5), NO_SOLIDS, 2.0, -apart).collisions[0] == 1
    tally = roll(robots, body(0.0, 1.5), NO_SOLIDS, 0.5, apart)
    assert tally.collisions[0] == 0
    assert not tally.touching.any()
