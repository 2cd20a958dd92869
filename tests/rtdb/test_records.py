"""Typed records survive the round trip through shared memory."""

import os
from typing import TypeVar

from vision_core.clock import Instant
from vision_core.rtdb import records
from vision_core.rtdb.infos import Processes, ProcessInfo, ServiceInfo
from vision_core.rtdb.items import Item
from vision_core.rtdb.process_state import ProcessState
from vision_core.rtdb.store import Store, create_block
from vision_core.tasks.table import task_table
from vision_core.types.objects import BallSighting, RobotSighting, Sightings, Team
from vision_core.types.tracks import BallTrack, RobotTrack, World
from vision_core.venues.loader import load_settings

T = TypeVar("T")


def round_trip(item: Item[T], value: T) -> T:
    block = create_block([item.spec])
    store = Store([item.spec], block)
    os.close(block)
    item.writer(store).write(value, Instant(3), Instant(4))
    timed = item.reader(store).read(Instant(5))
    store.close()
    assert timed is not None
    assert (timed.measured, timed.written) == (3, 4)
    return timed.value


def test_sightings() -> None:
    robot = RobotSighting(Team.BLUE, None, 1.5, 2.5, 0.1, 0.2, None, 0.9, 0.001, None)
    ball = BallSighting(5.0, 6.0, 0.0, 0.1, 0.8, 0.001)
    seen = Sightings("main", 7, Instant(1), Instant(2), (robot,), (ball,), True)
    assert round_trip(records.sightings("main"), seen) == seen


def test_world() -> None:
    robot = RobotTrack(Team.YELLOW, 3, 0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.001, 0.01, 1.0, Instant(9))
    ball = BallTrack(0.1, 0.2, 0.0, 0.0, 0.001, True, Instant(8))
    world = World(7, Instant(10), (robot,), ball, ())
    assert round_trip(records.WORLD, world) == world


def test_service_holds_all_settings() -> None:
    info = ServiceInfo(
        "1.2.3", Instant(5), "http://127.0.0.1:8000", "127.0.0.1:6000", load_settings(), task_table(load_settings())
    )
    assert round_trip(records.SERVICE, info) == info


def test_processes_are_plain_json() -> None:
    """The supervisor writes them with the standard library alone."""
    written = b'{"processes": [{"name": "web", "pid": 3, "state": "running", "restarts": 0, "detail": ""}]}'
    expected = Processes((ProcessInfo("web", 3, ProcessState.RUNNING, 0, ""),))
    block = create_block([records.PROCESSES.spec])
    store = Store([records.PROCESSES.spec], block)
    os.close(block)
    store.writer("processes").write(written, Instant(0), Instant(0))
    assert records.PROCESSES.reader(store).value(Instant(0)) == expected
