"""The block of shared memory that holds all records."""

import mmap
import os
from collections.abc import Sequence

from vision_core.rtdb.layout import RecordSpec, offsets
from vision_core.rtdb.slots import SlotReader, SlotWriter


def create_block(specs: Sequence[RecordSpec]) -> int:
    """Make the block. Returns its inheritable descriptor; the block lives as long as a process holds one."""
    _, size = offsets(specs)
    descriptor = os.memfd_create("pslv-rtdb", 0)
    os.ftruncate(descriptor, size)
    return descriptor


class Store:
    """A mapped block."""

    def __init__(self, specs: Sequence[RecordSpec], descriptor: int, *, read_only: bool = False) -> None:
        """read_only: map the block without the right to write.

        Raises ValueError when the block is smaller than its records.
        """
        self.specs = {spec.name: spec for spec in specs}
        self._places, size = offsets(specs)
        self._map = mmap.mmap(descriptor, size, prot=mmap.PROT_READ if read_only else mmap.PROT_READ | mmap.PROT_WRITE)
        self._view = memoryview(self._map)
        self._rings: list[SlotReader | SlotWriter] = []

    def reader(self, name: str) -> SlotReader:
        """A reader of a record. Raises KeyError for an unknown name."""
        ring = SlotReader(self._memory(name), self.specs[name])
        self._rings.append(ring)
        return ring

    def writer(self, name: str) -> SlotWriter:
        """The writer of a record. The check of the task table ensures that there is only one.

        Raises KeyError for an unknown name, ValueError when the block is mapped read-only.
        """
        if self._view.readonly:
            raise ValueError(f"the writer of record {name!r}: the block is mapped read-only")
        ring = SlotWriter(self._memory(name), self.specs[name])
        self._rings.append(ring)
        return ring

    def close(self) -> None:
        """Unmap. Readers, writers and their views must not be used afterwards."""
        for ring in self._rings:
            ring.release()
        self._view.release()
        self._map.close()

    def _memory(self, name: str) -> memoryview:
        start = self._places[name]
        return self._view[start : start + self.specs[name].total_bytes]
