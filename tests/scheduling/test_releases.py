"""When a task is due: on the grid or by a record, never twice, and what passed is counted."""

from collections.abc import Iterator

import pytest
from hypothesis import given
from hypothesis import strategies as st

from vision_core.clock import NS_PER_MS, Instant
from vision_core.rtdb.layout import RecordSpec
from vision_core.rtdb.slots import SlotReader, SlotWriter
from vision_core.rtdb.store import Store, create_block
from vision_core.scheduling.releases import Grid, Trigger

MS = NS_PER_MS
ORIGIN = Instant(1_000 * MS)


def at(ms: float) -> Instant:
    return Instant(ORIGIN + round(ms * MS))


def test_a_grid_is_due_at_its_instants_and_once() -> None:
    grid = Grid(ORIGIN, 0.05)
    assert grid.take(at(-20)) is None
    assert grid.due(at(-20)) == at(0)
    release = grid.take(at(0.1))
    assert release is not None
    assert (release.due, release.began, release.missed) == (at(0), at(0.1), 0)
    assert grid.take(at(0.2)) is None
    assert grid.due(at(0.2)) == at(50)


def test_a_grid_that_is_begun_late_has_missed_nothing() -> None:
    grid = Grid(ORIGIN, 0.05)
    assert grid.due(at(1234)) == at(1250)


def test_instants_that_have_passed_by_a_period_are_skipped_and_counted() -> None:
    grid = Grid(ORIGIN, 0.05)
    grid.take(at(0))  # begins at the next instant
    assert grid.take(at(50)) is not None
    release = grid.take(at(230))
    assert release is not None
    assert (release.due, release.missed) == (at(200), 2)


def test_what_passes_while_a_task_is_off_was_not_missed() -> None:
    grid = Grid(ORIGIN, 0.05)
    grid.take(at(49))
    assert grid.take(at(50)) is not None
    grid.forget()
    assert grid.take(at(1001)) is None
    release = grid.take(at(1050))
    assert release is not None
    assert release.missed == 0


@given(
    st.integers(min_value=1, max_value=400),
    st.lists(st.integers(min_value=0, max_value=3_000_000), min_size=1, max_size=60),
)
def test_runs_and_misses_together_are_all_instants(period_ms: int, steps_us: list[int]) -> None:
    """However late somebody looks, every instant between the first and the last is run or counted, in order."""
    grid = Grid(ORIGIN, period_ms / 1e3)
    now, counted, last = int(ORIGIN) - 1, 0, None
    for step in steps_us:
        now += step * 1000
        release = grid.take(Instant(now))
        if release is None:
            continue
        assert now - period_ms * MS < release.due <= now
        counted += 1 + (release.missed if last is not None else 0)
        if last is None:
            first = release.due
        else:
            assert release.due > last
        last = release.due
    if last is not None:
        assert (last - first) // (period_ms * MS) + 1 == counted


@pytest.fixture
def record() -> Iterator[tuple[SlotWriter, SlotReader]]:
    specs = [RecordSpec("r", 8, 0.0)]
    store = Store(specs, create_block(specs))
    yield store.writer("r"), store.reader("r")
    store.close()


def test_a_writing_releases_once_and_those_that_were_overwritten_are_counted(
    record: tuple[SlotWriter, SlotReader],
) -> None:
    writer, reader = record
    trigger = Trigger(reader, ORIGIN, 0.0)
    assert trigger.take(at(1)) is None
    for ms in (10, 20, 30):
        writer.write(b"new", at(ms), at(ms))
    release = trigger.take(at(31))
    assert release is not None
    assert (release.due, release.missed) == (at(30), 2)
    assert trigger.take(at(32)) is None


def test_with_a_period_only_the_first_writing_of_a_stretch_releases(record: tuple[SlotWriter, SlotReader]) -> None:
    writer, reader = record
    trigger = Trigger(reader, ORIGIN, 0.1)
    released = []
    for ms in range(1, 1000, 10):
        writer.write(b"", at(ms), at(ms))
        if (release := trigger.take(at(ms))) is not None:
            released.append((release.due - ORIGIN) // MS)
            assert release.missed == 0
    assert released == [101, 201, 301, 401, 501, 601, 701, 801, 901]


def test_a_trigger_that_was_off_has_missed_nothing(record: tuple[SlotWriter, SlotReader]) -> None:
    writer, reader = record
    trigger = Trigger(reader, ORIGIN, 0.0)
    for ms in range(5):
        writer.write(b"", at(ms), at(ms))
    trigger.forget()
    release = trigger.take(at(6))
    assert release is not None
    assert (release.due, release.missed) == (at(4), 0)
    assert trigger.take(at(7)) is None


def test_to_a_new_task_the_newest_writing_is_news(record: tuple[SlotWriter, SlotReader]) -> None:
    writer, reader = record
    for ms in range(5):
        writer.write(b"", at(ms), at(ms))
    trigger = Trigger(reader, ORIGIN, 0.0)
    release = trigger.take(at(100))
    assert release is not None
    assert (release.due, release.sequence, release.missed) == (at(4), 5, 0)
