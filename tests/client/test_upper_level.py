"""The upper-level examples, from edge arrays alone, against the truth of a simulated match."""

import functools
import importlib.util
import math
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest

from tests.client.pitch import PERIOD_S, Pitch
from vision_core.client import Drive, Robot, View
from vision_core.client.play.controllers import load_controller
from vision_core.geometry import Floats
from vision_core.types.objects import Team

EXAMPLES = Path(__file__).parents[2] / "examples"
ME = Team.BLUE, 1


def controller(name: str) -> Any:
    """A class of an example: its file and its name."""
    return load_controller(f"{EXAMPLES}/{name}")


def example(name: str) -> ModuleType:
    """The module of an example that is no controller."""
    spec = importlib.util.spec_from_file_location(name.removesuffix(".py"), EXAMPLES / name)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def in_own_frame(robot: Floats, point: Floats) -> tuple[float, float]:
    dx, dy = point[0] - robot[0], point[1] - robot[1]
    c, s = math.cos(robot[2]), math.sin(robot[2])
    return c * dx + s * dy, c * dy - s * dx


def test_free_space_is_used_without_touching_anything() -> None:
    pitch, path = Pitch({ME: controller("free_space.py:Roam")}, synthetic__speed_m_s=0.0), []
    pitch.play(15.0, lambda truth: path.append(truth.robots[pitch.index(ME), :2].copy()))
    assert np.hypot(*np.diff(path, axis=0).T).sum() > 5.0
    assert pitch.world.game.collisions == 0


@pytest.mark.parametrize("options", [{}, {"field_preset": "vsss", "synthetic__robots_per_team": 3}])
@pytest.mark.parametrize("me", [ME, (Team.YELLOW, 2)])
def test_a_robot_knows_where_it_is(me: tuple[Team, int], options: dict[str, Any]) -> None:
    pitch = Pitch({}, **options)
    localizer = example("localize.py").Localizer(pitch.robot(me))
    distances, turns = [], []
    side = 1.0 if me[0] is Team.BLUE else -1.0  # yellow's own field is turned by half a circle
    for _ in range(150):
        pitch.step()
        pose = localizer.update(pitch.view(me))
        assert pose is not None
        x, y, heading = pitch.world.snapshot().robots[pitch.index(me), :3]
        distances.append(math.hypot(pose.x_m - side * x, pose.y_m - side * y))
        turn = pose.heading_rad - heading - (0.0 if me[0] is Team.BLUE else math.pi)
        turns.append(abs(math.remainder(turn, math.tau)))
    assert np.median(distances) < 0.01
    assert max(distances) < 0.05
    assert max(turns) < math.radians(3.0)


class Watcher:
    """Stands, or turns, and estimates the ball."""

    def __init__(self, robot: Robot, turn_rad_s: float) -> None:
        self._drive = Drive(turn_rad_s=turn_rad_s)
        self.estimate = example("ball_estimate.py").BallEstimate()
        self.view: View | None = None

    def decide(self, view: View) -> Drive:
        self.view = view
        self.estimate.update(view, self._drive)
        return self._drive


@pytest.mark.parametrize("turn_rad_s", [0.0, 1.5])
def test_a_ball_that_rolls_behind_a_robot_is_known_all_the_time(turn_rad_s: float) -> None:
    pitch = Pitch(
        {ME: functools.partial(Watcher, turn_rad_s=turn_rad_s)}, synthetic__speed_m_s=0.0, synthetic__robots_per_team=2
    )
    world, watcher = pitch.world, pitch.controllers[ME]
    assert isinstance(watcher, Watcher)
    world._robots[:] = 0.0
    world._robots[:, :2] = [(-1.0, 0.0), (-0.3, 0.0), (1.0, -0.9), (1.2, 0.9)]
    world._robots[0, 5] = turn_rad_s
    world._ball[:] = 0.5, -0.9, 0.0, 0.0, 0.8, 0.0
    errors = []
    for _ in range(60):
        truth = world.snapshot()
        pitch.step()
        if watcher.view is not None and watcher.view.ball.hidden and watcher.estimate.position is not None:
            errors.append(math.dist(in_own_frame(truth.robots[0], truth.ball), watcher.estimate.position))
    assert len(errors) > 10
    assert max(errors) < 0.08  # while the ball has rolled on by some 0.5 m


@pytest.mark.parametrize("seed", [1, 2])
def test_control_that_accounts_for_the_lag_aims_better(seed: int) -> None:
    """At a lag of four frames; the other robot plays with the ball."""
    errors = {}
    for predicts in (True, False):
        kind = functools.partial(controller("lag_control.py:AimAtBall"), predicts=predicts)
        pitch = Pitch({ME: kind}, late=4, synthetic__seed=seed, synthetic__robots_per_team=1)
        aside: list[float] = []

        def watch(truth: Any, pitch: Pitch = pitch, aside: list[float] = aside) -> None:
            x, y = in_own_frame(truth.robots[pitch.index(ME)], truth.ball)
            aside.append(abs(math.atan2(y, x)))

        pitch.play(10.0, watch)
        errors[predicts] = float(np.median(aside))
    assert errors[True] < 0.6 * errors[False]


def test_the_frames_are_those_of_the_camera() -> None:
    pitch = Pitch({ME: controller("free_space.py:Roam")}, late=2)
    given = [pitch.step() for _ in range(3)]
    assert given[:2] == [{}, {}]
    assert given[2][ME].time_s == 0.0
    assert pitch.view(ME).time_s == pytest.approx(3 * PERIOD_S, abs=1e-3)
