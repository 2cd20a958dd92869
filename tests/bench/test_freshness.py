"""The doubter can find what it is there for."""

import os
from collections.abc import Iterator

import pytest

from bench.frame_path import FRAMES, VIEWS
from bench.freshness import OF_FRAMES, Doubter
from vision_core.clock import NS_PER_MS, NS_PER_S, Instant, MonotonicClock
from vision_core.rtdb.layout import RecordSpec
from vision_core.rtdb.slots import SlotReader
from vision_core.rtdb.store import Store, create_block

SPECS = [RecordSpec(FRAMES, 64, 0.25, checksum=False), *(RecordSpec(name, 64, 0.25) for name in OF_FRAMES)]


@pytest.fixture
def store() -> Iterator[Store]:
    block = create_block(SPECS)
    yield Store(SPECS, block)
    os.close(block)


@pytest.fixture
def doubter(store: Store) -> Doubter:
    doubter = Doubter(store)
    doubter._unsure_until = Instant(0)  # as after the first second
    return doubter


def publish(store: Store, record: str, measured: int, written: int | None = None) -> None:
    now = MonotonicClock().now()
    store.writer(record).write(b"x", Instant(measured), Instant(now if written is None else written))


def test_a_value_of_a_published_frame_is_believed(store: Store, doubter: Doubter) -> None:
    now = MonotonicClock().now()
    publish(store, FRAMES, now)
    publish(store, VIEWS, now)
    doubter.look()
    assert (doubter.reads, doubter.valid, doubter.wrong) == (1, 1, [])


def test_an_old_value_that_says_so_is_believed(store: Store, doubter: Doubter) -> None:
    publish(store, VIEWS, MonotonicClock().now() - NS_PER_S)
    doubter.look()
    assert (doubter.reads, doubter.valid, doubter.wrong) == (1, 0, [])


def test_what_a_dead_process_knew_may_not_be_told_as_new(store: Store, doubter: Doubter) -> None:
    publish(store, FRAMES, MonotonicClock().now() - NS_PER_S)
    publish(store, VIEWS, MonotonicClock().now())  # of which frame?
    doubter.look()
    assert "never published" in doubter.wrong[0]


def test_nothing_comes_from_the_future(store: Store, doubter: Doubter) -> None:
    later = MonotonicClock().now() + NS_PER_S
    publish(store, FRAMES, later)
    publish(store, VIEWS, later)
    doubter.look()
    assert "future" in doubter.wrong[0]


def test_a_read_that_calls_too_much_valid_is_found(
    store: Store, doubter: Doubter, monkeypatch: pytest.MonkeyPatch
) -> None:
    read = SlotReader.read
    monkeypatch.setattr(SlotReader, "read", lambda self, now: read(self, Instant(now - 200 * NS_PER_MS)))
    old = MonotonicClock().now() - 300 * NS_PER_MS
    publish(store, FRAMES, old)
    publish(store, VIEWS, old)
    doubter.look()
    assert "is called valid" in doubter.wrong[0]
