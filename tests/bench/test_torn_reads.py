"""The test for torn reads can fail: payloads prove themselves, and a careless reader is caught."""

import os

import numpy as np
import pytest

from bench import torn_reads as torn
from bench.baselines.build import build_program
from bench.torn_reads import IMAGE, PACKED, TRIALS, Proof, Trial
from vision_core.clock import Instant
from vision_core.rtdb.slots import SlotReader, SlotWriter
from vision_core.rtdb.store import Store, create_block


def make(trial: Trial) -> tuple[SlotWriter, SlotReader]:
    block = create_block([trial.spec])
    writer, reader = Store([trial.spec], block).writer(trial.spec.name), torn.reader_of(trial, block)
    os.close(block)  # the mappings keep it alive
    return writer, reader


@pytest.mark.parametrize("trial", [PACKED, IMAGE, PACKED.control(), IMAGE.control()])
def test_what_was_written_whole_is_proved(trial: Trial) -> None:
    (writer, reader), proof = make(trial), Proof(trial)
    take = torn.taking_images(reader) if trial.image else torn.taking_values(reader)
    assert take() is None
    for sequence in range(1, 8):
        torn.publish(trial, writer, proof, sequence)
        delivered = take()
        assert delivered is not None
        assert delivered[0] == sequence
        assert proof.holds(delivered)


@pytest.mark.parametrize("trial", [PACKED, IMAGE])
def test_no_word_of_one_write_is_that_of_another(trial: Trial) -> None:
    proof = Proof(trial)
    size = trial.spec.capacity // 2 // 8 * 8
    one = proof.payload(1000)[:size].view(np.uint64).copy()
    for other in (996, 999, 1001, 1004):
        assert (proof.payload(other)[:size].view(np.uint64) != one).all()


@pytest.mark.parametrize("trial", [PACKED, IMAGE])
def test_one_wrong_byte_or_instant_is_seen(trial: Trial) -> None:
    proof = Proof(trial)
    measured = torn.measured_at(5)
    written = Instant(measured + torn.TOOK_NS)
    payload = proof.payload(5).copy()
    assert proof.holds((5, measured, written, payload))
    assert not proof.holds((6, measured, written, payload))
    assert not proof.holds((5, measured, measured, payload))
    assert not proof.holds((5, measured, written, payload[:-1]))
    payload[-1] ^= 1
    assert not proof.holds((5, measured, written, payload))


@pytest.mark.parametrize("trial", [PACKED, IMAGE])
def test_a_slot_filled_halfway_fools_the_control_only(trial: Trial) -> None:
    for kind, fooled in ((trial, False), (trial.control(), True)):
        (writer, reader), proof = make(kind), Proof(kind)
        take = torn.taking_images(reader) if kind.image else torn.taking_values(reader)
        torn.publish(kind, writer, proof, 1)
        writer.begin()[:8] = b"halfway!"
        delivered = take()
        assert delivered is not None
        assert proof.holds(delivered) is not fooled


def test_a_reader_that_is_overtaken_notices() -> None:
    (writer, reader), proof = make(IMAGE), Proof(IMAGE)
    torn.publish(IMAGE, writer, proof, 1)
    view = reader.view()
    assert view is not None
    for sequence in (2, 3, 4):
        torn.publish(IMAGE, writer, proof, sequence)
    assert reader.is_unchanged(view)
    writer.begin()
    assert not reader.is_unchanged(view)


@pytest.mark.slow
@pytest.mark.parametrize("key", sorted(TRIALS))
def test_processes_at_full_speed(key: str) -> None:
    program, word = build_program("ring") if TRIALS[key].twin else (None, "")
    if TRIALS[key].twin and program is None:
        pytest.skip(word)
    tally = torn.measure(key, 0.5, program)
    assert tally["writes"] > 0
    assert tally["reads"] > tally["none"]
    assert (tally["wrong"] > 0) is TRIALS[key].careless
