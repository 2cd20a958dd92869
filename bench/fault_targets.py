"""The processes that a running service can lose, and when it is complete again, by its database."""

import os
import signal
import time
import urllib.error
from collections.abc import Iterator
from dataclasses import dataclass

from bench.frame_path import VIEWS
from bench.service import RunningService
from vision_core.clock import NS_PER_S, Instant, MonotonicClock, seconds_between
from vision_core.net.control import Attached
from vision_core.rtdb import records
from vision_core.rtdb.infos import ProcessInfo
from vision_core.rtdb.process_state import ProcessState
from vision_core.rtdb.slots import SlotReader
from vision_core.rtdb.task import Task

WEB_PERIOD_S = 0.5
"""Of the records of the page's process, which has no period."""
FRAME_LIMIT_S, OTHERS_LIMIT_S, OTHERS_PERIODS = 1.0, 1.0, 2.0
PATIENCE_S = 60.0
LOOK_EVERY_S = 0.005
SPARE = "spare-"
NOT_FRESH = ("proposed_settings",)
"""Outputs that are written on request, not when a task runs."""


@dataclass(frozen=True, slots=True)
class FaultTarget:
    """A process that must come back when it is killed or stopped."""

    name: str
    tasks: tuple[Task, ...]
    limit_s: float | None
    """How soon it must be back [s]; None: no limit."""

    @property
    def on_frame_path(self) -> bool:
        """Is no robot served without it?"""
        return any(task.on_frame_path for task in self.tasks)

    @property
    def own_loop(self) -> bool:
        """Does it run in a loop of its own?"""
        return any(task.own_loop for task in self.tasks)


class Service:
    """A running service and its database."""

    def __init__(self, running: RunningService, attached: Attached) -> None:
        self.running = running
        self.attached = attached
        self._clock = MonotonicClock()
        self._processes = records.PROCESSES.reader(attached.store)
        self._readers: dict[str, SlotReader] = {}
        self.tasks = records.SERVICE.reader(attached.store).value(self._clock.now()).tasks

    def targets(self) -> list[FaultTarget]:
        """Every process that runs all the time, the spares too."""
        return [self._target(row.name) for row in self.processes() if row.state != ProcessState.DONE]

    def _target(self, name: str) -> FaultTarget:
        tasks = tuple(task for task in self.tasks if task.process == name)
        if name.startswith(SPARE):
            return FaultTarget(name, tasks, None)
        if any(task.on_frame_path for task in tasks):
            return FaultTarget(name, tasks, FRAME_LIMIT_S)
        period_s = max(WEB_PERIOD_S if task.own_loop else task.times.period_s for task in tasks)
        return FaultTarget(name, tasks, OTHERS_PERIODS * period_s + OTHERS_LIMIT_S)

    def processes(self) -> tuple[ProcessInfo, ...]:
        """The supervisor's table."""
        return self._processes.value(self._clock.now()).processes

    def process(self, name: str) -> ProcessInfo:
        """One line of it."""
        return next(row for row in self.processes() if row.name == name)

    def wait_until_complete(self) -> float:
        """Wait until every process runs and a spare is warm; how long that took [s]. Raises RuntimeError."""
        began = self._clock.now()
        while not self._is_complete():
            if seconds_between(began, self._clock.now()) > PATIENCE_S:
                states = {row.name: row.state for row in self.processes()}
                raise RuntimeError(f"after {PATIENCE_S:g} s {states} were found; all running was expected")
            time.sleep(LOOK_EVERY_S)
        return seconds_between(began, self._clock.now())

    def _is_complete(self) -> bool:
        rows = self.processes()
        spares = [row.state for row in rows if row.name.startswith(SPARE)]
        others = [row.state for row in rows if not row.name.startswith(SPARE)]
        expected = (ProcessState.RUNNING, ProcessState.DONE)
        return all(state in expected for state in others) and ProcessState.RUNNING in spares

    def strike(self, target: FaultTarget, how: signal.Signals) -> tuple[Instant, float]:
        """Send a signal; when that was, and how long it took until the process was back [s], PATIENCE_S at most."""
        pid = self.process(target.name).pid
        assert pid is not None
        os.kill(pid, how)
        struck = self._clock.now()
        while not self._is_back(target, pid, struck) and self._clock.now() - struck < PATIENCE_S * NS_PER_S:
            time.sleep(LOOK_EVERY_S)
        return struck, seconds_between(struck, self._clock.now())

    def _is_back(self, target: FaultTarget, pid: int, struck: Instant) -> bool:
        """Does a successor do all that it did?"""
        if not target.tasks:
            row = self.process(target.name)
            return row.state == ProcessState.RUNNING and row.pid != pid
        if not all(self._has_successor(task, pid, struck) for task in target.tasks):
            return False
        if target.own_loop:
            return self.is_ready()
        if target.on_frame_path:
            view = self._reader(VIEWS).view()
            return view is not None and view.measured > struck
        return all(self._written_since(record, struck) for record in self._outputs(target))

    def _has_successor(self, task: Task, pid: int, struck: Instant) -> bool:
        item = records.task(task.name)
        told = item.over_reader(self._reader(item.spec.name)).read(self._clock.now())
        return told is not None and told.value.pid != pid and told.written > struck

    def _written_since(self, record: str, struck: Instant) -> bool:
        reading = self._reader(record).read(self._clock.now())
        return reading is not None and reading.valid and reading.written > struck

    def _reader(self, record: str) -> SlotReader:
        if record not in self._readers:
            self._readers[record] = self.attached.store.reader(record)
        return self._readers[record]

    @staticmethod
    def _outputs(target: FaultTarget) -> Iterator[str]:
        for task in target.tasks:
            yield from (record for record in task.writes if record not in NOT_FRESH)

    def is_ready(self) -> bool:
        """Does the page say that the service is ready?"""
        try:
            return self.running.get("/readyz")[0] == 200
        except (OSError, urllib.error.URLError):
            return False
