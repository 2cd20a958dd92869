"""One rate keeper on an absolute grid: start + k * period, k = 0, 1, 2, ...

A relative sleep drifts, and one that starts again at "now" forgets the grid. Here period k is over when
its instant has passed: it is left out and counted, and nobody hurries after it.
"""

import time
from collections.abc import Callable
from typing import Protocol

from vision_core.clock import NS_PER_S, Clock, Instant, ManualClock, seconds_between


class Keeper(Protocol):
    """Says for when the next image is, and waits until then."""

    number: int
    skipped: int

    def choose(self) -> Instant: ...
    def sleep(self) -> Instant: ...
    def wait(self) -> Instant: ...


class RateKeeper:
    """Waits for the instants of a grid that begins when it is first asked: opening a source is no late image."""

    def __init__(self, rate_hz: float, clock: Clock, sleep: Callable[[float], None] = time.sleep) -> None:
        self.rate_hz = rate_hz
        self.number = -1
        """Of the period that was chosen last, the skipped ones counted."""
        self.skipped = 0
        self._clock = clock
        self._sleep = sleep
        self._start: Instant | None = None

    def wait(self) -> Instant:
        """Sleep until the next instant of the grid that is not over, and return it: always later than the last."""
        self.choose()
        return self.sleep()

    def choose(self) -> Instant:
        """The next instant of the grid that is not over, for work that must be done before it."""
        now = self._clock.now()
        if self._start is None:
            self._start = now
        due = self.number + 1
        number = max(due, int(seconds_between(self._start, now) * self.rate_hz))
        while self._instant(number) < now:
            number += 1
        self.skipped += number - due
        self.number = number
        return self._instant(number)

    def sleep(self) -> Instant:
        """Sleep until the chosen instant, not at all when it is over, and return it."""
        deadline = self._instant(self.number)
        while (now := self._clock.now()) < deadline:
            self._sleep(seconds_between(now, deadline))
        return deadline

    def _instant(self, number: int) -> Instant:
        assert self._start is not None
        return Instant(self._start + round(number * NS_PER_S / self.rate_hz))


def rate_keeper(rate_hz: float, clock: Clock, *, paced: bool) -> RateKeeper:
    """A keeper in real time or, not paced, in virtual time that starts now and moves as fast as it is asked."""
    if paced:
        return RateKeeper(rate_hz, clock)
    virtual = ManualClock(clock.now())
    return RateKeeper(rate_hz, virtual, virtual.advance)


class OrderedKeeper:
    """The grid of somebody else, who orders one image after the other and says for when. Never waits.

    Whoever orders may begin anew with a grid of its own: periods are counted by their instants.
    """

    skipped = 0
    """It is the orderer who knows."""

    def __init__(self, rate_hz: float) -> None:
        self.rate_hz = rate_hz
        self.number = -1
        """Of the period that was ordered last, the skipped ones counted."""
        self._origin: Instant | None = None
        self._ordered = Instant(0)

    def order(self, instant: Instant) -> None:
        """The next image is for an instant, later than all before."""
        if self._origin is None:
            self._origin = instant
        self.number = round(seconds_between(self._origin, instant) * self.rate_hz)
        self._ordered = instant

    def choose(self) -> Instant:
        """The instant that was ordered."""
        return self._ordered

    sleep = wait = choose
