"""Which sighting continues which track, what starts one, what ends it."""

import math
from itertools import pairwise

import numpy as np
import pytest

from vision_core.clock import Instant, after, seconds_between
from vision_core.tracks.robot_tracks import RENAMING_READINGS
from vision_core.tracks.tracker import Tracker
from vision_core.types.objects import BallSighting, RobotSighting, Sightings, Team
from vision_core.types.tables import MAX_ROBOTS, SightingsTable
from vision_core.types.tracks import RobotTrack, World
from vision_core.venues.loader import load_settings

SETTINGS = load_settings().tracks
ROBOTS = load_settings().robots
START = Instant(5_000_000_000)
BLUE, YELLOW = Team.BLUE, Team.YELLOW


def robot(
    marker: int | None, x_m: float, y_m: float = 0.0, heading: float | None = 0.0, team: Team = BLUE
) -> RobotSighting:
    return RobotSighting(team, marker, 0.0, 0.0, x_m, y_m, heading, 0.9, 0.001, 0.01 if heading is not None else None)


def ball(x_m: float, y_m: float = 0.0, confidence: float = 0.9) -> BallSighting:
    return BallSighting(0.0, 0.0, x_m, y_m, confidence, 0.001)


class Film:
    """Feeds a tracker frame by frame."""

    def __init__(self, rate_hz: float = 30.0) -> None:
        self.tracker = Tracker(SETTINGS, ROBOTS)
        self.period_s = 1.0 / rate_hz
        self.number = 0
        self.world = self.predict(START)

    def show(self, *seen: RobotSighting | BallSighting, at: Instant | None = None) -> World:
        self.number += 1
        grabbed = after(START, self.number * self.period_s) if at is None else at
        robots = tuple(s for s in seen if isinstance(s, RobotSighting))
        balls = sorted((s for s in seen if isinstance(s, BallSighting)), key=lambda b: -b.confidence)
        sightings = Sightings("main", self.number, grabbed, after(grabbed, 0.002), robots, tuple(balls), True)
        self.world = self.tracker.update(SightingsTable.of(sightings)).record()
        return self.world

    def predict(self, at: Instant) -> World:
        return self.tracker.predict(at).record()

    def show_for(self, duration_s: float, *seen: RobotSighting | BallSighting) -> World:
        for _ in range(math.ceil(duration_s / self.period_s)):
            self.show(*seen)
        return self.world


def places(world: World) -> dict[tuple[Team, int | None], float]:
    return {(track.team, track.id): round(track.x_m, 2) for track in world.robots}


def only(world: World) -> RobotTrack:
    (track,) = world.robots
    return track


def test_before_the_first_frame_the_world_is_empty() -> None:
    assert Film().world == World(0, START, (), None, ())


def test_a_robot_and_a_ball_are_served_from_their_first_frame() -> None:
    film = Film()
    world = film.show(robot(3, 0.5, 0.2, 1.0), ball(0.1))
    track = only(world)
    assert (track.team, track.id, track.confidence) == (BLUE, 3, 0.9)
    assert (track.x_m, track.y_m, track.heading_rad) == (0.5, 0.2, 1.0)
    assert track.seen == world.at == after(START, 1 / 30)
    assert track.position_sd_m == pytest.approx(math.hypot(0.001, SETTINGS.robot_noise_m))
    assert world.ball is not None
    assert not world.ball.hidden
    assert world.frame_number == 1


@pytest.mark.parametrize("rate_hz", [10.0, 30.0, 200.0])
def test_motion_is_followed_and_predicted_at_every_rate(rate_hz: float) -> None:
    film, speed, turn = Film(rate_hz), 2.0, 5.0
    for frame in range(1, int(rate_hz) + 1):
        t = frame / rate_hz
        world = film.show(robot(1, speed * t, 0.0, math.remainder(turn * t, math.tau)), ball(0.0, 4.0 * t))
        assert len(world.robots) == 1
    track = only(world)
    assert track.x_m == pytest.approx(speed, abs=1e-4)
    assert track.vx_m_s == pytest.approx(speed, abs=0.01)
    assert track.turn_rad_s == pytest.approx(turn, abs=0.05)
    assert world.ball is not None
    assert world.ball.vy_m_s == pytest.approx(4.0, abs=0.01)
    later = film.predict(after(world.at, 0.1))
    assert only(later).x_m == pytest.approx(speed + 0.2, abs=2e-3)
    assert only(later).heading_rad == pytest.approx(math.remainder(turn * 1.1, math.tau), abs=0.01)
    earlier = film.predict(after(world.at, -0.1))
    assert only(earlier).x_m == pytest.approx(speed - 0.2, abs=2e-3)
    assert film.predict(world.at) == world  # predicting changed nothing


