"""The loop of a process: runs its tasks when they are due, the highest priority first."""

import gc
import select
import sys
from collections.abc import Sequence
from dataclasses import dataclass, replace

from vision_core.clock import NS_PER_S, Instant, MonotonicClock, after, seconds_between
from vision_core.rtdb import records
from vision_core.rtdb.infos import TaskOverride
from vision_core.rtdb.slots import SlotWriter
from vision_core.scheduling.attachment import Attachment
from vision_core.scheduling.handle import HEARTBEAT_EVERY_S, Handle, Step
from vision_core.scheduling.metrics import TaskMetrics
from vision_core.scheduling.realtime import (
    ask_priority,
    exact_timers,
    freeze_garbage,
    lock_memory,
    sleep_until,
    stay_on,
)
from vision_core.scheduling.releases import Grid, Release, Trigger
from vision_core.scheduling.task import DRIVER, PERIOD, Task

COLLECT_EVERY_NS = 10 * NS_PER_S
EARLY_NS = 200_000
"""A process that waits for an instant alone wakes so long before it and looks at the clock until it comes: how late the
kernel wakes a sleeper varies more than how long a look takes."""
MS_PER_S = 1e3


@dataclass(slots=True)
class _Running:
    """A task of this process."""

    declared: Task
    """As the table has it."""
    task: Task
    """As it runs now."""
    handle: Handle
    step: Step
    metrics: TaskMetrics
    schedule: Grid | Trigger | None
    """None: a driver's task, which is always due."""
    heard: list[SlotWriter]
    """Its outputs that release others."""
    standing: str = ""
    refused: str = ""


