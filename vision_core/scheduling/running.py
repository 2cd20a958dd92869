"""The tasks of a process while it runs, and chains of tasks that release each other."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from vision_core.clock import Clock, Instant
from vision_core.rtdb.infos import Refusal
from vision_core.rtdb.slots import SlotWriter
from vision_core.rtdb.task import Task
from vision_core.scheduling.handle import Handle, Step
from vision_core.scheduling.metrics import TaskMetrics
from vision_core.scheduling.rehearser import GiveWay, Part, Rehearser
from vision_core.scheduling.releases import Grid, Release, StepResult, Trigger


@dataclass(slots=True, eq=False)
class RunningTask:
    """A task of this process."""

    declared: Task
    """As the table has it."""
    task: Task
    """As it runs now, with the overrides that hold."""
    handle: Handle
    step: Step
    metrics: TaskMetrics
    schedule: Grid | Trigger | None
    """None: a driver's task, which is always due."""
    waking: list[SlotWriter]
    """Its outputs that release tasks of other processes."""
    part: Part | None
    """Its rehearsal."""
    policy: str = ""
    refusal: Refusal | None = None
    """Of its priority."""

    def is_due(self, now: Instant) -> bool:
        """Is it released?"""
        return self.task.times.enabled and (self.schedule is None or self.schedule.is_due(now))

    def take(self, now: Instant) -> Release | None:
        """Its release; None when the record that releases it cannot be read just now."""
        return Release(now, now) if self.schedule is None else self.schedule.take(now)

    def releases(self, other: "RunningTask") -> bool:
        """Does what it writes release another task?"""
        return other.declared.trigger in self.declared.writes


@dataclass(frozen=True, slots=True)
class Run:
    """A run that was not counted yet."""

    running: RunningTask
    release: Release
    result: StepResult
    done: Instant


class Chain:
    """A task and those that it releases in the same process: they run in one go, and rehearse in one go."""

    def __init__(self, tasks: Sequence[RunningTask], clock: Clock) -> None:
        """tasks: in the order in which they run."""
        self.first = tasks[0]
        self._tasks = tasks
        self._clock = clock
        self._rehearser = Rehearser(clock)

    def ran(self, runs: Sequence[Run]) -> None:
        """The chain has run, as far as its tasks had something to do."""
        first, last = runs[0].release, runs[-1]
        self._rehearser.released(first.due)
        self._rehearser.ran((last.result.done or last.done) - first.began)

    def begin(self, now: Instant) -> Instant | None:
        """When to rehearse for the next release; None: not before it."""
        return self._rehearser.begin(now, self._parts())

    def rehearse(self, is_released: GiveWay) -> None:
        """Rehearse, then watch for the release until that is late: sleeping would cost the wake-up."""
        parts = self._parts()
        until = self._rehearser.rehearse(parts, is_released)
        began = now = self._clock.now()
        while now < until and not is_released():
            now = self._clock.now()
        parts[0].watched(began, now)

    def _parts(self) -> list[Part]:
        """What rehearses with the overrides that hold."""
        if not self.first.task.times.enabled:
            return []
        return [one.part for one in self._tasks if one.part and one.task.times.enabled and one.task.times.rehearse]


def chains_of(tasks: Sequence[RunningTask], clock: Clock) -> list[Chain]:
    """The chains of a process that have a rehearsal."""
    heads = [task for task in tasks if not any(other.releases(task) for other in tasks)]
    chains = [list(_chain(head, tasks)) for head in heads]
    return [Chain(chain, clock) for chain in chains if any(task.part for task in chain)]


def _chain(task: RunningTask, tasks: Sequence[RunningTask]) -> Iterator[RunningTask]:
    """A task, and those that follow from it; the table of tasks has no cycle."""
    yield task
    for other in tasks:
        if task.releases(other):
            yield from _chain(other, tasks)
