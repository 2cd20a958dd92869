"""The freshness checker finds every kind of violation, and none where there is none."""

import os
from collections.abc import Iterator

import pytest

from bench.frame_path import FRAMES, VIEWS
from bench.freshness import FRAME_RECORDS, FreshnessChecker
from vision_core.clock import NS_PER_MS, NS_PER_S, Instant, MonotonicClock
from vision_core.rtdb.layout import RecordSpec
from vision_core.rtdb.slots import SlotReader
from vision_core.rtdb.store import Store, create_block

SPECS = [RecordSpec(FRAMES, 64, 0.25, checksum=False), *(RecordSpec(name, 64, 0.25) for name in FRAME_RECORDS)]


@pytest.fixture
def store() -> Iterator[Store]:
    block = create_block(SPECS)
    yield Store(SPECS, block)
    os.close(block)


@pytest.fixture
def checker(store: Store) -> FreshnessChecker:
    checker = FreshnessChecker(store)
    checker._incomplete_until = Instant(0)  # as after the first second
    return checker


def publish(store: Store, record: str, measured: int, written: int | None = None) -> None:
    now = MonotonicClock().now()
    store.writer(record).write(b"x", Instant(measured), Instant(now if written is None else written))


def test_a_value_of_a_published_frame_is_accepted(store: Store, checker: FreshnessChecker) -> None:
    now = MonotonicClock().now()
    publish(store, FRAMES, now)
    publish(store, VIEWS, now)
    checker.poll()
    assert (checker.reads, checker.valid, checker.violations) == (1, 1, [])


def test_an_old_value_that_is_called_invalid_is_accepted(store: Store, checker: FreshnessChecker) -> None:
    publish(store, VIEWS, MonotonicClock().now() - NS_PER_S)
    checker.poll()
    assert (checker.reads, checker.valid, checker.violations) == (1, 0, [])


def test_a_valid_value_of_a_frame_that_was_not_published_is_a_violation(
    store: Store, checker: FreshnessChecker
) -> None:
    publish(store, FRAMES, MonotonicClock().now() - NS_PER_S)
    publish(store, VIEWS, MonotonicClock().now())
    checker.poll()
    assert "never published" in checker.violations[0]


def test_a_timestamp_in_the_future_is_a_violation(store: Store, checker: FreshnessChecker) -> None:
    later = MonotonicClock().now() + NS_PER_S
    publish(store, FRAMES, later)
    publish(store, VIEWS, later)
    checker.poll()
    assert "future" in checker.violations[0]


def test_an_old_value_that_is_called_valid_is_a_violation(
    store: Store, checker: FreshnessChecker, monkeypatch: pytest.MonkeyPatch
) -> None:
    read = SlotReader.read
    monkeypatch.setattr(SlotReader, "read", lambda self, now: read(self, Instant(now - 200 * NS_PER_MS)))
    old = MonotonicClock().now() - 300 * NS_PER_MS
    publish(store, FRAMES, old)
    publish(store, VIEWS, old)
    checker.poll()
    assert "is called valid" in checker.violations[0]
