"""Torn reads of the real-time database: how often readers accept a value that was only half written. Must be 0.

Setup: one writer and four readers, each a process of its own, at full speed on one record. Three trials: a packed
record of 4 kB with checksum, as tasks exchange them; an image of 900 kB without checksum, written in place; and a
record of 4 kB without checksum whose writer is a C program (``baselines/ring.c``). It writes in bursts, so that readers
are overtaken in the middle of a copy again and again and the sequence numbers alone must detect it.

Measured: wrong payloads that a reader accepted, beside the numbers of writes and reads. Every payload can be checked
without the ring's own checksum (``PayloadCheck``): its length, its instants and each 64-bit word follow from the
sequence number, and no word equals that of another write. One wrong byte makes a payload wrong.

Each trial has a control that must find wrong payloads, else the trial proves nothing: the same processes on a ring of
one slot, with readers that ignore the sequence numbers.

    python -m bench.torn_reads {write,read} TRIAL DESCRIPTOR        one of the processes; ``measure`` starts them
"""

import contextlib
import json
import mmap
import os
import subprocess
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from bench.baselines.build import build_program
from bench.helpers import READY, ROOT
from bench.runner import Row
from vision_core.clock import NS_PER_S, Instant
from vision_core.geometry import Bytes
from vision_core.rtdb.layout import RecordSpec
from vision_core.rtdb.slots import SlotReader, SlotView, SlotWriter
from vision_core.rtdb.store import Store, create_block

READERS = 4
CONTROL_SHARE = 1 / 6
"""Of a trial's duration."""
FIRST_WRITE_POLL_S = 0.001
STEP, STRIDE, WORD = 0x9E3779B97F4A7C15, 0xD1B54A32D192ED03, (1 << 64) - 1
"""Odd, so that no word of one write equals that of another. The same as in ``baselines/ring.c``."""
MEASURED_NS, TOOK_NS = 1000, 7

Tally = dict[str, int]
Accepted = tuple[int, Instant, Instant, Bytes]
"""What a reader accepted as a value: sequence number, instants measured and written, payload."""


@dataclass(frozen=True, slots=True)
class Trial:
    """One record, and how it is written and read."""

    title: str
    spec: RecordSpec
    image: bool = False
    """Written in place and read as ``scheduling.latest_image`` does; otherwise packed, of varying length."""
    ignores_sequence: bool = False
    """Readers do not check the sequence numbers."""
    writer_in_c: bool = False
    """The writer is the baseline in C."""

    def control(self) -> "Trial":
        """The same record in a setup in which torn reads are accepted."""
        return replace(self, spec=replace(self.spec, slots=1, checksum=False), ignores_sequence=True)


PACKED = Trial("packed record of 4 kB, CRC", RecordSpec("packed", 4096, 0.0))
IMAGE = Trial("image of 900 kB, no CRC", RecordSpec("image", 640 * 480 * 3, 0.0, checksum=False), image=True)
BURSTS = Trial("record of 4 kB, no CRC, writer in C", RecordSpec("bursts", 4096, 0.0, checksum=False), writer_in_c=True)
TRIALS = {
    "packed": PACKED,
    "packed-control": PACKED.control(),
    "image": IMAGE,
    "image-control": IMAGE.control(),
    "bursts": BURSTS,
    "bursts-control": BURSTS.control(),
}


