"""The server's clock, as a client knows it: protocol version 2, ``(sync ...)``. Instants in, questions out.

Theory of operation. The client asks eight times within 160 ms, then once a second, and four times a second while the
bound is over half a millisecond. Of the answers of the last 64 s the likeliest line is taken, clamped to the bound that
all of them give (``clock_fit``). When a clock has stepped, everything before is forgotten and the client asks eight
times again. What is told to the program never steps by less than 50 ms: it glides to the new line, with no more than
500 ppm, so time never runs backwards; the bound counts from what is told, so it holds meanwhile as well.
"""

import math
from typing import NamedTuple

from vision_core.client.clock_fit import MAX_SKEW_PPM, PPM, Exchange, OffsetEstimate
from vision_core.clock import NS_PER_MS, NS_PER_S, Instant, after
from vision_core.protocol.messages import Sync, SyncReply

BURST = 8
"""Questions after a start of the server became known, or a clock has stepped."""
BURST_S, PERIOD_S, DOUBTFUL_S = 0.02, 1.0, 0.25
"""Between two questions: of a burst; afterwards; and while the bound is over GOOD_S."""
GOOD_S = 0.0005
SETTLING = 4
"""Answers until the clock is told: one alone may have been delayed."""
MAX_OUTSTANDING = 16
"""Questions whose answers are waited for."""
STEP_NS = 50 * NS_PER_MS
"""What is told glides over smaller differences, and steps over larger ones."""
GLIDE = (500 - MAX_SKEW_PPM) / PPM
"""How fast it glides beside the skew: 500 ppm together."""


class ServerTime(NamedTuple):
    """The server's clock at an instant."""

    time_s: float
    """In the time that ``View.time_s`` uses; nan while it is not known."""
    bound_s: float
    """The truth is at most so far away, whatever the network does; inf while it is not known."""


UNKNOWN = ServerTime(math.nan, math.inf)


class ClockSync:
    """Asks for the server's clock and says what it shows. Without sockets and without a clock."""

    def __init__(self) -> None:
        self._boot: str | None = None
        self._count = 0
        self._burst, self._due = BURST, Instant(0)
        self._forget(self._due)

    def begin(self, boot: str | None, now: Instant) -> None:
        """The server has told its boot. Another one is another clock: all is forgotten. None: it has no sync."""
        if boot != self._boot:
            self._boot = boot
            self._forget(now)

    @property
    def due(self) -> Instant | None:
        """When to ask next; None: never."""
        return None if self._boot is None else self._due

    def question(self, now: Instant) -> Sync | None:
        """The question to send at once, if one is due."""
        if self._boot is None or now < self._due:
            return None
        self._count += 1
        self._outstanding[self._count] = now
        if len(self._outstanding) > MAX_OUTSTANDING:
            del self._outstanding[min(self._outstanding)]
        self._burst = max(self._burst - 1, 0)
        self._due = after(now, self._period_s(now))
        return Sync(self._count, now)

    def answered(self, reply: SyncReply, arrived: Instant, now: Instant) -> bool:
        """An answer arrived. Returns whether it was taken: it answers an open question, and no time in it runs
        backwards."""
        exchange = Exchange(reply.t1_ns, reply.t2_ns, reply.t3_ns, arrived)
        is_forward = exchange.t4 >= exchange.t1 and exchange.t3 >= exchange.t2 and exchange.round_trip_ns >= 0
        if self._outstanding.get(reply.id) != reply.t1_ns or not is_forward:
            return False
        del self._outstanding[reply.id]
        self._take(exchange, now)
        return True

    def server_time(self, t: Instant) -> ServerTime:
        """The server's clock at an instant of the client's, a recent one; UNKNOWN before the first answers."""
        if self._estimate is None or not self._is_settled:
            return UNKNOWN
        offset, (least, most) = self._told_offset(self._estimate, t), self._estimate.bounds.at(t)
        return ServerTime((t + offset) / NS_PER_S, max(most - offset, offset - least) / NS_PER_S)

    def _forget(self, now: Instant) -> None:
        self._outstanding: dict[int, Instant] = {}
        self._estimate: OffsetEstimate | None = None
        self._burst, self._due = BURST, now
        self._answers, self._is_settled = 0, False
        self._glide_ns, self._glides_from = 0.0, now

    def _take(self, exchange: Exchange, now: Instant) -> None:
        told = self._told_offset(self._estimate, now) if self._estimate is not None and self._is_settled else None
        if self._estimate is None:
            self._estimate = OffsetEstimate(exchange)
        elif self._estimate.bounds.excludes(exchange):
            self._estimate = OffsetEstimate(exchange)
            self._burst, self._due = BURST, now
        else:
            self._estimate.take(exchange)
        self._answers += 1
        self._is_settled |= not self._burst and self._answers >= SETTLING
        difference = 0.0 if told is None else told - self._estimate.offset_at(now)
        self._glide_ns, self._glides_from = difference if abs(difference) <= STEP_NS else 0.0, now

    def _told_offset(self, estimate: OffsetEstimate, t: Instant) -> float:
        """Offset that the program is told [ns]: it glides from what it was before the last answer."""
        glided = max(t - self._glides_from, 0) * GLIDE
        left = math.copysign(max(abs(self._glide_ns) - glided, 0.0), self._glide_ns)
        return estimate.offset_at(t) + left

    def _period_s(self, now: Instant) -> float:
        if self._burst:
            return BURST_S
        return PERIOD_S if self.server_time(now).bound_s <= GOOD_S else DOUBTFUL_S
