"""The lag of a view as the paper's figure 8 splits it, and the client's share: from its arrival until it was used.

The server takes half of the round trip of a view and the report on it for the network's lag, as receivers of RTP report
it (RFC 3550, 6.4.1): no clocks are compared. Linux stamps arrivals, so the time that a view waits for a busy program is
not counted as the network's; on other systems a view arrives when the program reads it.
"""

import math
import socket
import statistics
import sys
from collections import deque
from dataclasses import dataclass, replace

from vision_core.arrival_stamps import STAMP_SPACE, age_ns
from vision_core.client.clock_sync import ServerTime
from vision_core.clock import Instant, seconds_between
from vision_core.protocol.error_codes import ErrorCode
from vision_core.protocol.messages import MAX_LAG_S, LagReport

REPORT_S = 1.0
"""Between two reports."""
MAX_USES = 1000
"""Kept for the median of one report."""
TO_REPORTS = frozenset({ErrorCode.UNKNOWN_COMMAND, ErrorCode.NOT_CONNECTED})
"""Errors that a report may get and an init does not: the server is older, or was restarted."""
SockAddress = tuple[str, int] | tuple[str, int, int, int] | tuple[int, bytes]


@dataclass(frozen=True, slots=True)
class Lag:
    """The parts of one view's lag [s]."""

    server_s: float
    """A: from the grab of the image until the view was written."""
    network_s: float
    """B: until it arrived. By the server's clock, as far as the client knows it."""
    client_s: float
    """C: until the program was given the view; in ``Connection.lag`` until it asked for the next one."""
    bound_s: float
    """B is wrong by at most so much; A and C are exact."""

    @property
    def total_s(self) -> float:
        """From the grab of the image until the program had, or has used, the view."""
        return self.server_s + self.network_s + self.client_s


def lag_of(time_s: float, server_age_s: float | None, arrived: ServerTime, client_s: float) -> Lag | None:
    """The lag of a view; None unless its extra ``age`` was asked for and the server's clock is known.

    time_s: of the view; arrived: the server's clock when it arrived; client_s: C.
    """
    if server_age_s is None or not math.isfinite(arrived.bound_s):
        return None
    return Lag(server_age_s, arrived.time_s - time_s - server_age_s, client_s, arrived.bound_s)


class LagReports:
    """Notes when views arrive and are used, and makes the reports that are due. Without sockets and without a clock."""

    def __init__(self, now: Instant) -> None:
        self._any_report_sent = False
        self._server_knows_reports = True
        self._reported = now
        self._arrived: Instant | None = None
        self._uses_s: deque[float] = deque(maxlen=MAX_USES)
        self._given: Lag | None = None
        self.last: Lag | None = None
        """Of the last view that the program has used."""

    def view_used(self, now: Instant) -> None:
        """The program asks for the next view, so it has used the last one."""
        if self._arrived is not None:
            self._uses_s.append(seconds_between(self._arrived, now))
            self.last = self._given and replace(self._given, client_s=self._uses_s[-1])
        self._arrived = None

    def view_given(self, lag: Lag | None) -> None:
        """The lag of the view that the program is given, as far as it is known."""
        self._given = lag

    def view_arrived(self, time_us: int, arrived: Instant, now: Instant) -> LagReport | None:
        """A view is given to the program; returns the report to send at once, if one is due."""
        self._arrived = arrived
        hold_s = seconds_between(arrived, now)
        is_due = self._server_knows_reports and seconds_between(self._reported, now) >= REPORT_S
        if not is_due or not 0.0 <= hold_s <= MAX_LAG_S:
            return None
        client_s = statistics.median(self._uses_s) if self._uses_s else None
        self._uses_s.clear()
        self._reported, self._any_report_sent = now, True
        known = client_s is not None and 0.0 <= client_s <= MAX_LAG_S
        return LagReport(time_us, hold_s, client_s if known else None)

    def explains(self, error: str) -> bool:
        """Is an error the answer to a report? A server that does not know reports is sent no more."""
        if error not in TO_REPORTS or not self._any_report_sent:
            return False
        self._server_knows_reports = self._server_knows_reports and error != ErrorCode.UNKNOWN_COMMAND
        return True


def receive_stamped(datagrams: socket.socket, most: int) -> tuple[bytes, SockAddress, int]:
    """The next datagram, its sender, and how long ago it arrived [ns], 0 if not known. Raises OSError."""
    if sys.platform != "linux":
        return *datagrams.recvfrom(most), 0
    data, ancillary, _, source = datagrams.recvmsg(most, STAMP_SPACE)
    return data, source, age_ns(ancillary)
