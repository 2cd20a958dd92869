"""Torn reads of the real-time database: one writer and four readers, each a process of its own, at full speed.

Every payload proves itself, without the ring's checksum: its length, its instants and every 64-bit word follow from
the number of the write, and no word equals the one that another write puts in its place. A reader compares the whole
of what it was given with what it should be; one wrong byte makes a wrong payload.

The controls show that the test can fail: the same processes on a ring of one slot whose reader looks at no sequence
number. Where there is a compiler, a writer in C (``twins/ring.c``) fills the ring in bursts, without checksum, so that
readers are overtaken in the middle of a copy again and again, and the sequence numbers alone must notice.

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
from bench.runner import Row
from vision_core.clock import NS_PER_S, Instant
from vision_core.geometry import Bytes
from vision_core.rtdb.layout import RecordSpec
from vision_core.rtdb.slots import SlotReader, SlotView, SlotWriter
from vision_core.rtdb.store import Store, create_block

ROOT = Path(__file__).parents[1]
READERS = 4
CONTROL_SHARE = 1 / 6
"""Of the time: a control shows at once what it shows."""
FIRST_WRITE_NAP_S = 0.001
STEP, STRIDE, WORD = 0x9E3779B97F4A7C15, 0xD1B54A32D192ED03, (1 << 64) - 1
"""Odd, so that two writes agree in no word. As in ``twins/ring.c``."""
MEASURED_NS, TOOK_NS = 1000, 7

Tally = dict[str, int]
Delivered = tuple[int, Instant, Instant, Bytes]
"""Sequence, measured, written and payload that a reader was given as good."""


@dataclass(frozen=True, slots=True)
class Trial:
    """One record and how it is written and read."""

    title: str
    spec: RecordSpec
    image: bool = False
    """Written in place, all of it, and read as ``tasks.images`` does; otherwise packed and of varying length."""
    careless: bool = False
    """Readers look at no sequence number."""
    twin: bool = False
    """The writer is the one in C."""

    def control(self) -> "Trial":
        """The same record where it can be torn."""
        return replace(self, spec=replace(self.spec, slots=1, checksum=False), careless=True)


PACKED = Trial("packed record of 4 kB, CRC", RecordSpec("packed", 4096, 0.0))
IMAGE = Trial("image of 900 kB, no CRC", RecordSpec("image", 640 * 480 * 3, 0.0, checksum=False), image=True)
HASTY = Trial("record of 4 kB, no CRC, writer in C", RecordSpec("hasty", 4096, 0.0, checksum=False), twin=True)
TRIALS = {
    "packed": PACKED,
    "packed-control": PACKED.control(),
    "image": IMAGE,
    "image-control": IMAGE.control(),
    "hasty": HASTY,
    "hasty-control": HASTY.control(),
}


class Proof:
    """What write number k of a trial must be."""

    def __init__(self, trial: Trial) -> None:
        self._capacity = trial.spec.capacity
        self._spread = 1 if trial.image else self._capacity // 2
        with np.errstate(over="ignore"):
            self._table = np.arange(1, self._capacity // 8 + 1, dtype=np.uint64) * np.uint64(STRIDE)
        self._words = np.empty_like(self._table)

    def length(self, sequence: int) -> int:
        """Length of a payload [bytes]."""
        return self._capacity - sequence * 7919 % self._spread

    def fill(self, memory: memoryview, sequence: int) -> None:
        """Write a whole payload in place."""
        np.bitwise_xor(self._table, np.uint64(sequence * STEP & WORD), out=np.frombuffer(memory, dtype=np.uint64))

    def payload(self, sequence: int) -> Bytes:
        """A payload, in memory that the next call uses again."""
        self.fill(self._words.data.cast("B"), sequence)
        return self._words.view(np.uint8)[: self.length(sequence)]

    def holds(self, delivered: Delivered) -> bool:
        """Is it what was written, in every byte?"""
        sequence, measured, written, payload = delivered
        due = measured_at(sequence)
        return (measured, written) == (due, due + TOOK_NS) and np.array_equal(payload, self.payload(sequence))


class CarelessReader(SlotReader):
    """The control: takes what lies in the slot."""

    def view(self) -> SlotView | None:
        """The slot in place, finished or not."""
        sequence = self.sequence
        index = sequence % self.spec.slots
        _begun, _ended, measured, written, length, _checksum = self._fields[index].tolist()
        payload = self._payloads[index][: min(length, self.spec.capacity)]
        return SlotView(payload, sequence, Instant(measured), Instant(written)) if sequence else None

    def is_unchanged(self, view: SlotView) -> bool:  # noqa: ARG002
        """Never in doubt."""
        return True


def run(seconds: float = 60.0) -> list[Row]:
    """Every trial with its control; seconds: how long a trial lasts."""
    rows: list[Row] = []
    for key in ("packed", "image", "hasty"):
        program, word = build_program("ring") if TRIALS[key].twin else (None, "")
        if TRIALS[key].twin and program is None:
            rows.append({"name": f"{TRIALS[key].title}: {word}"})
            continue
        tally = measure(key, seconds, program)
        control = measure(f"{key}-control", seconds * CONTROL_SHARE, program)
        rows += _rows(TRIALS[key].title, tally, control)
    return rows


def _rows(title: str, tally: Tally, control: Tally) -> list[Row]:
    answered = tally["reads"] > tally["none"]
    wrong, torn = tally["wrong"], control["wrong"]
    return [
        {"name": f"{title}: wrong payloads delivered", "value": wrong, "goal": "0", "met": answered and wrong == 0},
        {"name": f"{title}: writes", "value": tally["writes"]},
        {"name": f"{title}: reads by {READERS} readers", "value": tally["reads"]},
        {"name": f"{title}: reads without a value", "value": tally["none"]},
        {"name": f"{title}: control, one slot, unchecked: wrong", "value": torn, "goal": "> 0", "met": torn > 0},
        {"name": f"{title}: control, one slot, unchecked: reads", "value": control["reads"]},
    ]


def measure(key: str, seconds: float, program: Path | None = None) -> Tally:
    """Run one trial: how often was written and read, and with what result.

    program: the writer in C, for trials that want it. Raises RuntimeError when a process fails.
    """
    trial = TRIALS[key]
    descriptor = create_block([trial.spec])
    itself = [sys.executable, "-m", "bench.torn_reads"]
    writer = [*itself, "write", key, str(descriptor)]
    if trial.twin:
        layout = (trial.spec.capacity, trial.spec.slots, trial.spec.slot_bytes)
        writer = [str(program), str(descriptor), *map(str, layout)]
    commands = [writer, *([*itself, "read", key, str(descriptor)] for _ in range(READERS))]
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
    """Let all begin when all are ready; what each printed."""
    for process in processes:
        assert process.stdout is not None
        if (said := process.stdout.readline().strip()) != "ready":
            raise RuntimeError(f"{process.args!r} should say 'ready'; it said {said!r}")
    end = time.monotonic_ns() + round(seconds * NS_PER_S)
    for process in processes:
        assert process.stdin is not None
        process.stdin.write(f"{end}\n")
        process.stdin.flush()
    tallies = []
    for process in processes:
        said, _ = process.communicate()
        if process.returncode:
            raise RuntimeError(f"{process.args!r} ended with {process.returncode}; 0 was expected")
        tallies.append(json.loads(said))
    return tallies


def measured_at(sequence: int) -> Instant:
    """The instant that a write says it was measured at; it says that it was written TOOK_NS later."""
    return Instant(sequence * MEASURED_NS)


def write(trial: Trial, descriptor: int, end: int) -> Tally:
    """Write until an instant."""
    writer, proof, sequence = Store([trial.spec], descriptor).writer(trial.spec.name), Proof(trial), 0
    while time.monotonic_ns() < end:
        sequence += 1
        publish(trial, writer, proof, sequence)
    return {"writes": sequence}


def publish(trial: Trial, writer: SlotWriter, proof: Proof, sequence: int) -> None:
    """Write one payload."""
    measured = measured_at(sequence)
    if trial.image:
        proof.fill(writer.begin(), sequence)
        writer.commit(proof.length(sequence), measured, Instant(measured + TOOK_NS))
    else:
        writer.write(proof.payload(sequence).data, measured, Instant(measured + TOOK_NS))


def read(trial: Trial, descriptor: int, end: int) -> Tally:
    """Read until an instant, from the first write on."""
    reader, proof, reads, none, wrong = reader_of(trial, descriptor), Proof(trial), 0, 0, 0
    take = taking_images(reader) if trial.image else taking_values(reader)
    while not reader.sequence and time.monotonic_ns() < end:
        time.sleep(FIRST_WRITE_NAP_S)
    while time.monotonic_ns() < end:
        reads += 1
        delivered = take()
        if delivered is None:
            none += 1
        elif not proof.holds(delivered):
            wrong += 1
    return {"reads": reads, "none": none, "wrong": wrong}


def reader_of(trial: Trial, descriptor: int) -> SlotReader:
    """The reader of a trial's record, careless or not."""
    if not trial.careless:
        return Store([trial.spec], descriptor).reader(trial.spec.name)
    return CarelessReader(memoryview(mmap.mmap(descriptor, trial.spec.total_bytes)), trial.spec)


