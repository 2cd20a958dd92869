"""The world obeys its laws: nobody outside, nobody inside another, a ball that rolls and is played."""

from typing import Any

import numpy as np
import pytest

from vision_core.capture.synthetic.world import Snapshot, World
from vision_core.geometry import Floats
from vision_core.models.field import accepted_half_extent, goal_line_x
from vision_core.settings.schema import Settings
from vision_core.venues.loader import load_settings

PERIOD_S = 1.0 / 30.0
OVERLAP_M = 0.012
"""Bodies that press on one another for a moment."""


def match(frames: int, **options: Any) -> tuple[Settings, World, list[Snapshot]]:
    settings = load_settings(options={key.replace("__", "."): value for key, value in options.items()})
    world = World(settings)
    scenes = []
    for _ in range(frames):
        world.advance(PERIOD_S)
        scenes.append(world.snapshot())
    return settings, world, scenes


@pytest.mark.parametrize(("preset", "seed"), [("ssl-2002", 1), ("ssl-2002", 2), ("ssl-division-b", 1)])
def test_a_match_of_2000_frames(preset: str, seed: int) -> None:
    settings, _, scenes = match(2000, field_preset=preset, synthetic__seed=seed)
    robots = np.array([scene.robots for scene in scenes])
    balls = np.array([scene.ball for scene in scenes])
    radius, half = settings.robots.radius_m, np.array(accepted_half_extent(settings.field))
    assert np.isfinite(robots).all()
    assert np.isfinite(balls).all()
    assert (np.abs(robots[..., :2]) <= half - radius + OVERLAP_M).all()
    assert np.hypot(robots[..., 3], robots[..., 4]).max() <= settings.synthetic.speed_m_s * 1.3
    arms = robots[:, :, None, :2] - robots[:, None, :, :2]
    gaps = np.hypot(arms[..., 0], arms[..., 1]) + np.eye(robots.shape[1])
    assert gaps.min() >= 2.0 * radius - OVERLAP_M
    to_ball = np.hypot(*(robots[..., :2] - balls[:, None, :2]).transpose(2, 0, 1))
    assert to_ball.min() > 0.055
    if settings.field.walls:
        assert_inside_walls_and_goals(balls, settings)
    speeds = np.hypot(balls[:, 3], balls[:, 4])
    assert speeds.mean() > 0.2
    assert (np.diff(speeds) > 0.7).sum() >= 5, "nobody kicked the ball"
    travelled = np.hypot(*np.diff(robots[..., :2], axis=0).transpose(2, 0, 1)).sum(axis=0)
    assert (travelled > 1.0).all(), "a robot never went anywhere"


def assert_inside_walls_and_goals(balls: Floats, settings: Settings) -> None:
    half_x, half_y = accepted_half_extent(settings.field)
    assert np.abs(balls[:, 1]).max() < half_y
    beyond = balls[np.abs(balls[:, 0]) > half_x]
    assert (np.abs(beyond[:, 1]) <= settings.field.goal.width_m / 2.0).all()
    assert (np.abs(beyond[:, 0]) <= half_x + settings.field.goal.depth_m).all()


def test_goals_are_scored_and_the_ball_comes_back() -> None:
    settings, _, scenes = match(2500, field_preset="ssl-division-b")
    x = np.array([abs(scene.ball[0]) for scene in scenes])
    out = x > goal_line_x(settings.field)
    returns = np.flatnonzero(out[:-1] & ~out[1:])
    assert len(returns) >= 1
    assert not out[-1] or out[-60:].sum() < 60


def test_a_seed_plays_one_match_and_another_seed_another() -> None:
    one, again, other = (match(200, synthetic__seed=seed)[2][-1] for seed in (4, 4, 5))
    assert np.array_equal(one.robots, again.robots)
    assert np.array_equal(one.ball, again.ball)
    assert not np.allclose(one.robots, other.robots)


def test_the_match_does_not_depend_on_the_frame_rate() -> None:
    slow, fast = World(load_settings()), World(load_settings())
    for _ in range(90):
        slow.advance(1.0 / 30.0)
    for _ in range(300):
        fast.advance(0.01)
    assert np.allclose(slow.snapshot().robots, fast.snapshot().robots, atol=1e-6)
    assert np.allclose(slow.snapshot().ball, fast.snapshot().ball, atol=1e-6)


def test_with_speed_zero_nothing_moves() -> None:
    _, _, scenes = match(60, synthetic__speed_m_s=0.0)
    assert np.array_equal(scenes[0].robots, scenes[-1].robots)
    assert np.array_equal(scenes[0].ball, scenes[-1].ball)


def test_teams_wear_the_ids_of_the_match() -> None:
    _, world, _ = match(1, match__blue_ids=[9, 7, 3], match__numbers=3, synthetic__robots_per_team=3)
    assert [worn for team, worn in world.robots_worn if team == "blue"] == [9, 7, 3]
    assert [worn for team, worn in world.robots_worn if team == "yellow"] == [1, 2, 3]


@pytest.mark.parametrize("count", [0, 1, 16])
def test_any_number_of_robots_plays(count: int) -> None:
    settings, _, scenes = match(300, synthetic__robots_per_team=count)
    assert scenes[-1].robots.shape == (2 * count, 6)
    half = np.array(accepted_half_extent(settings.field))
    assert (np.abs(scenes[-1].robots[:, :2]) < half).all()


def test_feet_walk_beside_the_field() -> None:
    settings, _, scenes = match(600, synthetic__walking_people=6)
    feet = np.array([scene.feet for scene in scenes])
    half_x, half_y = accepted_half_extent(settings.field)
    assert ((np.abs(feet[..., 0]) > half_x) | (np.abs(feet[..., 1]) > half_y)).all()
    steps = np.hypot(*np.diff(feet[..., :2], axis=0).transpose(2, 0, 1))
    assert steps.max() < 0.06
    assert (steps.sum(axis=0) > 5.0).all()
    speeds = np.hypot(feet[..., 3], feet[..., 4])
    assert speeds[:-1].mean() == pytest.approx(steps.mean() / PERIOD_S, rel=0.05)
