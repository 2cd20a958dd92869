"""Controllers: found by their names, and the shipped ones at play."""

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.client.pitch import Pitch
from vision_core.client import Options
from vision_core.client.play.controllers import SHIPPED, load_controller, options_of
from vision_core.errors import SourceError
from vision_core.types.objects import Team

ME = Team.BLUE, 2
OWN = """
from vision_core.client import Drive, Options
class Still:
    options = Options(rate_hz=10)
    def __init__(self, robot): ...
    def decide(self, view): return Drive()
class Wrong:
    options = "fast"
    def __init__(self, robot): ...
    def decide(self, view): return Drive()
class Nothing: ...
"""


@pytest.mark.parametrize("name", SHIPPED)
def test_the_shipped_controllers_are_found(name: str) -> None:
    assert options_of(load_controller(name)).types == "team"


def test_a_controller_of_ones_own_is_found_by_module_and_by_file(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "our_team.py").write_text(OWN)
    monkeypatch.chdir(tmp_path)
    for name in ("our_team:Still", "our_team.py:Still", f"{tmp_path}/our_team.py:Still"):
        assert options_of(load_controller(name)) == Options(rate_hz=10)
    with pytest.raises(SourceError, match="options of a controller; found: 'fast'"):
        options_of(load_controller("our_team.py:Wrong"))


@pytest.mark.parametrize(
    "name", ["fast", "our_team:", "no_such_team:A", "no.py:A", "our_team.py:Nothing", "broken.py:A"]
)
def test_what_is_no_controller_is_refused(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "our_team.py").write_text(OWN)
    (tmp_path / "broken.py").write_text("class A(:")
    monkeypatch.chdir(tmp_path)
    with pytest.raises(SourceError, match="accepted: chase, keeper, MODULE:CLASS"):
        load_controller(name)


@pytest.mark.parametrize("options", [{}, {"field_preset": "vsss"}])
def test_a_chaser_reaches_the_ball_and_plays_it(options: dict[str, Any]) -> None:
    pitch = Pitch(
        {ME: load_controller("chase")}, late=2, synthetic__speed_m_s=0.0, synthetic__robots_per_team=3, **options
    )
    radius = pitch.robot(ME).radius_m
    reached, speeds = [], []

    def watch(truth: Any) -> None:
        robot = truth.robots[pitch.index(ME)]
        reached.append(math.dist(robot[:2], truth.ball[:2]) < radius + 0.05)
        speeds.append(math.hypot(*truth.ball[3:5]))

    pitch.play(12.0, watch)
    assert any(reached)
    assert max(speeds) > 0.3
    assert pitch.world.game.blue.possession_s > 0.0


def test_a_keeper_stays_before_its_goal() -> None:
    keeper = Team.YELLOW, 1
    pitch = Pitch({keeper: load_controller("keeper")}, late=2)
    places = []
    pitch.play(5.0)
    pitch.play(15.0, lambda truth: places.append(truth.robots[pitch.index(keeper), :2].copy()))
    x, y = np.array(places).T
    assert np.median(x) > pitch.settings.field.length_m / 2.0 - 0.5  # yellow defends the right
    assert np.abs(np.median(y)) < 0.4