class PayloadCheck:
    """The payload of each write of a trial, by its sequence number."""

    def __init__(self, trial: Trial) -> None:
        self._capacity = trial.spec.capacity
        self._spread = 1 if trial.image else self._capacity // 2
        with np.errstate(over="ignore"):
            self._table = np.arange(1, self._capacity // 8 + 1, dtype=np.uint64) * np.uint64(STRIDE)
        self._words = np.empty_like(self._table)

    def length(self, sequence: int) -> int:
        """Length of the payload with a sequence number [bytes]."""
        return self._capacity - sequence * 7919 % self._spread

    def fill(self, memory: memoryview, sequence: int) -> None:
        """Write the payload at full length into memory."""
        np.bitwise_xor(self._table, np.uint64(sequence * STEP & WORD), out=np.frombuffer(memory, dtype=np.uint64))

    def payload(self, sequence: int) -> Bytes:
        """The payload, shape (n,); the next call overwrites it."""
        self.fill(self._words.data.cast("B"), sequence)
        return self._words.view(np.uint8)[: self.length(sequence)]

    def is_correct(self, accepted: Accepted) -> bool:
        """Is an accepted value what was written, in every byte?"""
        sequence, measured, written, payload = accepted
        expected = measured_at(sequence)
        return (measured, written) == (expected, expected + TOOK_NS) and np.array_equal(payload, self.payload(sequence))


class UncheckedReader(SlotReader):
    """The control's reader: ignores the sequence numbers."""

    def view(self) -> SlotView | None:
        """The newest slot, whether its write has finished or not."""
        sequence = self.sequence
        index = sequence % self.spec.slots
        _begun, _ended, measured, written, length, _checksum = self._fields[index].tolist()
        payload = self._payloads[index][: min(length, self.spec.capacity)]
        return SlotView(payload, sequence, Instant(measured), Instant(written)) if sequence else None

    def is_unchanged(self, view: SlotView) -> bool:  # noqa: ARG002
        """Always True."""
        return True


def run(seconds: float = 60.0) -> list[Row]:
    """Every trial with its control. seconds: how long a trial lasts."""
    rows: list[Row] = []
    for key in ("packed", "image", "bursts"):
        program, message = build_program("ring") if TRIALS[key].writer_in_c else (None, "")
        if TRIALS[key].writer_in_c and program is None:
            rows.append({"name": f"{TRIALS[key].title}: {message}"})
            continue
        tally = measure(key, seconds, program)
        control = measure(f"{key}-control", seconds * CONTROL_SHARE, program)
        rows += _rows(TRIALS[key].title, tally, control)
    return rows


def _rows(title: str, tally: Tally, control: Tally) -> list[Row]:
    has_values = tally["reads"] > tally["none"]
    name = f"{title}: control, one slot, sequence ignored"
    wrong, control_wrong = tally["wrong"], control["wrong"]
    return [
        {"name": f"{title}: wrong payloads accepted", "value": wrong, "goal": "0", "met": has_values and wrong == 0},
        {"name": f"{title}: writes", "value": tally["writes"]},
        {"name": f"{title}: reads by {READERS} readers", "value": tally["reads"]},
        {"name": f"{title}: reads without a value", "value": tally["none"]},
        {"name": f"{name}: wrong payloads accepted", "value": control_wrong, "goal": "> 0", "met": control_wrong > 0},
        {"name": f"{name}: reads", "value": control["reads"]},
    ]


def measure(key: str, seconds: float, program: Path | None = None) -> Tally:
    """Run one trial. Returns the numbers of writes, reads, reads without a value, and wrong payloads.

    program: the writer in C, for trials that need it. Raises RuntimeError when a process fails.
    """
    trial = TRIALS[key]
    descriptor = create_block([trial.spec])
    module = [sys.executable, "-m", "bench.torn_reads"]
    writer = [*module, "write", key, str(descriptor)]
    if trial.writer_in_c:
        layout = (trial.spec.capacity, trial.spec.slots, trial.spec.slot_bytes)
        writer = [str(program), str(descriptor), *map(str, layout)]
    commands = [writer, *([*module, "read", key, str(descriptor)] for _ in range(READERS))]
    with contextlib.ExitStack() as stack:
        stack.callback(os.close, descriptor)
        processes = [stack.enter_context(_started(command, descriptor)) for command in commands]
        for process in processes:
            stack.callback(process.kill)
        tallies = _collected(processes, seconds)
    return {name: sum(tally.get(name, 0) for tally in tallies) for name in ("writes", "reads", "none", "wrong")}


def _started(command: list[str], descriptor: int) -> "subprocess.Popen[str]":
    pipe = subprocess.PIPE
    return subprocess.Popen(command, stdin=pipe, stdout=pipe, text=True, pass_fds=(descriptor,), cwd=ROOT)


def _collected(processes: list["subprocess.Popen[str]"], seconds: float) -> list[Tally]:
    """Start all processes when all are ready. Returns what each printed."""
    for process in processes:
        assert process.stdout is not None
        if (line := process.stdout.readline().strip()) != READY:
            raise RuntimeError(f"{process.args!r}: its first line is {line!r}; {READY!r} was expected")
    end = time.monotonic_ns() + round(seconds * NS_PER_S)
    for process in processes:
        assert process.stdin is not None
        process.stdin.write(f"{end}\n")
        process.stdin.flush()
    tallies = []
    for process in processes:
        output, _ = process.communicate()
        if process.returncode:
            raise RuntimeError(f"{process.args!r} ended with {process.returncode}; 0 was expected")
        tallies.append(json.loads(output))
    return tallies


def measured_at(sequence: int) -> Instant:
    """The instant measured of a write, by its sequence number; the instant written is TOOK_NS later."""
    return Instant(sequence * MEASURED_NS)


def write(trial: Trial, descriptor: int, end: int) -> Tally:
    """Write until an instant [ns of CLOCK_MONOTONIC]. Returns the number of writes."""
    writer, check, sequence = Store([trial.spec], descriptor).writer(trial.spec.name), PayloadCheck(trial), 0
    while time.monotonic_ns() < end:
        sequence += 1
        publish(trial, writer, check, sequence)
    return {"writes": sequence}


def publish(trial: Trial, writer: SlotWriter, check: PayloadCheck, sequence: int) -> None:
    """Write one payload."""
    measured = measured_at(sequence)
    if trial.image:
        check.fill(writer.begin(), sequence)
        writer.commit(check.length(sequence), measured, Instant(measured + TOOK_NS))
    else:
        writer.write(check.payload(sequence).data, measured, Instant(measured + TOOK_NS))


def read(trial: Trial, descriptor: int, end: int) -> Tally:
    """Read and check from the first write until an instant [ns of CLOCK_MONOTONIC]. Returns the counts."""
    reader, check, reads, none, wrong = reader_of(trial, descriptor), PayloadCheck(trial), 0, 0, 0
    take = image_reader(reader) if trial.image else value_reader(reader)
    while not reader.sequence and time.monotonic_ns() < end:
        time.sleep(FIRST_WRITE_POLL_S)
    while time.monotonic_ns() < end:
        reads += 1
        accepted = take()
        if accepted is None:
            none += 1
        elif not check.is_correct(accepted):
            wrong += 1
    return {"reads": reads, "none": none, "wrong": wrong}


def reader_of(trial: Trial, descriptor: int) -> SlotReader:
    """The reader of a trial's record."""
    if not trial.ignores_sequence:
        return Store([trial.spec], descriptor).reader(trial.spec.name)
    return UncheckedReader(memoryview(mmap.mmap(descriptor, trial.spec.total_bytes)), trial.spec)


def value_reader(reader: SlotReader) -> Callable[[], Accepted | None]:
    """Reads packed values as the tasks do, with up to three attempts."""

    def take() -> Accepted | None:
        reading = reader.read(Instant(0))
        if reading is None:
            return None
        return reading.sequence, reading.measured, reading.written, np.frombuffer(reading.value, dtype=np.uint8)

    return take


def image_reader(reader: SlotReader) -> Callable[[], Accepted | None]:
    """Copies images as ``scheduling.latest_image`` does, in one attempt; None when the slot was overwritten."""
    copy = np.empty(reader.spec.capacity, dtype=np.uint8)

    def take() -> Accepted | None:
        view = reader.view()
        if view is None:
            return None
        length = len(view.payload)
        np.copyto(copy[:length], np.frombuffer(view.payload, dtype=np.uint8))
        return (view.sequence, view.measured, view.written, copy[:length]) if reader.is_unchanged(view) else None

    return take


def main(role: str, key: str, descriptor: str) -> None:
    """One process of a trial: prints ``ready``, reads the end [ns] from standard input, prints its counts."""
    print(READY, flush=True)
    work = {"write": write, "read": read}[role]
    print(json.dumps(work(TRIALS[key], int(descriptor), int(sys.stdin.readline()))))


if __name__ == "__main__":
    main(*sys.argv[1:])