def taking_values(reader: SlotReader) -> Callable[[], Delivered | None]:
    """Reads as everybody does who reads a packed record: up to three tries."""

    def take() -> Delivered | None:
        reading = reader.read(Instant(0))
        if reading is None:
            return None
        return reading.sequence, reading.measured, reading.written, np.frombuffer(reading.value, dtype=np.uint8)

    return take


def taking_images(reader: SlotReader) -> Callable[[], Delivered | None]:
    """Takes copies as ``tasks.images`` does, with one try; None when the slot was overwritten meanwhile."""
    copy = np.empty(reader.spec.capacity, dtype=np.uint8)

    def take() -> Delivered | None:
        view = reader.view()
        if view is None:
            return None
        length = len(view.payload)
        np.copyto(copy[:length], np.frombuffer(view.payload, dtype=np.uint8))
        return (view.sequence, view.measured, view.written, copy[:length]) if reader.is_unchanged(view) else None

    return take


def main(role: str, key: str, descriptor: str) -> None:
    """One process of a trial: says that it is ready, is told the end [ns], prints its tally."""
    print("ready", flush=True)
    work = {"write": write, "read": read}[role]
    print(json.dumps(work(TRIALS[key], int(descriptor), int(sys.stdin.readline()))))


if __name__ == "__main__":
    main(*sys.argv[1:])
