"""Scoring of the light benchmark: the simulated match is found again, ids are right or another robot's."""

from dataclasses import replace

import numpy as np

from bench.light import Stretch, drawn
from bench.true_world import TrueWorld
from vision_core.capture.synthetic.world import World as SimulatedWorld
from vision_core.clock import NS_PER_S, Instant
from vision_core.types.tracks import RobotTrack, World
from vision_core.venues.loader import load_settings

SETTINGS = load_settings("demo-vsss", options={"synthetic.robots_per_team": 2})
LATE_S = 3.0
"""The match begins so long before the first frame."""


def worlds(count: int) -> list[World]:
    """What a service would tell that sees everything, at 15 frames per second."""
    simulated = SimulatedWorld(SETTINGS)
    simulated.advance(LATE_S)
    told = []
    for number in range(count):
        robots = tuple(
            RobotTrack(team, worn, x, y, heading, 0.0, 0.0, 0.0, 0.001, 0.01, 1.0, Instant(0))
            for (team, worn), (x, y, heading) in zip(
                simulated.robots_worn, simulated.snapshot().robots[:, :3].tolist(), strict=True
            )
        )
        told.append(World(number, Instant(7 * NS_PER_S + number * NS_PER_S // 15), robots, None, ()))
        simulated.advance(1.0 / 15.0)
    return told


def test_the_match_is_found_and_ids_are_scored() -> None:
    told = worlds(20)
    true = TrueWorld(SETTINGS)
    assert true.align(told[:5], 10.0)
    assert [true.score(world) for world in told] == [(4, 0)] * 20
    one, other, *rest = told[9].robots
    swapped = replace(told[9], robots=(replace(one, id=other.id), replace(other, id=one.id), *rest))
    assert true.score(swapped) == (2, 2)
    nameless = replace(told[9], robots=(replace(one, id=None), other, *rest))
    assert true.score(nameless) == (3, 0)
    elsewhere = [replace(world, robots=(replace(one, x_m=9.0),)) for world in told[:5]]
    assert not true.align(elsewhere, 10.0)


def test_ids_are_right_again_when_they_stay_so() -> None:
    stretch = Stretch("all x 2", False, Instant(0), Instant(4 * NS_PER_S))
    times = np.arange(0.0, 4.0, 0.1)
    stretch.scores = [(float(time), 4 if time > 0.95 or 0.25 < time < 0.45 else 2, int(time == 0.0)) for time in times]
    assert stretch.again_s(4) == np.float64(times[10])
    assert (stretch.share(4), stretch.wrong) == (1.0, 1)
    assert np.isnan(Stretch("x", False, Instant(0), Instant(1)).again_s(4))
    assert drawn([stretch], 4, 4.0).any()
