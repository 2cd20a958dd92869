"""One frame's datagrams and their sending: a compiled loop over the C library's ``send``.

Every session has a connected socket of its own, so each datagram takes one system call; a compiled loop saves what
Python would add to each. Nothing is allocated and no Python object is touched between the first datagram and the last.

The table has one row per session. A row is the only place that says what its session was sent, when it is due again
and how it has been served so far.
"""

import errno
import random
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from vision_core.clock import NS_PER_S, NS_PER_US, Instant
from vision_core.geometry import Bytes
from vision_core.native.kernels import carray, external, kernel
from vision_core.protocol.messages import MAX_LAG_S, REPORT_PERIOD_S, LagReport
from vision_core.protocol.options import Options
from vision_core.types.tables import Table

NOT_SENT, SENT, DROPPED, REFUSED, UNREACHABLE = 0, 1, 2, 3, 4
"""Result of a row in the last frame."""
NEVER = -1
UNKNOWN = -1
NS_PER_TICK = {"ms": 1_000_000, "us": 1_000}
"""The unit of a printed Time [ns]."""
CLOCK_MONOTONIC = 1
MSG_DONTWAIT = 0x40
MSG_NOSIGNAL = 0x4000
SEND_FLAGS = MSG_DONTWAIT | MSG_NOSIGNAL
CONNECTION_REFUSED = errno.ECONNREFUSED
HOST_UNREACHABLE, NET_UNREACHABLE = errno.EHOSTUNREACH, errno.ENETUNREACH

DELIVERY = np.dtype(
    [
        # where datagrams go, and how often
        ("descriptor", np.int64),  # of the session's socket
        ("tick_ns", np.int64),  # unit of its printed Time
        ("period_ns", np.int64),  # at least so long between two views; 0: every frame
        # what it was sent
        ("grabbed_at", np.int64),  # grab of the last view that was sent, or NEVER
        ("sent_at", np.int64),  # when that view was sent
        ("due_at", np.int64),  # with a period: the next view's place on its grid
        # counters
        ("sent", np.int64),
        ("dropped", np.int64),
        ("frames", np.int64),  # sent + dropped
        ("rank_sum", np.float64),  # sum of its places in the order of sending, each 0 first .. 1 last
        # the last frame
        ("result", np.int64),
        ("rank", np.int64),  # place in the order of sending
        # the client's last report
        ("reported_at", np.int64),  # or NEVER
        ("network_ns", np.int64),  # lag of the network, one way, or UNKNOWN
        ("client_ns", np.int64),  # lag of the client, or UNKNOWN
    ]
)
"""How one session is served. Instants are [ns of CLOCK_MONOTONIC]."""

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
    rng_state: NDArray[np.uint64]
    """State of the random generator, shape (1,)."""
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
    shuffle(order, count, buffers.rng_state)
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
            elif error in (HOST_UNREACHABLE, NET_UNREACHABLE):
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
    return count, refusals


@kernel
def shuffle(order: NDArray[np.int64], count: int, rng_state: NDArray[np.uint64]) -> None:
    """Shuffle the first ``count`` rows: Fisher-Yates, with random numbers of xorshift64*."""
    state = rng_state[0]
    for last in range(count - 1, 0, -1):
        state ^= state >> np.uint64(12)
        state ^= state << np.uint64(25)
        state ^= state >> np.uint64(27)
        drawn = (state * np.uint64(0x2545F4914F6CDD1D)) >> np.uint64(32)
        other = np.int64(drawn * np.uint64(last + 1) >> np.uint64(32))
        order[last], order[other] = order[other], order[last]
    rng_state[0] = state


def mean_rank(row: Table) -> float:
    """Mean place of a row in the order of sending, 0 first .. 1 last; 0.5 is fair."""
    return float(row["rank_sum"] / row["frames"]) if row["frames"] else 0.5


def note_report(row: Table, report: LagReport, boot: Instant, now: Instant) -> None:
    """Take the lags from a client's report on the last view that was sent.

    A report on another view, with an impossible value, or soon after the last report changes nothing.
    """
    tick_ns = int(row["tick_ns"])
    printed_us = (int(row["grabbed_at"]) - boot) // tick_ns * tick_ns // NS_PER_US
    if row["grabbed_at"] == NEVER or report.time_us != printed_us:
        return
    if not all(0.0 <= lag_s <= MAX_LAG_S for lag_s in (report.hold_s, report.client_s or 0.0)):
        return
    if row["reported_at"] != NEVER and now - row["reported_at"] < REPORT_PERIOD_S * NS_PER_S:
        return
    round_trip_ns = now - int(row["sent_at"]) - round(report.hold_s * NS_PER_S)
    row["network_ns"] = max(round_trip_ns, 0) // 2
    row["client_ns"] = UNKNOWN if report.client_s is None else round(report.client_s * NS_PER_S)
    row["reported_at"] = now


def new_rows(count: int) -> Table:
    """Rows of sessions that were sent nothing yet, shape (count,)."""
    rows = np.zeros(count, dtype=DELIVERY)
    for name in ("grabbed_at", "sent_at", "due_at", "reported_at", "network_ns", "client_ns"):
        rows[name] = NEVER
    return rows


class DeliveryTable:
    """The rows of all sessions, and the memory for serving them."""

    def __init__(self, boot: Instant, seed: int | None = None) -> None:
        """seed: of the order of sending; None: the system draws it."""
        self._boot = boot
        bits = random.Random(seed).getrandbits(64)  # noqa: S311 (for fairness, not for secrecy)
        self._rng_state = np.array([bits | 1], dtype=np.uint64)
        self.replace(new_rows(0))

    def replace(self, rows: Table) -> None:
        """Go on with other rows: of ``new_rows``, or copies of rows so far."""
        count = len(rows)
        self.rows = rows
        self._due = np.zeros(count, dtype=np.uint8)
        self._buffers = SendBuffers(np.zeros(count, dtype=np.int64), self._rng_state, np.zeros(2, dtype=np.int64))

    def address(self, row: int, descriptor: int, options: Options) -> None:
        """Set where a row's datagrams go and how often."""
        target = self.rows[row]
        target["descriptor"], target["tick_ns"] = descriptor, NS_PER_TICK[options.time]
        target["period_ns"] = NS_PER_S // options.rate_hz if options.rate_hz else 0

    def due(self, at: Instant) -> Bytes:
        """1 for each row that is to get a view grabbed at an instant, else 0; valid until the next call."""
        mark_due(self.rows, at, self._boot, self._due)
        return self._due

    def send(self, at: Instant, batch: Batch) -> tuple[int, int]:
        """Send a frame and update the rows; returns how many rows had a datagram, and how many the network refused."""
        return send_all(self.rows, at, batch.text, batch.starts, batch.lengths, self._buffers)

    @property
    def order(self) -> NDArray[np.int64]:
        """Rows in the order of the last sending; only as many places are valid as rows had a datagram."""
        return self._buffers.order
