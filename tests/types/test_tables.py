"""A table and a record hold the same, also through the bytes of the database."""

import math

from vision_core.clock import Instant
from vision_core.types.objects import BallSighting, RobotSighting, Sightings, Team
from vision_core.types.tables import SightingsTable, WorldTable
from vision_core.types.tracks import BallTrack, ObstacleTrack, RobotTrack, World

SEEN = Sightings(
    "main", 7, Instant(1), Instant(2),
    (
        RobotSighting(Team.BLUE, 5, 1.5, 2.5, 0.1, 0.2, -math.pi, 0.9, 0.001, 0.01),
        RobotSighting(Team.YELLOW, None, 3.0, 4.0, -1.0, 0.0, None, 0.4, 0.02, None),
    ),
    (BallSighting(5.0, 6.0, 0.0, 0.1, 0.8, 0.001),), True,
)  # fmt: skip
THERE = World(
    7, Instant(10),
    (RobotTrack(Team.YELLOW, None, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, Instant(9)),),
    BallTrack(0.5, 0.6, 0.7, 0.8, 0.002, True, Instant(8)), (ObstacleTrack(1.0, 2.0, 0.3, -0.4, 0.09, Instant(7)),),
)  # fmt: skip
NOWHERE = World(0, Instant(0), (), None, ())


def test_sightings_survive() -> None:
    assert SightingsTable(SightingsTable.of(SEEN).bytes.tobytes()).record() == SEEN


def test_worlds_survive() -> None:
    for world in (THERE, NOWHERE):
        assert WorldTable(WorldTable.of(world).bytes.tobytes()).record() == world