def test_a_heading_that_crosses_180_degrees_does_not_swing_back() -> None:
    film = Film()
    for frame in range(40):
        heading = math.pi - 0.1 + 0.005 * frame
        track = only(film.show(robot(1, 0.0, 0.0, math.remainder(heading, math.tau))))
        assert -math.pi <= track.heading_rad < math.pi
        assert abs(math.remainder(track.heading_rad - heading, math.tau)) < 0.01


def test_a_heading_that_is_not_seen_is_predicted_and_less_certain() -> None:
    film = Film()
    for _ in range(30):
        never = only(film.show(robot(None, 0.0, 0.0, None)))
        assert never.heading_sd_rad == pytest.approx(math.pi / math.sqrt(3.0))  # it may be any
        assert never.turn_rad_s == 0.0
    first = only(film.show(robot(None, 0.0, 0.0, 3.0)))
    assert (first.heading_rad, first.turn_rad_s) == (3.0, 0.0)  # and no swing to it
    film = Film()
    for heading in (0.1, 0.2, 0.3):
        sure = only(film.show(robot(None, 0.0, 0.0, heading)))
    blind = only(film.show(robot(None, 0.0, 0.0, None)))
    assert blind.heading_rad == pytest.approx(0.4, abs=0.03)
    assert blind.heading_sd_rad > sure.heading_sd_rad
    assert blind.seen == film.world.at


def test_an_unseen_robot_is_predicted_for_its_validity_and_no_longer() -> None:
    film = Film(100.0)
    for frame in range(1, 11):
        film.show(robot(1, 0.01 * frame))  # 1 m/s
    spreads = []
    for frame in range(11, 36):
        world = film.show()
        track = only(world)
        assert track.x_m == pytest.approx(0.01 * frame, abs=5e-3)
        assert seconds_between(track.seen, world.at) <= SETTINGS.validity_ms / 1000.0
        spreads.append(track.position_sd_m)
    assert all(a < b for a, b in pairwise(spreads))
    assert film.show().robots == ()  # 260 ms


def test_prediction_holds_nothing_older_than_its_validity() -> None:
    film = Film()
    seen = film.show(robot(1, 0.0), ball(0.5)).at
    for delay, robots, has_ball in ((0.25, 1, True), (0.251, 0, True), (0.5, 0, True), (0.501, 0, False)):
        world = film.predict(after(seen, delay))
        assert (len(world.robots), world.ball is not None) == (robots, has_ball)


def test_robots_are_ordered_by_team_and_id_those_without_an_id_last() -> None:
    film = Film()
    world = film.show(
        robot(2, 0.0, team=YELLOW), robot(None, 1.0), robot(7, 2.0), robot(0, 3.0), robot(None, 4.0, team=YELLOW)
    )
    assert [(t.team, t.id) for t in world.robots] == [(BLUE, 0), (BLUE, 7), (BLUE, None), (YELLOW, 2), (YELLOW, None)]


def test_an_unread_id_is_kept_by_position() -> None:
    film = Film()
    film.show(robot(1, 0.0), robot(2, 0.5), robot(2, 0.0, 0.5, team=YELLOW))
    world = film.show(robot(None, 0.5), robot(None, 0.0), robot(None, 0.0, 0.5, team=YELLOW))
    assert places(world) == {(BLUE, 1): 0.0, (BLUE, 2): 0.5, (YELLOW, 2): 0.0}
    assert all(track.seen == world.at for track in world.robots)


def test_a_robot_without_an_id_is_continued_and_gets_its_id_later() -> None:
    film = Film()
    film.show(robot(None, 0.0))
    assert places(film.show(robot(None, 0.05))) == {(BLUE, None): 0.05}
    assert places(film.show(robot(4, 0.1))) == {(BLUE, 4): 0.1}


def test_a_robot_without_an_id_of_one_frame_is_gone_in_the_next() -> None:
    film = Film()
    assert len(film.show(robot(1, 0.0), robot(None, 1.0)).robots) == 2
    assert places(film.show(robot(1, 0.0))) == {(BLUE, 1): 0.0}


def test_one_false_reading_far_away_moves_no_robot() -> None:
    film = Film()
    film.show_for(0.2, robot(1, 0.0))
    world = film.show(robot(1, 1.0))  # read there, and not at its place
    assert places(world) == {(BLUE, 1): 0.0, (BLUE, None): 1.0}
    assert places(film.show(robot(1, 0.0))) == {(BLUE, 1): 0.0}


