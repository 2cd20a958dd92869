"""The rate of events over the last few seconds, from a counter that is read now and then."""

from collections import deque

from vision_core.clock import NS_PER_S, Instant, seconds_between

WINDOW_S = 5.0
"""Length of time over which the rate is taken."""


class RunningRate:
    """The rate of one counter."""

    def __init__(self) -> None:
        self._read: deque[tuple[Instant, int]] = deque()

    def of(self, now: Instant, count: int) -> float:
        """Add a reading of the counter; its mean rate over the last WINDOW_S [1/s], 0 at the first reading.

        A count smaller than the last one belongs to a counter that was restarted: earlier readings are dropped.
        """
        if self._read and count < self._read[-1][1]:
            self.forget()
        while len(self._read) > 1 and now - self._read[1][0] >= WINDOW_S * NS_PER_S:
            self._read.popleft()
        self._read.append((now, count))
        then, before = self._read[0]
        return (count - before) / seconds_between(then, now) if now > then else 0.0

    def forget(self) -> None:
        """Drop all readings."""
        self._read.clear()
