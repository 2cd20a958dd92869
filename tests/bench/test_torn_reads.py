"""The test for torn reads can fail: every wrong byte is found, and the control accepts torn values."""

import os

import numpy as np
import pytest

from bench import torn_reads
from bench.baselines.build import build_program
from bench.torn_reads import IMAGE, PACKED, TRIALS, PayloadCheck, Trial
from vision_core.clock import Instant
from vision_core.rtdb.slots import SlotReader, SlotWriter
from vision_core.rtdb.store import Store, create_block


def make(trial: Trial) -> tuple[SlotWriter, SlotReader]:
    block = create_block([trial.spec])
    writer, reader = Store([trial.spec], block).writer(trial.spec.name), torn_reads.reader_of(trial, block)
    os.close(block)  # the mappings keep it alive
    return writer, reader


@pytest.mark.parametrize("trial", [PACKED, IMAGE, PACKED.control(), IMAGE.control()])
def test_a_whole_write_is_accepted_and_correct(trial: Trial) -> None:
    (writer, reader), check = make(trial), PayloadCheck(trial)
    take = torn_reads.image_reader(reader) if trial.image else torn_reads.value_reader(reader)
    assert take() is None
    for sequence in range(1, 8):
        torn_reads.publish(trial, writer, check, sequence)
        accepted = take()
        assert accepted is not None
        assert accepted[0] == sequence
        assert check.is_correct(accepted)


@pytest.mark.parametrize("trial", [PACKED, IMAGE])
def test_no_word_of_one_write_equals_that_of_another(trial: Trial) -> None:
    check = PayloadCheck(trial)
    size = trial.spec.capacity // 2 // 8 * 8
    one = check.payload(1000)[:size].view(np.uint64).copy()
    for other in (996, 999, 1001, 1004):
        assert (check.payload(other)[:size].view(np.uint64) != one).all()


@pytest.mark.parametrize("trial", [PACKED, IMAGE])
def test_one_wrong_byte_or_instant_is_found(trial: Trial) -> None:
    check = PayloadCheck(trial)
    measured = torn_reads.measured_at(5)
    written = Instant(measured + torn_reads.TOOK_NS)
    payload = check.payload(5).copy()
    assert check.is_correct((5, measured, written, payload))
    assert not check.is_correct((6, measured, written, payload))
    assert not check.is_correct((5, measured, measured, payload))
    assert not check.is_correct((5, measured, written, payload[:-1]))
    payload[-1] ^= 1
    assert not check.is_correct((5, measured, written, payload))


@pytest.mark.parametrize("trial", [PACKED, IMAGE])
def test_only_the_control_accepts_a_half_written_slot(trial: Trial) -> None:
    for kind, torn in ((trial, False), (trial.control(), True)):
        (writer, reader), check = make(kind), PayloadCheck(kind)
        take = torn_reads.image_reader(reader) if kind.image else torn_reads.value_reader(reader)
        torn_reads.publish(kind, writer, check, 1)
        writer.begin()[:8] = b"halfway!"
        accepted = take()
        assert accepted is not None
        assert check.is_correct(accepted) is not torn


def test_a_reader_detects_that_its_slot_was_overwritten() -> None:
    (writer, reader), check = make(IMAGE), PayloadCheck(IMAGE)
    torn_reads.publish(IMAGE, writer, check, 1)
    view = reader.view()
    assert view is not None
    for sequence in (2, 3, 4):
        torn_reads.publish(IMAGE, writer, check, sequence)
    assert reader.is_unchanged(view)
    writer.begin()
    assert not reader.is_unchanged(view)


@pytest.mark.slow
@pytest.mark.parametrize("key", sorted(TRIALS))
def test_processes_at_full_speed(key: str) -> None:
    program, message = build_program("ring") if TRIALS[key].writer_in_c else (None, "")
    if TRIALS[key].writer_in_c and program is None:
        pytest.skip(message)
    tally = torn_reads.measure(key, 0.5, program)
    assert tally["writes"] > 0
    assert tally["reads"] > tally["none"]
    assert (tally["wrong"] > 0) is TRIALS[key].ignores_sequence
