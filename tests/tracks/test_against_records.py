"""The compiled tracker does what the tracker of records did."""

import math
from dataclasses import replace

import numpy as np
import pytest

from vision_core.clock import Instant, after
from vision_core.settings_files import load_settings
from vision_core.tracks.state import UNKNOWN_HEADING_VARIANCE
from vision_core.tracks.tracker import Tracker as RecordTracker
from vision_core.tracks.tracking import Tracker
from vision_core.types.objects import BallSighting, RobotSighting, Sightings, Team
from vision_core.types.tables import SightingsTable
from vision_core.types.tracks import RobotTrack, World

SETTINGS = load_settings()
START = Instant(5_000_000_000)


def comparable(world: World, *, headings: bool) -> list[tuple[object, ...]]:
    """Rows of numbers, the nameless by place."""

    def row(track: RobotTrack) -> tuple[object, ...]:
        known = (math.cos(track.heading_rad), math.sin(track.heading_rad), track.turn_rad_s)
        sd = min(track.heading_sd_rad, math.sqrt(UNKNOWN_HEADING_VARIANCE))
        return (
            track.team == Team.BLUE, -1 if track.id is None else track.id, track.x_m, track.y_m,
            track.vx_m_s, track.vy_m_s, track.position_sd_m, track.confidence, track.seen,
            *((*known, sd) if headings else ()),
        )  # fmt: skip

    ball = world.ball
    rows: list[tuple[object, ...]] = sorted(
        (row(track) for track in world.robots), key=lambda r: str(r[:2]) + str(r[2])
    )
    if ball is not None:
        rows.append((ball.x_m, ball.y_m, ball.vx_m_s, ball.vy_m_s, ball.position_sd_m, ball.hidden, ball.seen))
    return rows


def same(one: World, other: World, *, headings: bool) -> None:
    assert (one.frame_number, one.at) == (other.frame_number, other.at)
    rows, others = comparable(one, headings=headings), comparable(other, headings=headings)
    assert [len(row) for row in rows] == [len(row) for row in others]
    for row, twin in zip(rows, others, strict=True):
        assert row == pytest.approx(twin, rel=1e-6, abs=1e-9)


def scene(rng: np.random.Generator, places: np.ndarray, number: int, at: Instant, *, headings: bool) -> Sightings:
    robots = []
    for index, place in enumerate(places):
        if rng.random() < 0.15:
            continue
        x, y = place if rng.random() > 0.05 else rng.uniform(-2.0, 2.0, 2)
        marker = [index % 4, None, int(rng.integers(0, 5))][rng.choice(3, p=[0.7, 0.2, 0.1])]
        shown = headings or rng.random() < 0.6
        heading = float(rng.uniform(-3.1, 3.1)) if shown else None
        team = Team.BLUE if index < 4 else Team.YELLOW
        robots.append(RobotSighting(team, marker, 0.0, 0.0, x, y, heading, rng.random(), 0.0, 0.0 if shown else None))
    rolled = rng.normal(0.0, 0.4, (rng.integers(0, 3), 2)).tolist()
    balls = [BallSighting(0.0, 0.0, x, y, 0.5, 0.0) for x, y in rolled]
    order = rng.permutation(len(robots))
    return Sightings("main", number, at, at, tuple(robots[i] for i in order), tuple(balls), ())


@pytest.mark.parametrize("headings", [True, False])
@pytest.mark.parametrize("seed", range(8))
def test_random_matches_are_told_alike(seed: int, headings: bool) -> None:
    rng = np.random.default_rng(seed)
    tracker, twin = Tracker(SETTINGS.tracks, SETTINGS.robots), RecordTracker(SETTINGS.tracks)
    places, at = rng.uniform(-0.8, 0.8, (8, 2)), START
    for number in range(120):
        at = after(at, float(rng.choice([0.005, 0.033, 0.1, 0.3], p=[0.2, 0.7, 0.08, 0.02])))
        places += rng.normal(0.0, 0.03, places.shape)
        seen = scene(rng, places, number, at, headings=headings)
        if rng.random() < 0.05:
            seen = replace(seen, grabbed=after(at, -1.0))
        same(tracker.update(SightingsTable.of(seen)).record(), twin.update(seen), headings=headings)
        if number % 10 == 0:
            later = after(at, float(rng.uniform(-0.05, 0.4)))
            same(tracker.predict(later).record(), twin.predict(later), headings=headings)
    assert tracker.refused == twin.refused
