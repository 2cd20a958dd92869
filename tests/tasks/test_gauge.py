"""What a task tells of itself, and when."""

import os
from collections.abc import Iterator

import pytest

from vision_core.clock import Instant, ManualClock
from vision_core.rtdb import records
from vision_core.rtdb.attachment import Attachment, HandDown
from vision_core.rtdb.records import ItemReader, TaskInfo
from vision_core.rtdb.store import create_block
from vision_core.tasks.gauge import Gauge

START = Instant(1_000_000_000)


@pytest.fixture
def attachment() -> Iterator[Attachment]:
    specs = (records.task("perceive").spec,)
    block = create_block(specs)
    attached = Attachment(HandDown("perceive", 0, 0, block, specs, None, {}, {}))
    yield attached
    attached.store.close()
    os.close(block)


@pytest.fixture
def told(attachment: Attachment) -> ItemReader[TaskInfo]:
    return records.task("perceive").reader(attachment.store)


def test_the_heartbeat_begins_when_the_task_is_ready(attachment: Attachment, told: ItemReader[TaskInfo]) -> None:
    gauge, clock = Gauge(attachment, START), ManualClock(START)
    assert told.read(clock.now()) is None
    clock.advance(0.01)
    gauge.publish_if_due(clock.now())
    assert told.value(clock.now()).runs == 0
    clock.advance(0.49)
    gauge.publish_if_due(clock.now())
    assert told.sequence == 1
    clock.advance(0.01)
    gauge.publish_if_due(clock.now())
    assert told.sequence == 2


def test_rates_are_of_the_interval_and_counts_since_the_start(
    attachment: Attachment, told: ItemReader[TaskInfo]
) -> None:
    gauge, clock = Gauge(attachment, START), ManualClock(START)
    for duration_s in (0.002, 0.004, 0.009):
        released = clock.now()
        clock.advance(duration_s)
        gauge.ran(released, clock.now(), missed=1)
    gauge.note = "warm"
    gauge.publish(Instant(START + 500_000_000))
    info = told.value(clock.now())
    assert (info.runs, info.missed, info.note) == (3, 3, "warm")
    assert (info.rate_hz, info.response_median_ms, info.response_max_ms) == pytest.approx((6.0, 4.0, 9.0))
    gauge.publish(Instant(START + 1_000_000_000))
    info = told.value(clock.now())
    assert (info.runs, info.missed, info.rate_hz, info.response_max_ms) == (3, 3, 0.0, 0.0)
