"""One frame's datagrams and their sending: a compiled loop over the C library's ``send``.

Every session has a connected socket of its own, so one system call per datagram it is; what a loop in Python adds to
each is saved here. Nothing is allocated and no Python object touched between the first datagram and the last.
"""

import errno
import random
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from vision_core.clock import NS_PER_S, Instant
from vision_core.geometry import Bytes
from vision_core.native.kernels import carray, external, kernel
from vision_core.types.tables import Table

NOT_SENT, SENT, DROPPED, REFUSED = 0, 1, 2, 3
"""What became of a line's datagram."""
NEVER = -1
CLOCK_MONOTONIC = 1
MSG_DONTWAIT = 0x40
MSG_NOSIGNAL = 0x4000
NOW_OR_NEVER = MSG_DONTWAIT | MSG_NOSIGNAL
CONNECTION_REFUSED = errno.ECONNREFUSED

LINE = np.dtype(
    [
        ("descriptor", np.int64), ("tick_ns", np.int64), ("period_ns", np.int64),
        ("served", np.int64), ("due", np.int64),
        ("sent", np.int64), ("dropped", np.int64), ("frames", np.int64), ("rank_sum", np.float64),
        ("outcome", np.int64), ("rank", np.int64), ("sent_at", np.int64),
    ]
)  # fmt: skip
"""Where one session's datagrams go: its socket; unit of its printed Time and least period (0: none); grab of the last
view that was sent (NEVER) and its next place on the rate's grid; what it got so far; how the last frame went, with the
place in the order and the instant of sending."""

_send = external("send", "intp(int32, uintp, uintp, int32)")
_errno_address = external("__errno_location", "CPointer(int32)()")
_clock_gettime = external("clock_gettime", "int32(int32, uintp)")


@dataclass(frozen=True, slots=True)
class Batch:
    """A frame's datagrams in one block of memory, one per line; 0 long: there is none."""

    text: Bytes
    starts: NDArray[np.int64]
    lengths: NDArray[np.int64]

    def datagram(self, line: int) -> memoryview:
        """What a line gets."""
        start = int(self.starts[line])
        return self.text[start : start + int(self.lengths[line])].data

    @staticmethod
    def of(datagrams: Sequence[bytes]) -> "Batch":
        """A batch in memory of its own."""
        lengths = np.array([len(data) for data in datagrams], dtype=np.int64)
        text = np.frombuffer(bytearray(b"".join(datagrams)) or bytearray(1), dtype=np.uint8)
        return Batch(text, np.cumsum(lengths) - lengths, lengths)


class _Memory(NamedTuple):
    """What the loop works in."""

    order: NDArray[np.int64]
    luck: NDArray[np.uint64]
    """State of the random order, shape (1,)."""
    now: NDArray[np.int64]
    """A struct timespec."""


@kernel
def mark_due(lines: Table, at: int, boot: int, due: Bytes) -> int:
    """Mark the lines that want a view grabbed at an instant, as ``Session.wants`` has it; returns how many do."""
    count = 0
    for k in range(len(lines)):
        line = lines[k]
        grows = line.served == NEVER or (at - boot) // line.tick_ns > (line.served - boot) // line.tick_ns
        due[k] = grows and (line.period_ns == 0 or at >= line.due - line.period_ns // 2)
        count += due[k]
    return count


@kernel
def send_all(
    lines: Table, at: int, text: Bytes, starts: NDArray[np.int64], lengths: NDArray[np.int64], memory: _Memory
) -> tuple[int, int]:
    """Send each line its datagram, in an order drawn anew; returns how many there were and how many were refused."""
    order, now = memory.order, memory.now
    count = 0
    for k in range(len(lines)):
        lines[k].outcome = NOT_SENT
        if lengths[k] > 0:
            order[count] = k
            count += 1
    _shuffle(order, count, memory.luck)
    address = text.ctypes.data
    for rank in range(count):  # nothing else between two sends
        k = order[rank]
        length = lengths[k]
        sent = _send(lines[k].descriptor, address + starts[k], length, NOW_OR_NEVER)
        lines[k].outcome = SENT
        if sent != length:
            refused = sent < 0 and carray(_errno_address(), (1,))[0] == CONNECTION_REFUSED
            lines[k].outcome = REFUSED if refused else DROPPED
        _clock_gettime(CLOCK_MONOTONIC, now.ctypes.data)
        lines[k].sent_at = now[0] * NS_PER_S + now[1]
    refusals = 0
    for rank in range(count):
        line = lines[order[rank]]
        line.served, line.rank = at, rank
        if line.period_ns > 0:
            line.due = max(line.due, at) + line.period_ns
        line.frames += 1
        line.rank_sum += rank / (count - 1) if count > 1 else 0.5
        line.sent += line.outcome == SENT
        line.dropped += line.outcome != SENT
        refusals += line.outcome == REFUSED
    return count, refusals


@kernel
def _shuffle(order: NDArray[np.int64], count: int, luck: NDArray[np.uint64]) -> None:
    """Every order as likely as any other (Fisher-Yates), drawn with xorshift64*."""
    state = luck[0]
    for last in range(count - 1, 0, -1):
        state ^= state >> np.uint64(12)
        state ^= state << np.uint64(25)
        state ^= state >> np.uint64(27)
        drawn = (state * np.uint64(0x2545F4914F6CDD1D)) >> np.uint64(32)
        other = np.int64(drawn * np.uint64(last + 1) >> np.uint64(32))
        order[last], order[other] = order[other], order[last]
    luck[0] = state


class Lines:
    """The lines of all sessions, and the memory to serve them from."""

    def __init__(self, boot: Instant, order: random.Random) -> None:
        self._boot = boot
        self._luck = np.array([order.getrandbits(64) | 1], dtype=np.uint64)
        self.rows: Table = np.zeros(0, dtype=LINE)
        self.resize(0)

    def resize(self, count: int) -> Table:
        """New lines, all zero; returns them."""
        self.rows = np.zeros(count, dtype=LINE)
        self._due = np.zeros(count, dtype=np.uint8)
        self._memory = _Memory(np.zeros(count, dtype=np.int64), self._luck, np.zeros(2, dtype=np.int64))
        return self.rows

    def due(self, at: Instant) -> Bytes:
        """1 for each line that wants a view grabbed at an instant; good until the next call."""
        mark_due(self.rows, at, self._boot, self._due)
        return self._due

    def send(self, at: Instant, batch: Batch) -> tuple[int, int]:
        """Send a frame; how it went stands in ``rows``. Returns how many were served, and how many refused."""
        return send_all(self.rows, at, batch.text, batch.starts, batch.lengths, self._memory)

    @property
    def order(self) -> NDArray[np.int64]:
        """Lines in the order of the last sending, those that were served first."""
        return self._memory.order
