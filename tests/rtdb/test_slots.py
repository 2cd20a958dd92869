"""One record's ring: what is read was written, whole, and says how old it is."""

import os

import pytest
from hypothesis import given
from hypothesis import strategies as st

from vision_core.clock import Instant
from vision_core.rtdb.layout import RecordSpec, offsets
from vision_core.rtdb.slots import BEGUN, SlotReader, SlotWriter
from vision_core.rtdb.store import Store, create_block

MS = 1_000_000


def make(spec: RecordSpec) -> tuple[Store, SlotWriter, SlotReader]:
    block = create_block([spec])
    store = Store([spec], block)
    os.close(block)  # the mapping keeps it alive
    return store, store.writer(spec.name), store.reader(spec.name)


def test_nothing_before_the_first_write() -> None:
    _store, _writer, reader = make(RecordSpec("a", 16, 1.0))
    assert reader.read(Instant(0)) is None
    assert reader.view() is None


@given(st.lists(st.binary(max_size=64), min_size=1, max_size=20))
def test_read_gives_the_newest(values: list[bytes]) -> None:
    store, writer, reader = make(RecordSpec("a", 64, 1.0))
    for sequence, value in enumerate(values, start=1):
        writer.write(value, Instant(sequence), Instant(sequence))
        reading = reader.read(Instant(sequence))
        assert reading is not None
        assert (reading.value, reading.sequence, reading.measured) == (value, sequence, sequence)
    store.close()


def test_age_counts_from_the_measurement() -> None:
    _store, writer, reader = make(RecordSpec("a", 16, 0.25))
    writer.write(b"x", Instant(1000 * MS), Instant(1100 * MS))
    young, old = reader.read(Instant(1250 * MS)), reader.read(Instant(1251 * MS))
    assert young is not None
    assert old is not None
    assert young.age_s == pytest.approx(0.25)
    assert young.valid
    assert not old.valid


def test_validity_zero_is_for_ever() -> None:
    _store, writer, reader = make(RecordSpec("a", 16, 0.0))
    writer.write(b"x", Instant(0), Instant(0))
    reading = reader.read(Instant(10**15))
    assert reading is not None
    assert reading.valid


def test_a_writer_that_died_midway_leaves_the_previous_value() -> None:
    store, writer, reader = make(RecordSpec("a", 16, 0.0))
    writer.write(b"whole", Instant(1), Instant(1))
    writer.begin()[:4] = b"half"  # and then it dies
    reading = reader.read(Instant(1))
    assert reading is not None
    assert reading.value == b"whole"
    store.writer("a").write(b"next", Instant(2), Instant(2))
    reading = reader.read(Instant(2))
    assert reading is not None
    assert (reading.value, reading.sequence) == (b"next", 2)


def test_a_glance_notices_that_it_was_overtaken() -> None:
    spec = RecordSpec("a", 16, 0.0, checksum=False)
    _store, writer, reader = make(spec)
    writer.write(b"first", Instant(1), Instant(1))
    view = reader.view()
    assert view is not None
    for index in range(spec.slots - 1):
        writer.write(b"later", Instant(index), Instant(index))
        assert reader.is_unchanged(view)
    writer.begin()
    assert not reader.is_unchanged(view)


def test_a_damaged_payload_is_never_delivered() -> None:
    _store, writer, reader = make(RecordSpec("a", 16, 0.0))
    writer.write(b"payload", Instant(1), Instant(1))
    reader._payloads[1][0] = ord("X")
    assert reader.read(Instant(1)) is None


def test_a_slot_being_refilled_is_not_read() -> None:
    _store, writer, reader = make(RecordSpec("a", 16, 0.0))
    writer.write(b"payload", Instant(1), Instant(1))
    reader._fields[1][BEGUN] = 5
    assert reader.read(Instant(1)) is None


def test_too_large_a_value_is_our_own_mistake() -> None:
    _store, writer, _reader = make(RecordSpec("a", 4, 0.0))
    with pytest.raises(ValueError, match="holds 4 bytes; 5"):
        writer.write(b"12345", Instant(0), Instant(0))


def test_records_do_not_overlap() -> None:
    specs = [RecordSpec("a", 100, 0.0), RecordSpec("b", 1, 0.0), RecordSpec("c", 5000, 0.0)]
    places, size = offsets(specs)
    ends = [places[spec.name] + spec.total_bytes for spec in specs]
    assert [places["a"], places["b"], places["c"], size] == [0, *ends]


def test_a_name_twice_is_refused() -> None:
    with pytest.raises(ValueError, match="declared twice"):
        offsets([RecordSpec("a", 1, 0.0), RecordSpec("a", 2, 0.0)])


def test_torn_reads_are_never_delivered() -> None:
    """A writer in another process at full speed: every value read is whole and sequences never go back."""
    spec = RecordSpec("a", 4096, 0.0)
    block = create_block([spec])
    store = Store([spec], block)
    reader = store.reader("a")
    child = os.fork()
    if child == 0:
        writer = store.writer("a")
        for index in range(100_000):
            writer.write(bytes([index % 256]) * 4096, Instant(index), Instant(index))
        os._exit(0)
    delivered, last = 0, 0
    while os.waitpid(child, os.WNOHANG) == (0, 0):
        reading = reader.read(Instant(0))
        if reading is not None:
            assert reading.value == bytes([(reading.sequence - 1) % 256]) * 4096
            assert reading.sequence >= last
            delivered, last = delivered + 1, reading.sequence
    os.close(block)
    assert delivered > 100
