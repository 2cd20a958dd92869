"""When a task is due: by a record, or on a grid in time; and what it reports about a run. No clock, no waiting."""

from dataclasses import dataclass

from vision_core.clock import NS_PER_S, Instant
from vision_core.rtdb.slots import SlotReader


@dataclass(frozen=True, slots=True)
class Release:
    """One call of a task."""

    due: Instant
    """When the run should have begun: the grid's instant, or when the record was written."""
    began: Instant
    missed: int = 0
    """Releases that passed before this one without a run."""
    sequence: int = 0
    """Sequence number of the record that releases it; 0 on a grid in time."""


@dataclass(frozen=True, slots=True)
class StepResult:
    """What a task reports about one call."""

    ran: bool = True
    """False: there was nothing to do, and the call counts as no run."""
    missed: int = 0
    """Further releases that passed without a run, beside those of the release."""
    due: Instant | None = None
    """When the run should have begun, if the task knows better than its release; None: as released."""
    began: Instant | None = None
    """When it began, if the task first waited for something; None: as released."""
    done: Instant | None = None
    """When what its rehearsal repeats was done, if more followed; None: as it returned."""


RAN = StepResult()
IDLE = StepResult(ran=False)


class Grid:
    """Instants origin + k * period, k = 0, 1, 2, ... An instant that is a whole period old is skipped and counted."""

    def __init__(self, origin: Instant, period_s: float) -> None:
        self.origin = origin
        self.period_ns = max(round(period_s * NS_PER_S), 1)
        self._number: int | None = None

    def due(self, now: Instant) -> Instant:
        """The next instant that was not taken: it lies ahead, or at most one period back."""
        newest = (now - self.origin) // self.period_ns
        if self._number is None:
            self._number = max(newest, -1)  # the first one lies ahead
        return Instant(self.origin + max(self._number + 1, newest) * self.period_ns)

    def is_due(self, now: Instant) -> bool:
        """Has the next instant come?"""
        return self.due(now) <= now

    def take(self, now: Instant) -> Release | None:
        """The instant that is due, if one is."""
        due = self.due(now)
        if due > now:
            return None
        assert self._number is not None
        number = (due - self.origin) // self.period_ns
        missed = number - self._number - 1
        self._number = number
        return Release(due, now, missed)

    def forget(self) -> None:
        """Start anew: instants until the next call of ``take`` are not missed, since the task is switched off."""
        self._number = None


class Trigger:
    """Releases by the writing of a record; with a period, only the first writing in each period of the grid.

    The newest writing from before the start releases the task as well: it may be a request that still waits.
    """

    def __init__(self, record: SlotReader, origin: Instant, period_s: float) -> None:
        self._record = record
        self._seen = max(record.sequence - 1, 0)
        self._grid = Grid(origin, period_s) if period_s else None

    def take(self, now: Instant) -> Release | None:
        """The newest writing, if it has not released the task yet."""
        view = self._record.view()
        if view is None or view.sequence == self._seen:
            return None
        at = self._grid.take(now) if self._grid is not None else None
        if self._grid is not None and at is None:
            return None
        passed, self._seen = view.sequence - self._seen - 1, view.sequence
        if at is None:
            return Release(view.written, now, passed, view.sequence)
        return Release(max(view.written, at.due), now, min(passed, at.missed), view.sequence)

    def is_due(self, now: Instant) -> bool:
        """Was the record written since it released the task last, and is the grid's instant come?"""
        return self._record.sequence != self._seen and (self._grid is None or self._grid.is_due(now))

    def forget(self) -> None:
        """Start anew with the newest writing; older ones are not missed, since the task was switched off."""
        self._seen = max(self._record.sequence - 1, 0)
        if self._grid is not None:
            self._grid.forget()
