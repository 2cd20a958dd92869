"""The tracker on tables: one compiled call, one table, memory that is taken once."""

import tracemalloc
from typing import Any

from vision_core.clock import Instant, after
from vision_core.tracks.tracker import Tracker, update_tracks, write_world
from vision_core.types.objects import BallSighting, ObstacleSighting, RobotSighting, Sightings, Team
from vision_core.types.tables import SightingsTable, obstacle_table
from vision_core.venues.loader import load_settings

SETTINGS = load_settings()
START = Instant(5_000_000_000)


def table(number: int) -> SightingsTable:
    at = after(START, 0.005 * number)
    robots = [
        RobotSighting(team, marker, 0.0, 0.0, 0.3 * marker, 0.5 * index, 0.0, 0.9, 0.001, 0.01)
        for index, team in enumerate(Team)
        for marker in range(5)
    ]
    return SightingsTable.of(
        Sightings("main", number, at, at, tuple(robots), (BallSighting(0.0, 0.0, 0.0, 0.0, 0.9, 0.001),), True)
    )


def test_every_call_returns_the_trackers_own_table() -> None:
    tracker = Tracker(SETTINGS.tracks, SETTINGS.robots)
    world = tracker.update(table(1))
    assert world.counts.tolist() == [10, 1, 0]
    assert tracker.predict(after(START, 10.0)) is world
    assert world.counts.tolist() == [0, 0, 0]
    assert tracker.update(table(2)) is world


def test_kernels_are_compiled_once() -> None:
    tracker = Tracker(SETTINGS.tracks, SETTINGS.robots)
    obstacles = obstacle_table((ObstacleSighting(0.0, 0.0, 2.0, 0.0, 0.1, 0.9),))
    obstacles.setflags(write=False)
    tracker.update(table(1))
    tracker.update(table(2), obstacles)
    tracker.update(SightingsTable(bytes(table(3).bytes)), obstacles, after(START, 0.012))
    tracker.predict(START)
    kernels: tuple[Any, ...] = (update_tracks, write_world)
    assert [len(kernel.signatures) for kernel in kernels] == [1, 1]


def test_frames_leave_no_memory_behind_and_take_no_arrays() -> None:
    tracker = Tracker(SETTINGS.tracks, SETTINGS.robots)
    tables = [table(number) for number in range(1, 202)]
    tracker.update(tables[0])
    tracemalloc.start()
    try:
        for seen in tables[1:]:
            tracker.update(seen)
        _, peak = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    assert peak < 2000  # bytes: a few numbers at a time
