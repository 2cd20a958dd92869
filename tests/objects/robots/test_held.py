"""Robots of the last frames are held where they should be by now."""

import math

import numpy as np
import pytest

from vision_core.objects.robots.held import MAX_MISSED, HeldRobots, held_robots, hold_read, move_robots
from vision_core.types.tables import MAX_ROBOTS, NO_ID, ROBOT, Table

GAP_S = 0.02


def robots_of(*robots: tuple[int, int, float, float]) -> Table:
    """ROBOT table of team, id, x [m] and heading [rad]."""
    table = np.zeros(MAX_ROBOTS, dtype=ROBOT)
    for row, (team, number, x_m, heading_rad) in enumerate(robots):
        table[row]["team"], table[row]["id"] = team, number
        table[row]["x_m"], table[row]["heading_rad"] = x_m, heading_rad
    return table


def follow(held: HeldRobots, *robots: tuple[int, int, float, float], gap_s: float = GAP_S) -> bool:
    move_robots(held, gap_s)
    return hold_read(held, gap_s, robots_of(*robots), len(robots))


def places(held: HeldRobots) -> list[tuple[float, float]]:
    rows = held.robots[: held.size[0]]
    return [(float(row["x_m"]), float(row["heading_rad"])) for row in rows]


def test_a_missing_robot_is_held_where_it_should_be() -> None:
    held = held_robots()
    assert not follow(held, (0, 3, 1.0, 3.0), (1, 3, -1.0, 0.0), gap_s=-1.0)
    assert not follow(held, (0, 3, 1.1, -3.0), (1, 3, -1.0, 0.0))
    assert follow(held, (1, 3, -1.0, 0.0))
    assert follow(held, (1, 3, -1.0, 0.0))
    turn = 2.0 * math.pi - 6.0
    assert places(held) == [pytest.approx((1.3, -3.0 + 2.0 * turn)), (-1.0, 0.0)]
    # it is read again: its speed is that since the frame before
    assert not follow(held, (0, 3, 1.5, -3.0 + 3.0 * turn), (1, 3, -1.0, 0.0))
    assert follow(held, (1, 3, -1.0, 0.0))
    assert places(held)[0] == pytest.approx((1.7, -3.0 + 4.0 * turn))


def test_one_that_stays_away_is_given_up() -> None:
    held = held_robots()
    follow(held, (0, 3, 1.0, 0.0), gap_s=-1.0)
    assert [follow(held) for _ in range(MAX_MISSED + 1)] == [True] * MAX_MISSED + [False]
    assert places(held) == []


def test_a_single_picture_forgets_those_before() -> None:
    held = held_robots()
    follow(held, (0, 3, 1.0, 0.0), gap_s=-1.0)
    assert not follow(held, (0, 4, 2.0, 0.0), gap_s=-1.0)
    assert places(held) == [(2.0, 0.0)]


def test_only_what_is_read_is_held() -> None:
    held = held_robots()
    follow(held, (0, NO_ID, 1.0, 0.0), (0, 5, 2.0, math.nan), gap_s=-1.0)
    assert places(held) == []


def test_one_that_its_shape_shows_is_missing_no_more() -> None:
    held = held_robots()
    follow(held, (0, 3, 1.0, 0.0), gap_s=-1.0)
    assert follow(held)
    assert not hold_read(held, GAP_S, robots_of((0, 3, 1.1, 0.0), (0, 4, 2.0, 0.0)), 2)
    assert not follow(held, (0, 3, 1.2, 0.0), (0, 4, 2.0, 0.0))
    assert follow(held)
    assert places(held) == [pytest.approx((1.3, 0.0)), (2.0, 0.0)]
