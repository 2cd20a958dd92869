"""Names of the service's processes by their ids: of the supervisor's table, else as the kernel knows them."""

import json
from collections.abc import Callable
from pathlib import Path

from vision_core.rtdb.slots import SlotReader
from vision_core.scheduling.attachment import monotonic

PREFIX = "pslv:"
"""The processes of a service are called so; see ``attachment.name_process``."""
MAX_KNOWN = 256
"""Ids that are kept: also of processes that have ended, whose last words may still come."""


def unnamed(pid: int) -> str:
    """What a process is called that nobody knows."""
    return f"process {pid}"


class ProcessNames:
    """Knows every process of which the supervisor's table has told."""

    def __init__(self, table: SlotReader, name_of_stranger: Callable[[int], str] | None = None) -> None:
        """table: the record ``processes``; name_of_stranger: of a process that is not in it."""
        self._table = table
        self._name_of_stranger = name_of_stranger or named_by_kernel
        self._read = 0
        """Number of the table that was read last."""
        self._names: dict[int, str] = {}

    def of(self, pid: int) -> str:
        """The name of a process."""
        if self._table.sequence != self._read:
            self._take_over()
        if pid not in self._names:
            self._know(pid, self._name_of_stranger(pid))
        return self._names[pid]

    def _take_over(self) -> None:
        reading = self._table.read(monotonic())
        if reading is None:
            return
        self._read = reading.sequence
        for row in json.loads(reading.value)["processes"]:
            if row["pid"] is not None:
                self._know(row["pid"], row["name"])

    def _know(self, pid: int, name: str) -> None:
        self._names.pop(pid, None)
        self._names[pid] = name
        while len(self._names) > MAX_KNOWN:
            del self._names[next(iter(self._names))]


def named_by_kernel(pid: int) -> str:
    """The name that a process of the service gave itself: the supervisor's, or that of one that has just begun."""
    try:
        name = Path(f"/proc/{pid}/comm").read_text(errors="replace").strip()
    except OSError:
        name = ""
    return name.removeprefix(PREFIX) if name.startswith(PREFIX) else unnamed(pid)
