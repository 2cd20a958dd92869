"""What exchanges of ``(sync ...)`` tell of the server's clock: a bound that always holds, and the likeliest line.

The offset is the server's clock minus the client's [ns]; the skew is its change per time. A question arrives after it
was sent, and an answer after it was written: the offset is at most T2 - T1 at T1, and at least T3 - T4 at T4, whatever
the network does. From there on the two clocks drift apart by MAX_SKEW_PPM at most, so each exchange bounds the offset
at all times; where the bounds of two exchanges exclude each other, a clock has stepped.

How long the question and the answer took separately, no exchange tells: the middle of the bound is off by half of their
difference. What a round trip takes beyond the shortest one is likely to be on one side alone: it makes an exchange
doubtful.
"""

from collections import deque
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from vision_core.clock import NS_PER_S, NS_PER_US

MAX_SKEW_PPM = 200
"""Two quartz clocks never drift apart faster, also while their system disciplines them."""
PPM = 1_000_000
LIKELY_SKEW = 50e-6
"""Of two computers, as a standard deviation: what the first exchanges say of the skew is mostly noise."""
WINDOW_NS = 64 * NS_PER_S
"""Older exchanges say nothing of the line: the skew changes with the temperature."""
NOISE_NS = 20.0 * NS_PER_US
"""Standard deviation of the middle of an exchange with the shortest round trip."""


class Exchange(NamedTuple):
    """A question and its answer [ns]."""

    t1: int
    """Question sent, client's clock."""
    t2: int
    """Question received, server's clock."""
    t3: int
    """Answer sent, server's clock."""
    t4: int
    """Answer received, client's clock."""

    @property
    def round_trip_ns(self) -> int:
        """Time on the network, both ways; the server's time is not counted."""
        return self.t4 - self.t1 - (self.t3 - self.t2)


class Limit(NamedTuple):
    """The offset is at most, or at least, so much at one time of the client's clock [ns]."""

    at: int
    offset: int

    def drift(self, t: int) -> int:
        """By how much the offset at another time may differ [ns], rounded up."""
        return -(-abs(t - self.at) * MAX_SKEW_PPM // PPM)


class OffsetBounds:
    """What the offset can be at any time, given all exchanges."""

    def __init__(self, first: Exchange) -> None:
        self._most = Limit(first.t1, first.t2 - first.t1)
        self._least = Limit(first.t4, first.t3 - first.t4)

    def at(self, t: int) -> tuple[int, int]:
        """The least and the largest offset [ns] at a time of the client's clock [ns]."""
        return self._least.offset - self._least.drift(t), self._most.offset + self._most.drift(t)

    def excludes(self, exchange: Exchange) -> bool:
        """Whether an exchange cannot be true together with the earlier ones: a clock has stepped."""
        t1, t2, t3, t4 = exchange
        return t2 - t1 < self.at(t1)[0] or t3 - t4 > self.at(t4)[1]

    def narrow(self, exchange: Exchange) -> None:
        """Take one more exchange into account.

        A limit is kept at the latest time that one was found at: earlier limits reach it widened, so one is enough.
        """
        t1, t2, t3, t4 = exchange
        most, least = Limit(t1, t2 - t1), Limit(t4, t3 - t4)
        t = max(self._most.at, t1)
        self._most = Limit(t, min(one.offset + one.drift(t) for one in (self._most, most)))
        t = max(self._least.at, t4)
        self._least = Limit(t, max(one.offset - one.drift(t) for one in (self._least, least)))


class OffsetLine(NamedTuple):
    """An offset that changes evenly."""

    at: int
    offset: float
    """At that time of the client's clock [ns]."""
    skew: float
    """Change of the offset per time of the client."""

    def offset_at(self, t: int) -> float:
        """Offset [ns] at a time of the client's clock [ns]."""
        return self.offset + self.skew * (t - self.at)


def likeliest_line(exchanges: Sequence[Exchange]) -> OffsetLine:
    """The weighted least-squares line through the middles of the bounds of exchanges, at least one.

    An exchange weighs the less, the longer its round trip is than the shortest one; the skew is drawn towards zero as
    far as its spread between computers says (LIKELY_SKEW).
    """
    times = np.array(exchanges, dtype=np.int64)  # shape (n, 4)
    t1, t2, t3, t4 = (times - times[-1, [0, 1, 1, 0]]).T.astype(np.float64)  # small, so that a float holds every ns
    round_trips = t4 - t1 - (t3 - t2)
    excess = round_trips - round_trips.min()
    doubt = excess + excess.mean() / len(excess)  # the shortest of a few is not the shortest that there is
    weights = 1.0 / (NOISE_NS**2 + (doubt / 2.0) ** 2)
    middles, offsets = (t1 + t4) / 2.0, (t2 - t1 + t3 - t4) / 2.0
    middle, offset = np.average(middles, weights=weights), np.average(offsets, weights=weights)
    from_middle = middles - middle
    spread = weights @ from_middle**2 + 1.0 / LIKELY_SKEW**2
    most = MAX_SKEW_PPM / PPM
    skew = float(np.clip(weights @ (from_middle * (offsets - offset)) / spread, -most, most))
    newest = exchanges[-1]
    return OffsetLine(newest.t1 + round(middle), newest.t2 - newest.t1 + float(offset), skew)


class OffsetEstimate:
    """The offset as exchanges tell it: the likeliest line, clamped to the bounds."""

    def __init__(self, first: Exchange) -> None:
        self.bounds = OffsetBounds(first)
        self._exchanges = deque([first])
        self._line = likeliest_line(self._exchanges)

    def take(self, exchange: Exchange) -> None:
        """Take one more exchange into account, which the bounds do not exclude."""
        self.bounds.narrow(exchange)
        self._exchanges.append(exchange)
        while self._exchanges[0].t4 < exchange.t4 - WINDOW_NS:
            self._exchanges.popleft()
        self._line = likeliest_line(self._exchanges)

    def offset_at(self, t: int) -> float:
        """Offset [ns] at a time of the client's clock [ns]; changes by MAX_SKEW_PPM at most."""
        least, most = self.bounds.at(t)
        return min(max(self._line.offset_at(t), least), most)
