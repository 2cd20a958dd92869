"""How often something happens, over the last few seconds, from a count that somebody reads now and then."""

from collections import deque

from vision_core.clock import NS_PER_S, Instant, seconds_between

OVER_S = 5.0


class RunningRate:
    """The rate of one count."""

    def __init__(self) -> None:
        self._read: deque[tuple[Instant, int]] = deque()

    def of(self, now: Instant, count: int) -> float:
        """Take a reading; how much the count grew over the last seconds [1/s], 0 at the first.

        A smaller count than before is one that began anew.
        """
        if self._read and count < self._read[-1][1]:
            self.forget()
        while len(self._read) > 1 and now - self._read[1][0] >= OVER_S * NS_PER_S:
            self._read.popleft()
        self._read.append((now, count))
        then, before = self._read[0]
        return (count - before) / seconds_between(then, now) if now > then else 0.0

    def forget(self) -> None:
        """What was counted before is over."""
        self._read.clear()
