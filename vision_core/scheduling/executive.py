"""The loop of a process: it runs the tasks that are due, the highest priority first."""

import gc
import select
import sys
from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace

import msgspec

from vision_core.clock import NS_PER_S, Instant, MonotonicClock, after, seconds_between
from vision_core.rtdb import records
from vision_core.rtdb.infos import Refusal, TaskOverride
from vision_core.rtdb.slots import SlotWriter
from vision_core.rtdb.task import DRIVER, PERIOD, Task
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
from vision_core.scheduling.rehearser import Rehearser
from vision_core.scheduling.releases import Grid, Release, Trigger

COLLECT_EVERY_NS = 10 * NS_PER_S
EARLY_NS = 200_000
"""A process that waits only for an instant wakes this long before it and reads the clock until it comes: how late the
kernel wakes a process varies more than how long reading the clock takes."""


@dataclass(slots=True)
class _Running:
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
    """Its outputs that release other tasks."""
    rehearser: Rehearser | None
    policy: str = ""
    refusal: Refusal | None = None
    """Of its priority."""


class Executive:
    """Runs the tasks of one process until the supervisor says stop."""

    def __init__(self, attachment: Attachment, started: Sequence[tuple[Handle, Step]]) -> None:
        """started: each task's handle, and the step that its ``start`` returned."""
        self._attachment = attachment
        self._clock = MonotonicClock()
        self._overrides = records.LIVE_SETTINGS.reader(attachment.store)
        self._overrides_read = 0
        """Sequence number of the overrides that hold."""
        self._collected = self._clock.now()
        self._tasks = [self._running(handle, step) for handle, step in started]
        self._chores = [callback for handle, _ in started for callback in handle.idle_callbacks]
        self._listeners = {key: value for handle, _ in started for key, value in handle.listeners.items()}
        wake = attachment.resources.wake
        self._listening = [*self._listeners] if wake is None else [wake, *self._listeners]
        self._priority: int | None = None
        self._refusals: tuple[Refusal, ...] = ()
        """Of cores and memory, which concern all tasks of the process."""

    def run(self) -> None:
        """Ask for real-time priority, then run tasks."""
        self._apply_overrides()
        freeze_garbage()
        exact_timers()
        self._go_real_time()
        while not self._attachment.stopping:
            self._turn()

    def _running(self, handle: Handle, step: Step) -> _Running:
        task, store = handle.task, self._attachment.store
        waking = [writer for name, writer in handle.outputs.items() if self._attachment.resources.notify.get(name)]
        handle.notified = {writer.spec.name: writer.sequence for writer in waking} | handle.notified
        metrics = TaskMetrics(store, task, self._attachment.resources.process)
        rehearser = None if handle.rehearsal is None else Rehearser(handle.rehearsal, self._clock)
        metrics.rehearsals = rehearser.counts if rehearser else None
        return _Running(task, task, handle, step, metrics, self._schedule(task), waking, rehearser)

    def _schedule(self, task: Task) -> Grid | Trigger | None:
        if task.trigger == DRIVER:
            return None
        origin = Instant(self._attachment.boot + round(task.times.offset_s * NS_PER_S))
        if task.trigger == PERIOD:
            return Grid(origin, task.times.period_s)
        return Trigger(self._attachment.store.reader(task.trigger), origin, task.times.period_s)

    def _turn(self) -> None:
        """Run the first task that is due, or wait until one is; then call what the tasks registered for every turn."""
        now = self._clock.now()
        if self._is_interrupted():
            self._apply_overrides()
        if not self._run_first(now):
            self._wait(now)
        for callback in self._chores:
            callback()

    def _is_interrupted(self) -> bool:
        """Are there new overrides, or does the service stop?"""
        return self._overrides.sequence != self._overrides_read or self._attachment.stopping

    def _run_first(self, now: Instant) -> bool:
        """Run the first task that is due, if one is."""
        for running in self._tasks:
            if running.task.times.enabled and (release := self._take(running, now)) is not None:
                self._run(running, release)
                return True
        return False

    def _take(self, running: _Running, now: Instant) -> Release | None:
        return Release(now, now) if running.schedule is None else running.schedule.take(now)

    def _run(self, running: _Running, release: Release) -> None:
        if running.task.times.priority != self._priority:
            self._ask(running.task.times.priority)
        if running.rehearser is not None:
            running.rehearser.released(release.due)
        result = running.step(release)
        done = self._clock.now()
        for writer in running.waking:
            if writer.sequence != running.handle.notified[writer.spec.name]:
                running.handle.notify(writer.spec.name)
        running.metrics.count_missed(release.missed + result.missed)
        if result.ran:
            running.metrics.count_run(release, result, done)
        now = self._clock.now()
        self._attachment.heartbeat(now)
        self._publish(running, now)
        if running.schedule is None:  # a driver's task never waits here
            self._collect_garbage(now)

    def _wait(self, now: Instant) -> None:
        """Publish the metrics, collect garbage if that is due, and sleep until the next release or heartbeat."""
        self._attachment.heartbeat(now)
        highest = max((running.task.times.priority for running in self._tasks), default=0)
        if highest != self._priority:
            self._ask(highest)
        for running in self._tasks:
            self._publish(running, now)
        self._collect_garbage(now)
        due = [
            running.schedule.due(now)
            for running in self._tasks
            if running.task.times.enabled and isinstance(running.schedule, Grid)
        ]
        rehearsals = self._rehearsals(now)
        if rehearsals and rehearsals[0][0] <= now:
            self._rehearse(rehearsals[0][1])
            return
        due += [begin for begin, _ in rehearsals[:1]]
        heartbeat = after(now, HEARTBEAT_EVERY_S)
        if self._listening:
            self._listen(min([heartbeat, *due]))
        elif due and min(due) < heartbeat:
            sleep_until(Instant(min(due) - EARLY_NS))
            while not (self._is_interrupted() or self._run_first(self._clock.now())):
                pass
        else:
            sleep_until(heartbeat)

    def _rehearsals(self, now: Instant) -> list[tuple[Instant, _Running]]:
        """When which task is to rehearse, the first one first."""
        found = []
        for running in self._tasks:
            rehearser, times = running.rehearser, running.task.times
            if rehearser is not None and times.enabled and times.rehearse and (begin := rehearser.begin(now)):
                found.append((begin, running))
        return sorted(found, key=lambda one: one[0])

    def _rehearse(self, running: _Running) -> None:
        """Rehearse a task, then watch for its release until that is late: sleeping would cost the wake-up."""
        rehearser, schedule = running.rehearser, running.schedule
        assert rehearser is not None
        assert isinstance(schedule, Trigger)
        until = rehearser.rehearse(lambda: schedule.waits)
        began = now = self._clock.now()
        while now < until and not schedule.waits and not self._is_interrupted():
            now = self._clock.now()
        rehearser.watched(began)

    def _collect_garbage(self, now: Instant) -> None:
        """Collect garbage every COLLECT_EVERY_NS, when no task is due."""
        if now - self._collected > COLLECT_EVERY_NS:
            gc.collect()
            self._collected = now
            for running in self._tasks:
                running.metrics.collections += 1

    def _listen(self, until: Instant) -> None:
        """Sleep until an instant, a release, or a readable descriptor of a task, whose handler is called."""
        left_s = seconds_between(self._clock.now(), until)
        ready, _, _ = select.select(self._listening, [], [], max(left_s, 0.0))
        for descriptor in ready:
            if descriptor == self._attachment.resources.wake:
                self._attachment.clear()
            else:
                self._listeners[descriptor]()

    def _publish(self, running: _Running, now: Instant) -> None:
        running.metrics.note = running.handle.note
        refusals = (running.refusal, *self._refusals) if running.refusal is not None else self._refusals
        running.metrics.publish_if_due(now, running.task, running.policy, refusals)

    def _apply_overrides(self) -> None:
        """Let every task run with its newest overrides."""
        self._overrides_read = self._overrides.sequence
        timed = self._overrides.read(self._clock.now())
        for running in self._tasks:
            override = timed.value.tasks.get(running.declared.name, TaskOverride()) if timed else TaskOverride()
            wanted = with_override(running.declared, override)
            if wanted == running.task:
                continue
            if wanted.times.period_s != running.task.times.period_s:
                running.schedule = self._schedule(wanted)
            if wanted.times.enabled != running.task.times.enabled:
                running.metrics.pause()
                running.handle.switch()
                if running.schedule is not None:
                    running.schedule.forget()
            running.task = wanted
            running.metrics.hurry()  # a person waits to see the change
        self._tasks.sort(key=lambda running: -running.task.times.priority)

    def _go_real_time(self) -> None:
        """Ask for cores, locked memory and each priority once, the highest last, so that every refusal is known."""
        tasks = [running.task for running in self._tasks]
        refusals = [stay_on(sorted({core for task in tasks for core in task.times.cores}))]
        if any(task.times.priority for task in tasks):
            refusals.append(lock_memory())
        self._refusals = tuple(filter(None, refusals))
        for priority in sorted({task.times.priority for task in tasks}):
            self._ask(priority)
        all_refusals = {str(running.refusal) for running in self._tasks if running.refusal} | set(
            map(str, self._refusals)
        )
        for line in sorted(all_refusals):
            print(f"{self._attachment.resources.process}: {line}", file=sys.stderr, flush=True)

    def _ask(self, priority: int) -> None:
        """Run at a priority from now on, and note the policy that its tasks were granted."""
        self._priority, granted = priority, ask_priority(priority)
        for running in self._tasks:
            if running.task.times.priority == priority:
                running.policy, running.refusal = granted.policy, granted.refusal


def with_override(task: Task, override: TaskOverride) -> Task:
    """A task with the times that an override changes."""
    changes = {name: value for name, value in asdict(override).items() if value is not None}
    return replace(task, times=msgspec.structs.replace(task.times, **changes))
