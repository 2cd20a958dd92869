"""Rehearsal: a task repeats its last run shortly before its next release, so that this finds warm caches.

Between two frames other programs use the caches, and the first run afterwards takes about twice as long. A rehearsal
repeats the last run from the state before it, and ends in the state it had: nobody sees a trace of it. Then the process
watches for the release instead of sleeping, which saves the wake-up. The lead is what the last rehearsals took, which
ran cold, and a margin. There is none while the releases have no rhythm, or the lead is a large share of the period.
"""

from collections import deque
from collections.abc import Callable
from typing import TypeAlias

from vision_core.clock import NS_PER_MS, NS_PER_US, Clock, Instant, seconds_between
from vision_core.rtdb.infos import Rehearsals
from vision_core.scheduling.rhythm import Rhythm

GiveWay: TypeAlias = Callable[[], bool]
"""Is the task released? Then its rehearsal ends at the next stage."""
Rehearsal: TypeAlias = Callable[[GiveWay], bool]
"""Repeats the last run and undoes it; False when it gave way."""

MARGIN_NS = 300 * NS_PER_US
"""Between the end of a rehearsal and the release."""
WATCH_NS = 500 * NS_PER_US
"""For so long after the release was due it is watched for."""
FIRST_LEAD_NS = 2 * NS_PER_MS
MAX_SHARE = 0.25
"""Of the period: a longer lead is not taken."""
KEPT = 8
"""Rehearsals whose times count for the lead."""


class Rehearser:
    """Decides when a task rehearses, and counts it."""

    def __init__(self, rehearsal: Rehearsal, clock: Clock) -> None:
        self._rehearsal = rehearsal
        self._clock = clock
        self._rhythm = Rhythm()
        self._took_ns: deque[int] = deque([FIRST_LEAD_NS], maxlen=KEPT)
        self._answered: Instant | None = None
        """The due instant for which it was rehearsed, or which was skipped."""
        self.counts = Rehearsals()

    def released(self, at: Instant) -> None:
        """The task was released at an instant."""
        self._rhythm.note(at)

    def begin(self, now: Instant) -> Instant | None:
        """When to rehearse for the next release; None: not before it."""
        due, period_ns = self._rhythm.due, self._rhythm.period_ns
        if due is None or period_ns is None or due == self._answered:
            return None
        run_ns = max(self._took_ns)
        if run_ns + MARGIN_NS > MAX_SHARE * period_ns or now > due - run_ns:
            self._answered = due
            self.counts.skipped += 1
            return None
        return Instant(due - run_ns - MARGIN_NS)

    def rehearse(self, give_way: GiveWay) -> Instant:
        """Rehearse; returns until when to watch for the release."""
        due = self._rhythm.due
        assert due is not None
        self._answered, began = due, self._clock.now()
        if self._rehearsal(give_way):
            self.counts.rehearsed += 1
            self._took_ns.append(self._clock.now() - began)
        else:
            self.counts.cut_short += 1
        self.counts.spent_s += seconds_between(began, self._clock.now())
        return Instant(due + WATCH_NS)

    def watched(self, since: Instant) -> None:
        """The process has watched for the release since an instant."""
        self.counts.spent_s += seconds_between(since, self._clock.now())
