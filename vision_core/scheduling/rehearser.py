"""Rehearsal: tasks repeat their last run shortly before the next release, so that this finds warm caches.

Between two frames other programs use the caches, and the first run afterwards takes about twice as long. A rehearsal
repeats the last run from the state before it, and ends in the state it had: nobody sees a trace of it. Then the process
watches for the release instead of sleeping, which saves the wake-up.

Tasks of one process that release each other are a chain: they rehearse one after the other, before the release of the
first. The lead is the second longest of the last cold runs, and a margin: one that was interrupted does not count. Cold
runs are rehearsals, and runs that none came before. There is no rehearsal while the releases have no rhythm, or the
lead is a large share of the period.
"""

from collections import deque
from collections.abc import Callable, Sequence
from typing import TypeAlias

from vision_core.clock import NS_PER_US, Clock, Instant, seconds_between
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
MAX_SHARE = 0.25
"""Of the period: a longer lead is not taken."""
KEPT = 8
"""Cold runs that count for the lead."""


class Part:
    """The rehearsal of one task of a chain, and how often it came about."""

    def __init__(self, rehearsal: Rehearsal) -> None:
        self.rehearsal = rehearsal
        self.counts = Rehearsals()

    def watched(self, since: Instant, until: Instant) -> None:
        """The process has watched for the release."""
        self.counts.spent_s += seconds_between(since, until)


class Rehearser:
    """Decides when a chain of tasks rehearses."""

    def __init__(self, clock: Clock) -> None:
        self._clock = clock
        self._rhythm = Rhythm()
        self._cold_ns: deque[int] = deque(maxlen=KEPT)
        self._answered: Instant | None = None
        """The due instant for which it was rehearsed, or which was skipped."""
        self._is_warm = False
        """It was rehearsed since the last run."""

    def released(self, at: Instant) -> None:
        """The first task was released at an instant."""
        self._rhythm.note(at)

    def ran(self, took_ns: int) -> None:
        """The chain has run."""
        if not self._is_warm:
            self._cold_ns.append(took_ns)
        self._is_warm = False

    def begin(self, now: Instant, parts: Sequence[Part]) -> Instant | None:
        """When to rehearse these parts for the next release; None: not before it."""
        due, period_ns = self._rhythm.due, self._rhythm.period_ns
        if due is None or period_ns is None or due == self._answered or not parts or not self._cold_ns:
            return None
        run_ns = sorted(self._cold_ns)[-2:][0]
        if run_ns + MARGIN_NS > MAX_SHARE * period_ns or now > due - run_ns:
            self._answered = due
            for part in parts:
                part.counts.skipped += 1
            return None
        return Instant(due - run_ns - MARGIN_NS)

    def rehearse(self, parts: Sequence[Part], give_way: GiveWay) -> Instant:
        """Rehearse the parts in order; returns until when to watch for the release."""
        due = self._rhythm.due
        assert due is not None
        self._answered, began = due, self._clock.now()
        at = began
        for part in parts:
            is_whole = not give_way() and part.rehearsal(give_way)
            part.counts.rehearsed += is_whole
            part.counts.cut_short += not is_whole
            self._is_warm |= is_whole
            before, at = at, self._clock.now()
            part.counts.spent_s += seconds_between(before, at)
        if self._is_warm:
            self._cold_ns.append(at - began)
        return Instant(due + WATCH_NS)
