"""Obstacles appear with their second sighting, stay between their frames, and are never a robot."""

import math
from collections.abc import Sequence

import numpy as np
import pytest
from msgspec.structs import replace

from vision_core.clock import Instant, after
from vision_core.settings import RobotSettings, TeamRobotSettings
from vision_core.settings_files import load_settings
from vision_core.tracks.tracker import Tracker
from vision_core.types.objects import ObstacleSighting, RobotSighting, Sightings, Team
from vision_core.types.tables import MOST_OBSTACLES, SightingsTable, obstacle_table
from vision_core.types.tracks import World

SETTINGS = load_settings()
VALIDITY_S = SETTINGS.tracks.obstacle_validity_ms / 1000.0
START = Instant(5_000_000_000)
Thing = tuple[float, float]


class Film:
    """Feeds a tracker at 100 frames/s, with obstacle frames now and then."""

    def __init__(self, robots: RobotSettings = SETTINGS.robots) -> None:
        self.tracker = Tracker(SETTINGS.tracks, robots)
        self.at = START

    def show(
        self, *things: Thing, robots: Sequence[RobotSighting] = (), told: bool = True, at: Instant | None = None
    ) -> World:
        """The next frame; told: it is an obstacle frame, too, or brings the one of an earlier instant."""
        self.at = after(self.at, 0.01)
        seen = SightingsTable.of(Sightings("main", 1, self.at, self.at, tuple(robots), (), True))
        table = obstacle_table(tuple(ObstacleSighting(0.0, 0.0, x, y, 0.08, 0.9) for x, y in things))
        return self.tracker.update(seen, table if told else None, at).record()


def robot(x_m: float, y_m: float = 0.0, heading: float = 0.0, team: Team = Team.BLUE) -> RobotSighting:
    return RobotSighting(team, 1, 0.0, 0.0, x_m, y_m, heading, 0.9, 0.0, 0.0)


def places(world: World) -> set[Thing]:
    return {(round(thing.x_m, 3), round(thing.y_m, 3)) for thing in world.obstacles}


def test_an_obstacle_appears_with_its_second_sighting_at_its_newest_place() -> None:
    film = Film()
    assert places(film.show((0.5, 0.0))) == set()
    world = film.show((0.52, 0.0))
    assert places(world) == {(0.52, 0.0)}
    assert (world.obstacles[0].radius_m, world.obstacles[0].seen) == (0.08, film.at)


def test_what_flickers_here_and_there_is_none() -> None:
    film = Film()
    for frame in range(20):
        assert places(film.show((1.0 * (frame % 2), 0.0))) == set()


def test_it_stays_until_the_next_obstacle_frame_tells_otherwise() -> None:
    film = Film()
    film.show((0.5, 0.0))
    film.show((0.5, 0.0))
    for _ in range(20):
        assert places(film.show(told=False)) == {(0.5, 0.0)}
    assert places(film.show((0.7, 0.0))) == {(0.7, 0.0)}
    assert places(film.show()) == set()


def test_it_stays_no_longer_than_its_validity() -> None:
    film = Film()
    film.show((0.5, 0.0))
    seen = film.show((0.5, 0.0)).at
    assert places(film.tracker.predict(after(seen, VALIDITY_S)).record()) == {(0.5, 0.0)}
    assert places(film.tracker.predict(after(seen, VALIDITY_S + 0.001)).record()) == set()
    film.at = after(film.at, VALIDITY_S)
    assert places(film.show((0.5, 0.0))) == set()  # starts over


def test_an_obstacle_frame_that_is_given_again_counts_once() -> None:
    film = Film()
    first = after(film.at, 0.001)
    for _ in range(5):
        assert places(film.show((0.5, 0.0), at=first)) == set()
    second = after(film.at, -0.002)
    assert places(film.show((0.5, 0.0), at=second)) == {(0.5, 0.0)}
    assert places(film.show((0.9, 0.0), at=first)) == {(0.5, 0.0)}  # late: not looked at
    assert film.show(told=False).obstacles[0].seen == second


def test_a_robot_is_no_obstacle_and_none_beside_it_is_lost() -> None:
    film = Film()
    radius = SETTINGS.robots.radius_m
    for _ in range(5):
        world = film.show((0.9 * radius, 0.0), (1.1 * radius, 1.0), robots=[robot(0.0)])
    assert places(world) == {(round(1.1 * radius, 3), 1.0)}


def test_a_robot_that_was_seen_late_leaves_no_ghost_when_it_drives_on() -> None:
    film = Film()
    for _ in range(3):
        film.show((0.0, 0.0))
    assert places(film.show(robots=[robot(0.0)], told=False)) == set()
    for _ in range(2):
        assert places(film.show((0.0, 0.0), robots=[robot(0.0)])) == set()
    assert places(film.show(robots=[robot(0.15)], told=False)) == set()


def test_what_was_seen_earlier_is_compared_with_where_robots_were_then() -> None:
    film = Film()
    for frame in range(30):
        world = film.show(robots=[robot(0.02 * frame)], told=False)
    for _ in range(2):  # 2 m/s: an obstacle frame of 50 ms ago shows the robot 0.1 m behind
        x = world.robots[0].x_m - 0.10 + 0.02
        world = film.show((x, 0.0), robots=[robot(world.robots[0].x_m + 0.02)], at=after(film.at, -0.04))
    film.show(robots=[robot(3.0)], told=False)
    assert places(film.tracker.predict(film.at).record()) == set()


@pytest.mark.parametrize(("heading", "inside"), [(0.0, True), (math.pi / 4.0, False)])
def test_square_robots_are_square(heading: float, inside: bool) -> None:
    square = TeamRobotSettings(pattern="vsss", outline="square", radius_m=0.04, height_m=0.05)
    film = Film(replace(SETTINGS.robots, yellow=square))
    for _ in range(3):
        world = film.show((0.038, 0.038), robots=[robot(0.0, 0.0, heading, Team.YELLOW)])
    assert bool(places(world)) is not inside


def test_two_that_cross_are_two() -> None:
    film = Film()
    film.show((0.0, 0.0), (0.2, 0.0))
    assert places(film.show((0.05, 0.0), (0.15, 0.0))) == {(0.05, 0.0), (0.15, 0.0)}


def test_more_than_there_is_room_for_and_at_no_place() -> None:
    film = Film()
    crowd = [(math.nan, 0.0), *((float(x), float(y)) for x, y in np.ndindex(10, 10))]
    film.show(*crowd)
    assert len(film.show(*crowd).obstacles) == MOST_OBSTACLES - 1
