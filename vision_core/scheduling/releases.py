"""When a task is due: by a record, on a grid in time, or by itself. No clock of its own, no waiting."""

from dataclasses import dataclass

from vision_core.clock import NS_PER_S, Instant
from vision_core.rtdb.slots import SlotReader


@dataclass(slots=True)
class Release:
    """One call of a task. A task that knows better when it was due, or what it left out, may say so in it."""

    due: Instant
    """When it should have begun: the grid's instant, or when the record was written."""
    began: Instant
    missed: int = 0
    """Releases that passed before this one without a run."""
    sequence: int = 0
    """Of the writing that releases it; 0 on a grid in time."""


class Grid:
    """Instants origin + k * period. One that has passed by a whole period is over, and is counted."""

    def __init__(self, origin: Instant, period_s: float) -> None:
        self.origin = origin
        self.period_ns = max(round(period_s * NS_PER_S), 1)
        self._number: int | None = None

    def due(self, now: Instant) -> Instant:
        """The next instant that was not taken: in the future, or at most a period ago."""
        newest = (now - self.origin) // self.period_ns
        if self._number is None:
            self._number = max(newest, -1)  # the first one lies ahead
        return Instant(self.origin + max(self._number + 1, newest) * self.period_ns)

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
        """What passes from now on until the next look was not missed: the task was switched off."""
        self._number = None


class Trigger:
    """A record's writings; with a period, only the first one in each stretch of the grid.

    To who begins, the newest writing is news, however old: an order that nobody has filled still waits.
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

    def forget(self) -> None:
        """What was written up to now was not missed, the newest is news: the task was switched off or on."""
        self._seen = max(self._record.sequence - 1, 0)
        if self._grid is not None:
            self._grid.forget()
