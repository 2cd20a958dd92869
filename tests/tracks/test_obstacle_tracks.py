"""Obstacles appear with their second sighting, are predicted between obstacle frames, and are never robots."""

import math
from collections.abc import Callable, Sequence

import numpy as np
import pytest
from msgspec.structs import replace

from vision_core.clock import Instant, after
from vision_core.geometry import Floats
from vision_core.settings.schema import RobotSettings, TeamRobotSettings
from vision_core.tracks.tracker import Tracker
from vision_core.types.objects import ObstacleSighting, RobotSighting, Sightings, Team
from vision_core.types.tables import MAX_OBSTACLES, SightingsTable, obstacle_table
from vision_core.types.tracks import World
from vision_core.venues.loader import load_settings

SETTINGS = load_settings()
VALIDITY_S = SETTINGS.tracks.obstacle_validity_ms / 1000.0
START = Instant(5_000_000_000)
Position = tuple[float, float]
FRAMES_HZ, EVERY = 200.0, 20
"""Rate of the frames, of which every 20th is an obstacle frame (10 Hz)."""


class Film:
    """Feeds a tracker at 100 frames/s, with obstacle frames now and then."""

    def __init__(self, robots: RobotSettings = SETTINGS.robots) -> None:
        self.tracker = Tracker(SETTINGS.tracks, robots)
        self.at = START

    def show(
        self,
        *positions: Position,
        robots: Sequence[RobotSighting] = (),
        is_obstacle_frame: bool = True,
        at: Instant | None = None,
    ) -> World:
        """The next frame. is_obstacle_frame: with obstacles, seen in this frame or (at) in an earlier one."""
        self.at = after(self.at, 0.01)
        seen = SightingsTable.of(Sightings("main", 1, self.at, self.at, tuple(robots), (), True))
        table = obstacle_table(tuple(ObstacleSighting(0.0, 0.0, x, y, 0.08, 0.9) for x, y in positions))
        return self.tracker.update(seen, table if is_obstacle_frame else None, at).record()


def robot(x_m: float, y_m: float = 0.0, heading: float = 0.0, team: Team = Team.BLUE) -> RobotSighting:
    return RobotSighting(team, 1, 0.0, 0.0, x_m, y_m, heading, 0.9, 0.0, 0.0)


def places(world: World) -> set[Position]:
    return {(round(obstacle.x_m, 3), round(obstacle.y_m, 3)) for obstacle in world.obstacles}


def test_an_obstacle_appears_with_its_second_sighting() -> None:
    film = Film()
    assert places(film.show((0.5, 0.0))) == set()
    world = film.show((0.5, 0.0))
    assert places(world) == {(0.5, 0.0)}
    assert (world.obstacles[0].radius_m, world.obstacles[0].seen) == (0.08, film.at)


def test_flicker_makes_no_obstacle() -> None:
    film = Film()
    for frame in range(20):
        assert places(film.show((1.0 * (frame % 2), 0.0))) == set()


def test_it_stays_until_the_next_obstacle_frame() -> None:
    film = Film()
    film.show((0.5, 0.0))
    film.show((0.5, 0.0))
    for _ in range(20):
        assert places(film.show(is_obstacle_frame=False)) == {(0.5, 0.0)}
    (obstacle,) = film.show((0.7, 0.0)).obstacles
    assert obstacle.x_m == pytest.approx(0.7, abs=0.002)
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
    assert places(film.show((0.9, 0.0), at=first)) == {(0.5, 0.0)}  # late: ignored
    assert film.show(is_obstacle_frame=False).obstacles[0].seen == second


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
    assert places(film.show(robots=[robot(0.0)], is_obstacle_frame=False)) == set()
    for _ in range(2):
        assert places(film.show((0.0, 0.0), robots=[robot(0.0)])) == set()
    assert places(film.show(robots=[robot(0.15)], is_obstacle_frame=False)) == set()


def test_an_earlier_obstacle_frame_is_compared_with_the_robots_of_its_own_instant() -> None:
    film = Film()
    for frame in range(30):
        world = film.show(robots=[robot(0.02 * frame)], is_obstacle_frame=False)
    for _ in range(2):  # 2 m/s: an obstacle frame of 50 ms ago shows the robot 0.1 m behind
        x = world.robots[0].x_m - 0.10 + 0.02
        world = film.show((x, 0.0), robots=[robot(world.robots[0].x_m + 0.02)], at=after(film.at, -0.04))
    film.show(robots=[robot(3.0)], is_obstacle_frame=False)
    assert places(film.tracker.predict(film.at).record()) == set()


