"""One rate keeper on an absolute grid: start + k * period, k = 0, 1, 2, ...

Relative sleeps drift, and a sleep that starts again at "now" leaves the grid. Here a period whose instant has passed
is skipped and counted; it is never made up for.
"""

import time
from collections.abc import Callable
from typing import Protocol

from vision_core.clock import NS_PER_S, Clock, Instant, ManualClock, seconds_between


class Keeper(Protocol):
    """Chooses the instant of the next image, and waits until then."""

    number: int
    skipped: int

    def choose(self) -> Instant: ...
    def sleep(self) -> Instant: ...
    def wait(self) -> Instant: ...


class RateKeeper:
    """Waits for the instants of a grid that begins at the first call, so that opening a source delays no image."""

    def __init__(self, rate_hz: float, clock: Clock, sleep: Callable[[float], None] = time.sleep) -> None:
        self.rate_hz = rate_hz
        self.number = -1
        """Number of the period that was chosen last; skipped periods count."""
        self.skipped = 0
        self._clock = clock
        self._sleep = sleep
        self._start: Instant | None = None

    def wait(self) -> Instant:
        """Sleep until the next instant of the grid that has not passed; returns it, always later than the last one."""
        self.choose()
        return self.sleep()

    def choose(self) -> Instant:
        """The next instant of the grid that has not passed, for work that must be done before it."""
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
        """Sleep until the chosen instant, not at all when it has passed, and return it."""
        deadline = self._instant(self.number)
        while (now := self._clock.now()) < deadline:
            self._sleep(seconds_between(now, deadline))
        return deadline

    def _instant(self, number: int) -> Instant:
        assert self._start is not None
        return Instant(self._start + round(number * NS_PER_S / self.rate_hz))


def rate_keeper(rate_hz: float, clock: Clock, *, paced: bool) -> RateKeeper:
    """A keeper in real time or, not paced, in virtual time: it starts now, and each sleep moves it without waiting."""
    if paced:
        return RateKeeper(rate_hz, clock)
    virtual = ManualClock(clock.now())
    return RateKeeper(rate_hz, virtual, virtual.advance)


class RequestedKeeper:
    """Follows the grid of another process, which requests one image after the other. Never waits.

    That process may restart with another grid: periods are counted by their instants.
    """

    skipped = 0
    """The requesting process counts skipped periods."""

    def __init__(self, rate_hz: float) -> None:
        self.rate_hz = rate_hz
        self.number = -1
        """Number of the period that was requested last; skipped periods count."""
        self._origin: Instant | None = None
        self._requested = Instant(0)

    def request(self, instant: Instant) -> None:
        """Set the instant of the next image, later than all before."""
        if self._origin is None:
            self._origin = instant
        self.number = round(seconds_between(self._origin, instant) * self.rate_hz)
        self._requested = instant

    def choose(self) -> Instant:
        """The instant that was requested."""
        return self._requested

    sleep = wait = choose
