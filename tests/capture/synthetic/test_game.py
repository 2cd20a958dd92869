"""Goals, possession and collisions of the simulated match."""

import math

import numpy as np
import pytest

from vision_core.capture.synthetic.game import GameCount
from vision_core.capture.synthetic.world import World
from vision_core.clock import NS_PER_S, Instant
from vision_core.models.field import goal_line_x
from vision_core.types.drives import no_drives
from vision_core.types.objects import Team
from vision_core.venues.loader import load_settings

PERIOD_S = 1.0 / 30.0


def test_goals_are_those_that_the_ball_shows() -> None:
    settings = load_settings(options={"synthetic.seed": 3})
    world, line, inside, last = World(settings), goal_line_x(settings.field), 0, -math.inf
    goals = {Team.BLUE: 0, Team.YELLOW: 0}
    for frame in range(9000):
        world.advance(PERIOD_S)
        x = float(world.snapshot().ball[0])
        side = int(np.sign(x)) if abs(x) > line else 0
        if side and not inside and frame > last + 31:  # blue defends the left
            goals[Team.BLUE if side > 0 else Team.YELLOW] += 1
            last = frame
        inside = side
    game = world.game
    assert (game.blue.goals, game.yellow.goals) == (goals[Team.BLUE], goals[Team.YELLOW])
    assert sum(goals.values()) > 2
    assert game.collisions > 0
    assert 0.0 < game.blue.possession_s + game.yellow.possession_s < game.played_s == pytest.approx(300.0, abs=0.1)


def test_the_team_that_touched_the_ball_last_possesses_it() -> None:
    count = GameCount([Team.BLUE, Team.YELLOW])
    count.pass_time(1.0)
    for robot, duration_s in ((0, 2.0), (1, 3.0)):
        count.tally.touched[0] = robot
        count.pass_time(duration_s)
    count.lose_ball()
    count.pass_time(4.0)
    game = count.report()
    assert (game.played_s, game.blue.possession_s, game.yellow.possession_s, game.owner) == (10.0, 2.0, 3.0, None)


def test_a_new_game_begins_at_nothing_and_the_robots_stay() -> None:
    world = World(load_settings())
    for _ in range(900):
        world.advance(PERIOD_S)
    before = world.snapshot()
    world.begin_game()
    after = world.snapshot()
    assert (world.game.played_s, world.game.collisions, world.game.blue.possession_s) == (0.0, 0, 0.0)
    assert np.array_equal(before.robots, after.robots)
    assert not np.array_equal(before.ball, after.ball)


def test_a_ball_that_rolls_out_of_the_goal_and_in_again_is_one_goal_and_is_put_down() -> None:
    settings = load_settings(options={"synthetic.speed_m_s": 0.0, "synthetic.robots_per_team": 1})
    world, drives, now = World(settings), no_drives(), Instant(NS_PER_S)
    drives[0, 0]["at"] = now  # blue 1 stands
    world.drive(drives, settings.match, now)
    line = goal_line_x(settings.field)
    for x in (line + 0.05, line - 0.05, line + 0.05, line - 0.2):
        world._ball[:] = x, 0.0, 0.0, 0.0, 0.0, 0.0
        world.advance(0.2)
    assert (world.game.blue.goals, world.game.yellow.goals) == (1, 0)
    world.advance(1.0)
    assert math.dist(world.snapshot().ball[:2], (line - 0.2, 0.0)) > 0.01
