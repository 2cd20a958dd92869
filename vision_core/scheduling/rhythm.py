"""When a task will be released next, as far as its last releases tell. No clock, no waiting."""

from collections import deque

from vision_core.clock import Instant

KEPT = 8
"""Intervals."""
LEAST = 4
"""Intervals until there is a rhythm."""


class Rhythm:
    """The period and phase of a task's releases."""

    def __init__(self) -> None:
        self._last: Instant | None = None
        self._intervals_ns: deque[int] = deque(maxlen=KEPT)
        self.period_ns: int | None = None
        """The median of the last intervals; None while there are few, or one is off by more than half of it."""

    @property
    def due(self) -> Instant | None:
        """When the next release should come; None without a rhythm."""
        return None if self._last is None or self.period_ns is None else Instant(self._last + self.period_ns)

    def note(self, at: Instant) -> None:
        """The task was released at an instant."""
        if self._last is not None:
            self._intervals_ns.append(at - self._last)
        self._last = at
        self.period_ns = self._regular_ns()

    def _regular_ns(self) -> int | None:
        if len(self._intervals_ns) < LEAST:
            return None
        ordered = sorted(self._intervals_ns)
        period_ns = ordered[len(ordered) // 2]
        return period_ns if max(ordered[-1] - period_ns, period_ns - ordered[0]) <= period_ns // 2 else None