def test_a_jump_is_accepted_when_a_second_sighting_confirms_it() -> None:
    film = Film()
    film.show_for(0.2, robot(1, 0.0))
    film.show(robot(1, 1.0))
    world = film.show(robot(1, 1.02))
    assert places(world) == {(BLUE, 1): 1.02}
    assert only(world).vx_m_s < 1.0  # started over: not 30 m/s


def test_two_false_readings_at_different_places_move_no_robot() -> None:
    film = Film()
    film.show_for(0.2, robot(1, 0.0))
    film.show(robot(1, 1.0))
    assert places(film.show(robot(1, -1.0)))[BLUE, 1] == 0.0


def test_two_robots_with_one_marker_do_not_exchange_their_ids() -> None:
    film = Film()
    film.show(robot(1, 0.0))
    for _ in range(10):
        world = film.show(robot(1, 0.0), robot(1, 1.0))
        assert places(world) == {(BLUE, 1): 0.0, (BLUE, None): 1.0}
    assert places(film.show(robot(None, 0.0), robot(1, 1.0))) == {(BLUE, 1): 0.0, (BLUE, None): 1.0}
    assert places(film.show(robot(1, 0.0), robot(1, 1.0))) == {(BLUE, 1): 0.0, (BLUE, None): 1.0}


def test_when_the_owner_of_an_id_is_gone_its_double_gets_it() -> None:
    film = Film()
    film.show_for(0.2, robot(1, 0.0), robot(1, 1.0))
    assert places(film.show_for(0.3, robot(1, 1.0))) == {(BLUE, 1): 1.0}


def test_when_an_id_moves_tracks_without_an_id_are_not_touched() -> None:
    film = Film()
    others = (robot(None, -0.6), robot(None, -0.3))
    film.show(*others, robot(3, 0.0))
    film.show(*others, robot(3, 1.0))
    assert places(film.show(*others, robot(3, 1.0))) == {(BLUE, 3): 1.0, (BLUE, None): -0.3}
    assert len(film.world.robots) == 3


