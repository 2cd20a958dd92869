"""A record's writings are seen once each, and what was lost is counted."""

import os

from bench.record_timestamps import History, stamp_of
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


def test_every_writing_is_seen_once() -> None:
    writer, reader = make()
    write(writer, 1)
    history = History(reader)  # what was there before is not news
    for numbers in ((), (2,), (3, 4), (5, 6, 7), ()):
        write(writer, *numbers)
        history.look()
    assert history.stamps == [(number, number + 100) for number in range(2, 8)]
    assert history.lost == 0


def test_what_the_ring_went_over_is_counted() -> None:
    writer, reader = make()
    history = History(reader)
    write(writer, *range(1, 11))
    history.look()
    assert [measured for measured, _ in history.stamps] == [8, 9, 10]
    assert history.lost == 7


def test_a_slot_that_is_being_filled_has_no_stamp() -> None:
    writer, reader = make()
    write(writer, *range(1, 5))
    assert stamp_of(reader, 1) == (1, 101)
    writer.begin()  # the fifth, where the first is
    assert stamp_of(reader, 1) is None
    assert stamp_of(reader, 2) == (2, 102)
