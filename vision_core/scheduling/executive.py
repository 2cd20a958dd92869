"""The loop of a process: it runs the tasks that are due, the highest priority first."""

import gc
import select
import sys
from collections.abc import Sequence
from dataclasses import asdict, replace

import msgspec

from vision_core.clock import NS_PER_S, Instant, MonotonicClock, after, seconds_between
from vision_core.rtdb import records
from vision_core.rtdb.infos import Refusal, TaskOverride
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
from vision_core.scheduling.rehearser import Part
from vision_core.scheduling.releases import Grid, Release, Trigger
from vision_core.scheduling.running import Run, RunningTask, chains_of

COLLECT_EVERY_NS = 10 * NS_PER_S
EARLY_NS = 200_000
"""A process that waits only for an instant wakes this long before it and reads the clock until it comes: how late the
kernel wakes a process varies more than how long reading the clock takes."""


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
        self._chains = chains_of(self._tasks, self._clock)
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

    def _running(self, handle: Handle, step: Step) -> RunningTask:
        task, store = handle.task, self._attachment.store
        waking = [writer for name, writer in handle.outputs.items() if self._attachment.resources.notify.get(name)]
        handle.notified = {writer.spec.name: writer.sequence for writer in waking} | handle.notified
        metrics = TaskMetrics(store, task, self._attachment.resources.process)
        part = None if handle.rehearsal is None else Part(handle.rehearsal)
        metrics.rehearsals = part.counts if part else None
        return RunningTask(task, task, handle, step, metrics, self._schedule(task), waking, part)

    def _schedule(self, task: Task) -> Grid | Trigger | None:
        if task.trigger == DRIVER:
            return None
        origin = Instant(self._attachment.boot + round(task.times.offset_s * NS_PER_S))
        if task.trigger == PERIOD:
            return Grid(origin, task.times.period_s)
        return Trigger(self._attachment.store.reader(task.trigger), origin, task.times.period_s)

    def _turn(self) -> None:
        """Run what is due, or wait and run what is due then; then call what the tasks registered for every turn."""
        if not self._run_due():
            self._wait(self._clock.now())
            self._run_due()
        for callback in self._chores:
            callback()

    def _is_interrupted(self) -> bool:
        """Are there new overrides, or does the service stop?"""
        return self._overrides.sequence != self._overrides_read or self._attachment.stopping

    def _run_due(self) -> bool:
        """Run the first task that is due and what it releases here, and count the runs afterwards; False: none is due.

        Between two tasks of the frame path there is nothing that could wait until its datagrams are sent.
        """
        if self._is_interrupted():
            self._apply_overrides()
        runs: list[Run] = []
        running = self._first_due()
        while running is not None and (not runs or runs[-1].running.releases(running)):
            release = running.take(self._clock.now())
            if release is None:
                break
            runs.append(self._run(running, release))
            running = self._first_due()
        if runs:
            self._count(runs)
        return bool(runs)

    def _first_due(self) -> RunningTask | None:
        """The task with the highest priority of those that are due."""
        now = self._clock.now()
        return next((running for running in self._tasks if running.is_due(now)), None)

    def _run(self, running: RunningTask, release: Release) -> Run:
        if running.task.times.priority != self._priority:
            self._ask(running.task.times.priority)
        result = running.step(release)
        done = self._clock.now()
        for writer in running.waking:
            if writer.sequence != running.handle.notified[writer.spec.name]:
                running.handle.notify(writer.spec.name)
        return Run(running, release, result, done)

    def _count(self, runs: Sequence[Run]) -> None:
        """Note what has run, and publish it when it is time to."""
        for run in runs:
            run.running.metrics.count_missed(run.release.missed + run.result.missed)
            if run.result.ran:
                run.running.metrics.count_run(run.release, run.result, run.done)
        for chain in self._chains:
            if chain.first is runs[0].running and runs[0].result.ran:
                chain.ran(runs)
        now = self._clock.now()
        self._attachment.heartbeat(now)
        for run in runs:
            self._publish(run.running, now)
        if runs[0].running.schedule is None:  # a driver's task never waits here
            self._collect_garbage(now)

    def _wait(self, now: Instant) -> None:
        """Publish the metrics, collect garbage if that is due, and sleep until the next release or heartbeat.

        A chain whose time has come to rehearse does that instead.
        """
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
        for chain in self._chains:
            begin = chain.begin(now)
            if begin is not None and begin <= now:
                chain.rehearse(self._is_needed)
                return
            due += [begin] if begin is not None else []
        heartbeat = after(now, HEARTBEAT_EVERY_S)
        if self._listening:
            self._listen(min([heartbeat, *due]))
        elif due and min(due) < heartbeat:
            sleep_until(Instant(min(due) - EARLY_NS))
            while not self._is_needed():
                pass
        else:
            sleep_until(heartbeat)

    def _is_needed(self) -> bool:
        """Is a task due, or the process interrupted?"""
        return self._first_due() is not None or self._is_interrupted()

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

    def _publish(self, running: RunningTask, now: Instant) -> None:
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