class Executive:
    """Runs the tasks of one process until the supervisor says stop."""

    def __init__(self, attachment: Attachment, started: Sequence[tuple[Handle, Step]]) -> None:
        """started: what each task's ``start`` made of its handle."""
        self._attachment = attachment
        self._clock = MonotonicClock()
        self._proposed = records.PROPOSED.reader(attachment.store)
        self._obeyed = 0
        self._collected = self._clock.now()
        self._tasks = [self._running(handle, step) for handle, step in started]
        self._chores = [callback for handle, _ in started for callback in handle.idle_callbacks]
        self._listeners = {key: value for handle, _ in started for key, value in handle.listeners.items()}
        wake = attachment.resources.wake
        self._listening = [*self._listeners] if wake is None else [wake, *self._listeners]
        self._priority: int | None = None
        self._kept = ""
        """What was refused beside the priority."""

    def run(self) -> None:
        """Ask for real time, then serve releases."""
        self._obey()
        freeze_garbage()
        exact_timers()
        self._go_real_time()
        while not self._attachment.stopping:
            self._turn()

    def _running(self, handle: Handle, step: Step) -> _Running:
        task, store = handle.task, self._attachment.store
        heard = [writer for name, writer in handle.outputs.items() if self._attachment.resources.notify.get(name)]
        handle.notified = {writer.spec.name: writer.sequence for writer in heard} | handle.notified
        metrics = TaskMetrics(store, task, self._attachment.resources.process)
        return _Running(task, task, handle, step, metrics, self._schedule(task), heard)

    def _schedule(self, task: Task) -> Grid | Trigger | None:
        if task.trigger == DRIVER:
            return None
        origin = Instant(self._attachment.boot + round(task.offset_s * NS_PER_S))
        if task.trigger == PERIOD:
            return Grid(origin, task.period_s)
        return Trigger(self._attachment.store.reader(task.trigger), origin, task.period_s)

    def _turn(self) -> None:
        """Run the first task that is due, or wait until one is."""
        now = self._clock.now()
        if self._is_asked():
            self._obey()
        if not self._run_first(now):
            self._wait(now)
        for callback in self._chores:
            callback()

    def _is_asked(self) -> bool:
        """Does somebody want something of us: another table, or an end?"""
        return self._proposed.sequence != self._obeyed or self._attachment.stopping

    def _run_first(self, now: Instant) -> bool:
        """Run the first task that is due, if one is."""
        for running in self._tasks:
            if running.task.enabled and (release := self._take(running, now)) is not None:
                self._run(running, release)
                return True
        return False

    def _take(self, running: _Running, now: Instant) -> Release | None:
        return Release(now, now) if running.schedule is None else running.schedule.take(now)

    def _run(self, running: _Running, release: Release) -> None:
        if running.task.priority != self._priority:
            self._ask(running.task.priority)
        done_anything = running.step(release)
        done = self._clock.now()
        for writer in running.heard:
            if writer.sequence != running.handle.notified[writer.spec.name]:
                running.handle.notify(writer.spec.name)
        if done_anything is False:
            running.metrics.missed(release.missed)
        else:
            running.metrics.ran(release, done)
        now = self._clock.now()
        self._attachment.heartbeat(now)
        self._publish(running, now)
        if running.schedule is None:  # a driver's task never waits here
            self._tidy(now)

    def _wait(self, now: Instant) -> None:
        """Tell how the tasks do, tidy up, and sleep until the next release or beat."""
        self._attachment.heartbeat(now)
        highest = max((running.task.priority for running in self._tasks), default=0)
        if highest != self._priority:
            self._ask(highest)
        for running in self._tasks:
            self._publish(running, now)
        self._tidy(now)
        due = [
            running.schedule.due(now)
            for running in self._tasks
            if running.task.enabled and isinstance(running.schedule, Grid)
        ]
        beat = after(now, HEARTBEAT_EVERY_S)
        if self._listening:
            self._listen(min([beat, *due]))
        elif due and min(due) < beat:
            sleep_until(Instant(min(due) - EARLY_NS))
            while not (self._is_asked() or self._run_first(self._clock.now())):
                pass
        else:
            sleep_until(beat)

    def _tidy(self, now: Instant) -> None:
        """Collect garbage now and then, when nothing is due."""
        if now - self._collected > COLLECT_EVERY_NS:
            gc.collect()
            self._collected = now
            for running in self._tasks:
                running.metrics.collections += 1

    def _listen(self, until: Instant) -> None:
        """Sleep until an instant, or before that a release or something to hear, which is handled."""
        left_s = seconds_between(self._clock.now(), until)
        ready, _, _ = select.select(self._listening, [], [], max(left_s, 0.0))
        for descriptor in ready:
            if descriptor == self._attachment.resources.wake:
                self._attachment.clear()
            else:
                self._listeners[descriptor]()

    def _publish(self, running: _Running, now: Instant) -> None:
        running.metrics.note = running.handle.note
        refused = "; ".join(filter(None, (running.refused, self._kept)))
        running.metrics.publish_if_due(now, running.task, running.standing, refused)

    def _obey(self) -> None:
        """Let every task run as the newest proposal wants it."""
        self._obeyed = self._proposed.sequence
        timed = self._proposed.read(self._clock.now())
        for running in self._tasks:
            proposal = timed.value.tasks.get(running.declared.name, TaskOverride()) if timed else TaskOverride()
            wanted = with_override(running.declared, proposal)
            if wanted == running.task:
                continue
            if wanted.period_s != running.task.period_s:
                running.schedule = self._schedule(wanted)
            if wanted.enabled != running.task.enabled:
                running.metrics.pause()
                running.handle.pause()
                if running.schedule is not None:
                    running.schedule.forget()
            running.task = wanted
            running.metrics.hurry()  # whoever asked looks at once
        self._tasks.sort(key=lambda running: -running.task.priority)

    def _go_real_time(self) -> None:
        """Ask for everything once, so that what is refused is known; the highest priority last."""
        tasks = [running.task for running in self._tasks]
        refused = [stay_on(sorted({core for task in tasks for core in task.cores}))]
        if any(task.priority for task in tasks):
            refused.append(lock_memory().refused)
        self._kept = "; ".join(filter(None, refused))
        for priority in sorted({task.priority for task in tasks}):
            self._ask(priority)
        said = {running.refused for running in self._tasks} | {self._kept}
        for line in sorted(filter(None, said)):
            print(f"{self._attachment.resources.process}: {line}", file=sys.stderr, flush=True)

    def _ask(self, priority: int) -> None:
        """Run at a priority from now on, and note what its tasks got."""
        self._priority, standing = priority, ask_priority(priority)
        for running in self._tasks:
            if running.task.priority == priority:
                running.standing, running.refused = standing.policy, standing.refused


def with_override(task: Task, proposal: TaskOverride) -> Task:
    """A task as somebody wants it to run."""
    return replace(
        task,
        enabled=task.enabled if proposal.enabled is None else proposal.enabled,
        period_s=task.period_s if proposal.period_ms is None else proposal.period_ms / MS_PER_S,
        priority=task.priority if proposal.priority is None else proposal.priority,
    )