def test_a_flicker_of_false_robots_stays_bounded_and_removes_no_id() -> None:
    film = Film()
    film.show(robot(3, 0.0, 2.0), robot(4, 0.5, 2.0))
    for frame in range(7):
        row = 2.0 * (frame // 2 % 4)
        film.show(robot(3, 0.0, 2.0), *(robot(None, 1.0 + 0.5 * column, row) for column in range(40)))
        assert len(film.world.robots) <= MAX_ROBOTS
        assert {3, 4} <= {track.id for track in film.world.robots}


def test_a_misread_id_does_not_rename_until_it_is_read_often() -> None:
    film = Film()
    film.show_for(0.2, robot(3, 0.0))
    assert places(film.show(robot(5, 0.0))) == {(BLUE, 3): 0.0}
    assert places(film.show(robot(3, 0.0))) == {(BLUE, 3): 0.0}
    for _ in range(RENAMING_READINGS - 1):
        assert places(film.show(robot(5, 0.0))) == {(BLUE, 3): 0.0}
    assert places(film.show(robot(5, 0.0))) == {(BLUE, 5): 0.0}
    assert len(film.world.robots) == 1  # no ghost of the old name


def test_robots_crossing_closely_keep_their_ids_though_none_is_read() -> None:
    film = Film()
    for frame in range(60):
        t = frame / 30.0 - 1.0
        first, second = (1.5 * t, 0.1), (-1.5 * t, -0.1)
        ids = (1, 2) if abs(t) > 0.15 else (None, None)
        world = film.show(robot(ids[0], *first), robot(ids[1], *second))
        assert [track.id for track in world.robots] == [1, 2]
        assert world.robots[0].x_m == pytest.approx(first[0], abs=0.01)


def test_teams_are_never_mixed() -> None:
    film = Film()
    film.show(robot(1, 0.0))
    world = film.show(robot(1, 0.0, team=YELLOW))
    assert {(t.team, t.id) for t in world.robots} == {(BLUE, 1), (YELLOW, 1)}


@pytest.mark.parametrize("lateness_s", [0.0, 0.01, 1.0])
def test_late_and_repeated_frames_are_refused(lateness_s: float) -> None:
    film = Film()
    film.show(robot(1, 0.0))
    before = film.show(robot(1, 0.1), ball(0.0))
    again = film.show(robot(1, 5.0), robot(2, 1.0), at=after(before.at, -lateness_s))
    assert again == before
    assert film.tracker.refused == 1
    assert film.predict(before.at) == before


def test_sightings_at_no_place_are_ignored() -> None:
    film = Film()
    world = film.show(robot(1, math.nan), robot(2, math.inf), ball(math.nan), robot(3, 0.0))
    assert places(world) == {(BLUE, 3): 0.0}
    assert world.ball is None


def test_a_long_silence_leaves_nothing_behind() -> None:
    film = Film()
    film.show(robot(1, 0.0), ball(0.0))
    world = film.show(robot(1, 2.0), ball(2.0), at=after(START, 3600.0))
    assert places(world) == {(BLUE, 1): 2.0}
    assert world.ball is not None
    assert world.ball.x_m == 2.0


def ball_x(world: World) -> float:
    assert world.ball is not None
    return round(world.ball.x_m, 3)


def test_the_first_ball_is_the_most_confident() -> None:
    assert ball_x(Film().show(ball(0.0, confidence=0.5), ball(1.0, confidence=0.8))) == 1.0


def test_the_nearest_ball_wins_over_a_more_confident_one() -> None:
    film = Film()
    film.show_for(0.2, ball(0.0))
    world = film.show(ball(0.02, confidence=0.4), ball(0.2, confidence=0.99), ball(1.0, confidence=1.0))
    assert ball_x(world) == pytest.approx(0.02, abs=2e-3)


def test_a_hidden_ball_is_predicted_then_gone() -> None:
    film = Film(100.0)
    for frame in range(1, 21):
        film.show(ball(0.01 * frame))
    spreads = []
    for frame in range(21, 71):
        world = film.show(robot(1, 0.0))
        assert world.ball is not None
        assert world.ball.hidden
        assert world.ball.x_m == pytest.approx(0.01 * frame, abs=0.01)
        spreads.append(world.ball.position_sd_m)
    assert all(a < b for a, b in pairwise(spreads))
    assert film.show().ball is None  # 510 ms


def test_a_ball_elsewhere_is_accepted_in_its_second_frame() -> None:
    film = Film()
    film.show_for(0.2, ball(0.0))
    world = film.show(ball(1.0))
    assert ball_x(world) == 0.0
    assert world.ball is not None
    assert world.ball.hidden
    assert ball_x(film.show(ball(1.1))) == pytest.approx(1.1, abs=1e-3)


def test_a_false_ball_of_one_frame_moves_nothing() -> None:
    film = Film()
    film.show_for(0.2, ball(0.0))
    film.show(ball(1.0))
    film.show(ball(-1.0))
    assert ball_x(film.show(ball(0.0))) == pytest.approx(0.0, abs=1e-3)


@pytest.mark.parametrize("rate_hz", [10.0, 30.0, 60.0, 200.0])
def test_a_hard_kick_is_followed_within_two_frames(rate_hz: float) -> None:
    film = Film(rate_hz)
    film.show_for(0.3, ball(0.0))
    for frame in range(1, 4):
        x = 6.0 * frame / rate_hz
        world = film.show(ball(x))
        if frame >= 2:
            assert ball_x(world) == pytest.approx(x, abs=0.01)
            assert world.ball is not None
            assert not world.ball.hidden


@pytest.mark.parametrize("rate_hz", [10.0, 30.0, 200.0])
def test_a_noisy_match_keeps_every_id(rate_hz: float) -> None:
    # ten robots on circles, ids unread one time in ten, sightings missing one time in twenty
    rng, film = np.random.default_rng(7), Film(rate_hz)
    crew = [(team, marker) for team in Team for marker in range(5)]
    misses = []
    for frame in range(int(4 * rate_hz)):
        t, seen, truth = frame / rate_hz, [], {}
        for k, (team, marker) in enumerate(crew):
            phase = 1.5 * t * (-1) ** k + k
            x, y = 0.5 * (k % 5) - 1.0 + 0.15 * math.cos(phase), (0.5 if k < 5 else -0.5) + 0.15 * math.sin(phase)
            truth[team, marker] = (x, y)
            if frame == 0 or rng.random() > 0.05:
                shown = marker if frame == 0 or rng.random() > 0.1 else None
                x, y = x + rng.normal(0.0, 0.001), y + rng.normal(0.0, 0.001)
                seen.append(robot(shown, x, y, math.remainder(phase, math.tau), team))
        world = film.show(*seen)
        assert [(track.team, track.id) for track in world.robots] == crew
        misses += [
            math.dist(truth[team, marker], (track.x_m, track.y_m))
            for (team, marker), track in zip(crew, world.robots, strict=True)
        ]
    assert np.median(misses) < 0.002
    assert max(misses) < 0.1
