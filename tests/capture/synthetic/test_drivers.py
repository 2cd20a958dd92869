"""Robots of the simulated world that clients drive."""

import math

import numpy as np
import pytest

from vision_core.capture.synthetic.world import World
from vision_core.clock import NS_PER_S, Instant
from vision_core.geometry import Floats
from vision_core.settings.schema import Settings
from vision_core.types.drives import Drives, no_drives
from vision_core.types.game import DrivenRobot
from vision_core.types.objects import Team
from vision_core.venues.loader import load_settings

PERIOD_S = 1.0 / 30.0
BLUE_3 = 0, 2


class Match:
    """A world with the driver of blue 3, in which the others stand."""

    def __init__(self, speed_m_s: float = 0.0, **options: object) -> None:
        given = {key.replace("__", "."): value for key, value in options.items()}
        self.settings: Settings = load_settings(options={"synthetic.speed_m_s": speed_m_s, **given})
        self.world = World(self.settings)
        self.drives: Drives = no_drives()
        self.now = Instant(NS_PER_S)

    def command(self, vx: float, vy: float, turn: float, *, kick: float = 0.0, dribbles: bool = False) -> None:
        row = self.drives[BLUE_3]
        row["at"], row["dribbles"] = self.now, dribbles
        row["vx_m_s"], row["vy_m_s"], row["turn_rad_s"] = vx, vy, turn
        if kick:
            row["kicked_at"], row["kick_m_s"] = self.now, kick

    def play(self, duration_s: float) -> None:
        for _ in range(round(duration_s / PERIOD_S)):
            self.world.drive(self.drives, self.settings.match, self.now)
            self.world.advance(PERIOD_S)
            self.now = Instant(self.now + round(PERIOD_S * NS_PER_S))

    @property
    def robots(self) -> Floats:
        return self.world.snapshot().robots


def test_a_robot_follows_its_driver_and_the_others_stand() -> None:
    match = Match()
    before = match.robots
    match.command(0.3, 0.0, 1.0)
    match.play(0.4)
    moved = np.hypot(*(match.robots - before)[:, :2].T)
    assert moved[2] > 0.05
    assert match.robots[2, 5] == pytest.approx(1.0)
    assert np.delete(moved, 2).max() < 1e-6
    assert match.world.game.driven == (DrivenRobot(Team.BLUE, 3, silent=False),)


def test_it_stops_when_its_driver_falls_silent_and_stands_while_the_session_lives() -> None:
    match = Match(speed_m_s=1.0)
    match.command(0.5, 0.0, 2.0)
    match.play(3.0)
    assert math.hypot(*match.robots[2, 3:6]) < 1e-3
    assert match.world.game.driven == (DrivenRobot(Team.BLUE, 3, silent=True),)
    match.command(0.0, 0.0, 2.0)
    match.play(0.3)
    assert match.robots[2, 5] == pytest.approx(2.0)


def test_without_a_driver_it_plays_by_itself_again() -> None:
    match = Match(speed_m_s=1.0)
    match.command(0.0, 0.0, 0.0)
    match.play(1.0)
    before = match.robots[2]
    match.drives[BLUE_3] = 0
    match.play(2.0)
    assert math.hypot(*(match.robots[2] - before)[:2]) > 0.1
    assert match.world.game.driven == ()


def test_a_world_without_drivers_plays_as_if_it_heard_none() -> None:
    heard, plain = Match(speed_m_s=1.2), World(load_settings())
    heard.play(10.0)
    for _ in range(300):
        plain.advance(PERIOD_S)
    assert np.array_equal(heard.robots, plain.snapshot().robots)
    assert np.array_equal(heard.world.snapshot().ball, plain.snapshot().ball)


def test_who_wears_the_markers_decides_which_robot_it_is() -> None:
    match = Match()
    swapped = load_settings(options={"match.blue_ids": [3, 2, 1, 4, 5]})
    match.command(0.0, 0.0, 3.0)
    match.world.drive(match.drives, swapped.match, match.now)
    match.world.advance(0.3)
    assert match.robots[0, 5] == pytest.approx(3.0)
    assert match.robots[2, 5] == 0.0


def test_two_wheels_turn_where_they_stand() -> None:
    match = Match(field_preset="vsss", synthetic__robots_per_team=3)
    before = match.robots[2]
    match.command(0.0, 0.0, 8.0)
    match.play(0.4)
    assert math.hypot(*(match.robots[2] - before)[:2]) < 1e-3
    assert match.robots[2, 5] == pytest.approx(8.0)