@pytest.mark.parametrize(("heading", "inside"), [(0.0, True), (math.pi / 4.0, False)])
def test_square_robots_are_square(heading: float, inside: bool) -> None:
    square = TeamRobotSettings(pattern="vsss", outline="square", radius_m=0.04, height_m=0.05)
    film = Film(replace(SETTINGS.robots, yellow=square))
    for _ in range(3):
        world = film.show((0.038, 0.038), robots=[robot(0.0, 0.0, heading, Team.YELLOW)])
    assert bool(places(world)) is not inside


def test_two_obstacles_that_cross_stay_two() -> None:
    film = Film()
    film.show((0.0, 0.0), (0.2, 0.0))
    world = film.show((0.05, 0.0), (0.15, 0.0))
    assert [obstacle.x_m for obstacle in world.obstacles] == pytest.approx([0.05, 0.15], abs=0.005)


def test_too_many_obstacles_and_obstacles_without_a_place() -> None:
    film = Film()
    crowd = [(math.nan, 0.0), *((float(x), float(y)) for x, y in np.ndindex(10, 10))]
    film.show(*crowd)
    assert len(film.show(*crowd).obstacles) == MAX_OBSTACLES - 1


def followed(path: Callable[[float], Position], duration_s: float, noise_m: float = 0.0, seed: int = 1) -> Floats:
    """Place, velocity and error of the only obstacle in every frame once it is there: rows t x y vx vy error [s, m].

    path: the obstacle's position as a function of time.
    """
    rng, tracker, rows = np.random.default_rng(seed), Tracker(SETTINGS.tracks, SETTINGS.robots), []
    for frame in range(round(duration_s * FRAMES_HZ)):
        t = frame / FRAMES_HZ
        at, there = after(START, t), np.array(path(t))
        x, y = (there + rng.normal(0.0, noise_m, 2)).tolist()
        positions = obstacle_table((ObstacleSighting(0.0, 0.0, x, y, 0.08, 0.9),))
        seen = SightingsTable.of(Sightings("main", frame, at, at, (), (), True))
        world = tracker.update(seen, None if frame % EVERY else positions).record()
        for obstacle in world.obstacles:
            error = math.dist(there, (obstacle.x_m, obstacle.y_m))
            rows.append((t, obstacle.x_m, obstacle.y_m, obstacle.vx_m_s, obstacle.vy_m_s, error))
    return np.array(rows)


@pytest.mark.parametrize("noise_m", [0.0, 0.003])
def test_what_moves_is_predicted_between_looks(noise_m: float) -> None:
    for seed in range(5):
        rows = followed(lambda t: (0.8 * t - 1.0, 0.6 * t), 2.0, noise_m, seed)
        late = rows[rows[:, 0] >= 0.5]
        assert len(late) == 300
        assert late[:, 5].max() < 0.02
        assert np.abs(late[:, 3:5] - (0.8, 0.6)).max() < 0.1


def test_what_rests_stays_at_rest() -> None:
    for seed in range(5):
        rows = followed(lambda t: (0.3, -0.2), 10.0, 0.003, seed)
        assert len(rows) == 2000 - EVERY
        assert rows[rows[:, 0] >= 0.5][:, 5].max() < 0.006
        assert np.hypot(rows[:, 3], rows[:, 4]).mean() < 0.01


def test_what_starts_turns_and_stops_is_followed_from_its_next_looks_on() -> None:
    def path(t: float) -> Position:
        """Stands, drives at 1 m/s, turns by a right angle, stands; each for a second."""
        return min(max(t - 1.0, 0.0), 1.0), min(max(t - 2.0, 0.0), 1.0)

    rows = followed(path, 4.0, 0.002)
    calm = (rows[:, 0] % 1.0) >= 0.3
    assert rows[calm][:, 5].max() < 0.02
    assert rows[:, 5].max() < 0.15  # the turn is visible in the next obstacle frame only


def test_what_creeps_is_followed() -> None:
    rows = followed(lambda t: (0.05 * t, 0.0), 4.0, 0.003)
    assert rows[:, 5].max() < 0.025


def test_no_obstacle_is_faster_than_anything_there() -> None:
    film = Film()
    film.show((0.0, 0.0))
    (obstacle,) = film.show((0.2, 0.0)).obstacles  # 20 m/s
    assert math.hypot(obstacle.vx_m_s, obstacle.vy_m_s) <= 3.0 + 1e-9


def test_it_is_told_where_it_will_be() -> None:
    film = Film()
    for step in range(20):
        film.show((0.02 * step, 0.0))
    (obstacle,) = film.tracker.predict(after(film.at, 0.1)).record().obstacles
    assert (obstacle.x_m, obstacle.y_m) == pytest.approx((0.02 * 19 + 0.2, 0.0), abs=0.01)
