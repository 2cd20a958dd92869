"""One frame's datagrams and their sending: a compiled loop over the C library's ``send``.

Every session has a connected socket of its own, so each datagram takes one system call; a compiled loop saves what
Python would add to each. Nothing is allocated and no Python object is touched between the first datagram and the last.

The table has one row per session (``delivery_rows``). After the last datagram the frame is counted in the record of
fairness.
"""

import errno
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from vision_core.clock import NS_PER_S, NS_PER_US, Instant
from vision_core.geometry import Bytes
from vision_core.native.kernels import carray, external, kernel
from vision_core.net.delivery_rows import DROPPED, NEVER, NOT_SENT, REFUSED, SENT, UNREACHABLE, new_rows
from vision_core.net.fairness import FairnessRecord, note_frame
from vision_core.net.sending_order import shuffle
from vision_core.protocol.options import Options
from vision_core.types.tables import Table

NS_PER_TICK = {"ms": 1_000_000, "us": 1_000}
"""The unit of a printed Time [ns]."""
CLOCK_MONOTONIC = 1
MSG_DONTWAIT = 0x40
MSG_NOSIGNAL = 0x4000
SEND_FLAGS = MSG_DONTWAIT | MSG_NOSIGNAL
CONNECTION_REFUSED = errno.ECONNREFUSED
HOST_UNREACHABLE = errno.EHOSTUNREACH

_send = external("send", "intp(int32, uintp, uintp, int32)")
_errno_address = external("__errno_location", "CPointer(int32)()")
_clock_gettime = external("clock_gettime", "int32(int32, uintp)")


@dataclass(frozen=True, slots=True)
class Batch:
    """A frame's datagrams in one block of memory, one per row of the table; length 0: there is none."""

    text: Bytes
    starts: NDArray[np.int64]
    lengths: NDArray[np.int64]

    def datagram(self, row: int) -> memoryview:
        """The datagram for a row."""
        start = int(self.starts[row])
        return self.text[start : start + int(self.lengths[row])].data

    @staticmethod
    def of(datagrams: Sequence[bytes]) -> "Batch":
        """A batch in memory of its own."""
        lengths = np.array([len(data) for data in datagrams], dtype=np.int64)
        text = np.frombuffer(bytearray(b"".join(datagrams)) or bytearray(1), dtype=np.uint8)
        return Batch(text, np.cumsum(lengths) - lengths, lengths)


class SendBuffers(NamedTuple):
    """Memory of ``send_all``."""

    order: NDArray[np.int64]
    """Rows in the order of sending, shape (rows,)."""
    fairness: Table
    """The record of fairness, which has the seed of the order: FAIRNESS, shape (1,)."""
    now: NDArray[np.int64]
    """A struct timespec, shape (2,)."""


