"""Every write of a record is collected once, and missed writes are counted."""

import os

from bench.record_timestamps import WriteHistory, timestamps_of
from vision_core.clock import Instant
from vision_core.rtdb.layout import RecordSpec
from vision_core.rtdb.slots import SlotReader, SlotWriter
from vision_core.rtdb.store import Store, create_block

SPEC = RecordSpec("thing", 64, 1.0)


def make() -> tuple[SlotWriter, SlotReader]:
    block = create_block([SPEC])
    writer, reader = Store([SPEC], block).writer("thing"), Store([SPEC], block).reader("thing")
    os.close(block)  # the mappings keep it alive
    return writer, reader


def write(writer: SlotWriter, *numbers: int) -> None:
    for number in numbers:
        writer.write(b"x", Instant(number), Instant(number + 100))


def test_every_write_is_collected_once() -> None:
    writer, reader = make()
    write(writer, 1)
    history = WriteHistory(reader)  # earlier writes do not count
    for numbers in ((), (2,), (3, 4), (5, 6, 7), ()):
        write(writer, *numbers)
        history.poll()
    assert history.timestamps == [(number, number + 100) for number in range(2, 8)]
    assert history.missed == 0


def test_writes_that_were_overwritten_before_the_poll_are_counted() -> None:
    writer, reader = make()
    history = WriteHistory(reader)
    write(writer, *range(1, 11))
    history.poll()
    assert [measured for measured, _ in history.timestamps] == [8, 9, 10]
    assert history.missed == 7


def test_a_slot_that_is_being_written_has_no_timestamps() -> None:
    writer, reader = make()
    write(writer, *range(1, 5))
    assert timestamps_of(reader, 1) == (1, 101)
    writer.begin()  # the fifth write, in the slot of the first
    assert timestamps_of(reader, 1) is None
    assert timestamps_of(reader, 2) == (2, 102)
