"""What only a client can measure: when a view arrived, and when the program had used it.

The server takes half the round trip of a view and the report on it for the network's lag, as receivers of RTP
report (RFC 3550, 6.4.1): no clocks are compared. Linux stamps arrivals, so that a view that waits for a busy
program does not count as one that travels; elsewhere an arrival is when the program reads it.
"""

import contextlib
import socket
import statistics
import struct
import sys
import time
from collections import deque

from vision_core.clock import NS_PER_S, Instant, seconds_between
from vision_core.protocol.error_codes import ErrorName
from vision_core.protocol.messages import MAX_LAG_S, Lag

REPORT_S = 1.0
"""Between two reports."""
MAX_USES = 1000
"""Kept for a median, if no report is due for long."""
TO_REPORTS = frozenset({ErrorName.UNKNOWN_COMMAND, ErrorName.NOT_CONNECTED})
"""Errors that no init gets: a report came to a server that is older, or that was restarted."""
SO_TIMESTAMPNS = getattr(socket, "SO_TIMESTAMPNS", 35)
"""Linux's number; the socket module learned the name late."""
TIMESPEC = struct.Struct("@ll")

SockAddress = tuple[str, int] | tuple[str, int, int, int] | tuple[int, bytes]


class LagReports:
    """Notes when views arrive and are used, and says when a report is due. No sockets, no clock of its own."""

    def __init__(self, now: Instant) -> None:
        self._any_sent = False
        self._wanted = True
        self._reported = now
        self._arrived: Instant | None = None
        self._uses_s: deque[float] = deque(maxlen=MAX_USES)

    def view_used(self, now: Instant) -> None:
        """The program asks for the next view: it is done with the last one, if it has not said so before."""
        if self._arrived is not None:
            self._uses_s.append(seconds_between(self._arrived, now))
        self._arrived = None

    def view_arrived(self, time_us: int, arrived: Instant, now: Instant) -> Lag | None:
        """A view is handed to the program; the report to send at once, if one is due."""
        self._arrived = arrived
        hold_s = seconds_between(arrived, now)
        if not self._wanted or seconds_between(self._reported, now) < REPORT_S or not 0.0 <= hold_s <= MAX_LAG_S:
            return None
        client_s = statistics.median(self._uses_s) if self._uses_s else None
        self._uses_s.clear()
        self._reported, self._any_sent = now, True
        known = client_s is not None and 0.0 <= client_s <= MAX_LAG_S
        return Lag(time_us, hold_s, client_s if known else None)

    def explains(self, error: str) -> bool:
        """Is an error of the server the answer to a report? One that knows no reports gets no more."""
        if error not in TO_REPORTS or not self._any_sent:
            return False
        self._wanted = self._wanted and error != ErrorName.UNKNOWN_COMMAND
        return True


def stamp_arrivals(datagrams: socket.socket) -> None:
    """Ask the system to note when each datagram arrives, where it can."""
    if sys.platform == "linux":
        with contextlib.suppress(OSError):
            datagrams.setsockopt(socket.SOL_SOCKET, SO_TIMESTAMPNS, 1)


def receive_stamped(datagrams: socket.socket, most: int) -> tuple[bytes, SockAddress, int]:
    """The next datagram, its sender, and how long ago it arrived [ns], 0 when that is not known. Raises OSError."""
    if sys.platform != "linux":
        return *datagrams.recvfrom(most), 0
    data, ancillary, _, source = datagrams.recvmsg(most, socket.CMSG_SPACE(TIMESPEC.size))
    for level, kind, content in ancillary:
        if (level, kind, len(content)) == (socket.SOL_SOCKET, SO_TIMESTAMPNS, TIMESPEC.size):
            seconds, ns = TIMESPEC.unpack(content)
            age_ns = time.time_ns() - (seconds * NS_PER_S + ns)
            return data, source, age_ns if 0 <= age_ns <= MAX_LAG_S * NS_PER_S else 0  # the time of day may step
    return data, source, 0