@kernel
def mark_due(rows: Table, at: int, boot: int, due: Bytes) -> int:
    """Mark the rows that are to get a view grabbed at an instant; returns their number.

    A row is due if its Time grows as printed and, with a period, its place on the grid is at most half a period away.
    """
    count = 0
    for k in range(len(rows)):
        row = rows[k]
        grows = row.grabbed_at == NEVER or (at - boot) // row.tick_ns > (row.grabbed_at - boot) // row.tick_ns
        due[k] = grows and (row.period_ns == 0 or at >= row.due_at - row.period_ns // 2)
        count += due[k]
    return count


@kernel
def send_all(
    rows: Table, at: int, text: Bytes, starts: NDArray[np.int64], lengths: NDArray[np.int64], buffers: SendBuffers
) -> tuple[int, int]:
    """Send each row its datagram, in a new random order; returns how many rows had one, and how many had it refused.

    at: grab of the frame [ns]; text, starts, lengths: a Batch.
    """
    order, now = buffers.order, buffers.now
    # the order of sending
    count = 0
    for k in range(len(rows)):
        rows[k].result = NOT_SENT
        if lengths[k] > 0:
            order[count] = k
            count += 1
    record = buffers.fairness[0]
    shuffle(order, count, record.seed, (at - record.boot) // NS_PER_US)
    # the datagrams, back to back
    address = text.ctypes.data
    for rank in range(count):
        k = order[rank]
        length = lengths[k]
        sent = _send(rows[k].descriptor, address + starts[k], length, SEND_FLAGS)
        rows[k].result = SENT
        if sent != length:
            error = carray(_errno_address(), (1,))[0] if sent < 0 else 0
            rows[k].result = DROPPED
            if error == CONNECTION_REFUSED:
                rows[k].result = REFUSED
            elif error == HOST_UNREACHABLE:
                rows[k].result = UNREACHABLE
        _clock_gettime(CLOCK_MONOTONIC, now.ctypes.data)
        rows[k].sent_at = now[0] * NS_PER_S + now[1]
    # the counters
    refusals = 0
    for rank in range(count):
        row = rows[order[rank]]
        row.grabbed_at, row.rank = at, rank
        if row.period_ns > 0:
            row.due_at = max(row.due_at, at) + row.period_ns
        row.frames += 1
        row.rank_sum += rank / (count - 1) if count > 1 else 0.5
        row.sent += row.result == SENT
        row.dropped += row.result != SENT
        refusals += row.result >= REFUSED
    if count > 0:
        note_frame(buffers.fairness, rows, order, count, at)
    return count, refusals


class DeliveryTable:
    """The rows of all sessions, and the memory for serving them."""

    def __init__(self, boot: Instant, seed: int | None = None) -> None:
        """seed: of the order of sending; None: the system draws it."""
        self._boot = boot
        self.fairness = FairnessRecord(boot, seed)
        self._rehearsed_fairness = np.zeros_like(self.fairness.table)
        self.replace(new_rows(0))

    def replace(self, rows: Table) -> None:
        """Go on with other rows: of ``new_rows``, or copies of rows so far."""
        count = len(rows)
        self.rows = rows
        self._due = np.zeros(count, dtype=np.uint8)
        self._buffers = SendBuffers(np.zeros(count, dtype=np.int64), self.fairness.table, np.zeros(2, dtype=np.int64))
        self._rehearsed_rows = rows.copy()
        self._rehearsal = SendBuffers(
            np.zeros(count, dtype=np.int64), self._rehearsed_fairness, np.zeros(2, dtype=np.int64)
        )

    def address(self, row: int, robot: int, descriptor: int, options: Options) -> None:
        """Set whose a row is, where its datagrams go and how often. robot: by ``types.fairness.robot_index``."""
        target = self.rows[row]
        target["robot"] = robot
        target["descriptor"], target["tick_ns"] = descriptor, NS_PER_TICK[options.time]
        target["period_ns"] = NS_PER_S // options.rate_hz if options.rate_hz else 0

    def due(self, at: Instant) -> Bytes:
        """1 for each row that is to get a view grabbed at an instant, else 0; valid until the next call."""
        mark_due(self.rows, at, self._boot, self._due)
        return self._due

    def send(self, at: Instant, batch: Batch) -> tuple[int, int]:
        """Send a frame and update the rows; returns how many rows had a datagram, and how many the network refused."""
        return send_all(self.rows, at, batch.text, batch.starts, batch.lengths, self._buffers)

    def rehearse(self, at: Instant, batch: Batch, descriptor: int) -> None:
        """Send a frame's datagrams to one socket; no row, counter or record changes. descriptor: of that socket."""
        np.copyto(self._rehearsed_rows, self.rows)
        self._rehearsed_rows["descriptor"] = descriptor
        for name in ("seed", "boot"):  # of the order of sending
            self._rehearsed_fairness[name] = self.fairness.table[name]
        send_all(self._rehearsed_rows, at, batch.text, batch.starts, batch.lengths, self._rehearsal)

    @property
    def order(self) -> NDArray[np.int64]:
        """Rows in the order of the last sending; only as many places are valid as rows had a datagram."""
        return self._buffers.order
