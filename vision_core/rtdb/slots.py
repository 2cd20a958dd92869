"""One record's ring of slots: the writer and the reader.

Layout: ``head`` (u64: how often it was written), then the slots. A slot: begun, ended (u64 sequence
numbers), measured, written (ns), length, checksum, then the payload. Write k goes to slot k mod n:

    begun = k; payload and the other fields; ended = k; head = k

A reader takes h = head and accepts the slot if ended = h before the copy and begun = h after it.
A writer that dies in between leaves the head where it was: readers keep the previous value, and the
next writer fills the same slot again.

Python copies eight aligned bytes at once and x86-64 keeps the order of stores; where a processor does
not (arm64), the checksum detects what the sequence numbers miss.
"""

import zlib
from dataclasses import dataclass

from vision_core.clock import Instant, seconds_between
from vision_core.rtdb.layout import CACHE_LINE, SLOT_HEADER, RecordSpec

BEGUN, ENDED, MEASURED, WRITTEN, LENGTH, CHECKSUM = range(6)
READ_TRIES = 3


@dataclass(frozen=True, slots=True)
class Reading:
    """A value that was read, with its age and validity."""

    value: bytes
    sequence: int
    measured: Instant
    """The instant that the value describes."""
    written: Instant
    age_s: float
    """Since it was measured."""
    valid: bool


@dataclass(frozen=True, slots=True)
class SlotView:
    """A slot in place, without a copy. After using it, check with ``SlotReader.is_unchanged`` that it still holds."""

    payload: memoryview
    sequence: int
    measured: Instant
    written: Instant


class _Ring:
    """The memory of one record."""

    def __init__(self, memory: memoryview, spec: RecordSpec) -> None:
        self.spec = spec
        self._head = memory[:8].cast("Q")
        self._fields: list[memoryview] = []
        self._payloads: list[memoryview] = []
        for index in range(spec.slots):
            start = CACHE_LINE + index * spec.slot_bytes
            self._fields.append(memory[start : start + 48].cast("Q"))
            body = start + SLOT_HEADER
            self._payloads.append(memory[body : body + spec.capacity])

    @property
    def sequence(self) -> int:
        """Number of the newest write; 0 before the first."""
        return int(self._head[0])

    def payload(self, slot: int) -> memoryview:
        """A slot's payload, for a process that fills it at the request of the record's writer."""
        return self._payloads[slot]

    def release(self) -> None:
        """Release the memory, so that it can be unmapped."""
        for view in (self._head, *self._fields, *self._payloads):
            view.release()


class SlotWriter(_Ring):
    """The one writer of a record. A new writer continues where its predecessor stopped."""

    def write(self, value: bytes | memoryview, measured: Instant, now: Instant) -> int:
        """Publish a value; returns its sequence number. Raises ValueError when it is too large."""
        if len(value) > self.spec.capacity:
            raise ValueError(f"record {self.spec.name!r} holds {self.spec.capacity} bytes; {len(value)} were written")
        self.begin()[: len(value)] = value
        return self.commit(len(value), measured, now)

    def begin(self) -> memoryview:
        """Open the next slot. Returns its payload, to be filled in place."""
        self._fields[self.next_slot][BEGUN] = self._head[0] + 1
        return self._payloads[self.next_slot]

    @property
    def next_slot(self) -> int:
        """Number of the slot that the next write fills."""
        return (int(self._head[0]) + 1) % self.spec.slots

    def commit(self, length: int, measured: Instant, now: Instant) -> int:
        """Publish the slot that ``begin`` opened; returns its sequence number."""
        sequence = int(self._head[0]) + 1
        index = sequence % self.spec.slots
        fields = self._fields[index]
        fields[MEASURED], fields[WRITTEN], fields[LENGTH] = measured, now, length
        fields[CHECKSUM] = zlib.crc32(self._payloads[index][:length]) if self.spec.checksum else 0
        fields[ENDED] = sequence
        self._head[0] = sequence
        return sequence


class SlotReader(_Ring):
    """A reader of a record."""

    def read(self, now: Instant) -> Reading | None:
        """The newest value with its age; None before the first write, or when READ_TRIES copies were overwritten."""
        for _ in range(READ_TRIES):
            view = self.view()
            if view is None:
                continue
            value = bytes(view.payload)
            index = view.sequence % self.spec.slots
            checksum = self._fields[index][CHECKSUM]
            if self.is_unchanged(view) and (not self.spec.checksum or zlib.crc32(value) == checksum):
                age = seconds_between(view.measured, now)
                limit = self.spec.validity_s
                valid = limit == 0.0 or age <= limit
                return Reading(value, view.sequence, view.measured, view.written, age, valid)
        return None

    def view(self) -> SlotView | None:
        """The newest slot in place; None before the first write, or while it is being overwritten."""
        sequence = int(self._head[0])
        fields = self._fields[sequence % self.spec.slots]
        if not sequence or fields[ENDED] != sequence or fields[BEGUN] != sequence:
            return None
        length = min(fields[LENGTH], self.spec.capacity)
        payload = self._payloads[sequence % self.spec.slots][:length]
        return SlotView(payload, sequence, Instant(fields[MEASURED]), Instant(fields[WRITTEN]))

    def is_unchanged(self, view: SlotView) -> bool:
        """Does the slot still hold the value of the view?"""
        return bool(self._fields[view.sequence % self.spec.slots][BEGUN] == view.sequence)
