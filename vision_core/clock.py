"""Time is a type: instants are integers of CLOCK_MONOTONIC nanoseconds, durations are seconds.

The clock is an argument, so that a test or a recording brings its own. Wall-clock time never enters the core:
it steps, CLOCK_MONOTONIC does not. All processes of one machine share it.
"""

import time
from dataclasses import dataclass
from typing import NewType, Protocol

Instant = NewType("Instant", int)
"""CLOCK_MONOTONIC [ns]."""

NS_PER_S = 1_000_000_000
NS_PER_MS = 1_000_000
NS_PER_US = 1_000
US_PER_S = 1_000_000
US_PER_MS = 1_000
MS_PER_S = 1_000


class Clock(Protocol):
    """Has the present instant."""

    def now(self) -> Instant: ...


class MonotonicClock:
    """The machine's CLOCK_MONOTONIC."""

    def now(self) -> Instant:
        return Instant(time.monotonic_ns())


@dataclass(slots=True)
class ManualClock:
    """A clock that stands still until it is moved, for tests and replays."""

    instant: Instant = Instant(0)

    def now(self) -> Instant:
        return self.instant

    def advance(self, duration_s: float) -> None:
        """Move forward by a duration [s]."""
        self.instant = after(self.instant, duration_s)


def seconds_between(start: Instant, end: Instant) -> float:
    """Duration from start to end [s], negative when end comes first."""
    return (end - start) / NS_PER_S


def after(start: Instant, duration_s: float) -> Instant:
    """The instant a duration [s] after start."""
    return Instant(start + round(duration_s * NS_PER_S))
