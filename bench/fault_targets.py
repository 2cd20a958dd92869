"""What can be taken from a running service, and when it is whole again: as its database tells."""

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
from vision_core.rtdb.slots import SlotReader
from vision_core.rtdb.task import Task
from vision_core.tasks.table import task_table

FRAME_TASKS = ("source", "capture", "perceive", "serve")
WEB, WEB_PERIOD_S = "web", 0.5
FRAME_LIMIT_S, OTHERS_LIMIT_S, OTHERS_PERIODS = 1.0, 1.0, 2.0
PATIENCE_S = 60.0
LOOK_EVERY_S = 0.005
RUNNING, DONE = "running", "done"
SPARE = "spare-"
NOT_FRESH = ("proposed_settings",)
"""Outputs that are written when somebody wants something, not when a task runs."""


@dataclass(frozen=True, slots=True)
class Victim:
    """A process that is to come back."""

    name: str
    tasks: tuple[Task, ...]
    limit_s: float | None
    """How soon it is to be back; None: nobody waits for it."""

    @property
    def on_the_way(self) -> bool:
        """Do robots' views go through it?"""
        return self.name in FRAME_TASKS


class Service:
    """A running service and its database."""

    def __init__(self, running: RunningService, attached: Attached) -> None:
        self.running = running
        self.attached = attached
        self._clock = MonotonicClock()
        self._processes = records.PROCESSES.reader(attached.store)
        self._readers: dict[str, SlotReader] = {}
        settings = records.SERVICE.reader(attached.store).value(self._clock.now()).settings
        self.tasks = task_table(settings)

    def victims(self) -> list[Victim]:
        """Every process that runs all the time, the spares too."""
        return [self._victim(row.name) for row in self.processes() if row.state != DONE]

    def _victim(self, name: str) -> Victim:
        tasks = tuple(task for task in self.tasks if task.process == name)
        if name.startswith(SPARE):
            return Victim(name, tasks, None)
        if name in FRAME_TASKS:
            return Victim(name, tasks, FRAME_LIMIT_S)
        period_s = WEB_PERIOD_S if name == WEB else max(task.times.period_s for task in tasks)
        return Victim(name, tasks, OTHERS_PERIODS * period_s + OTHERS_LIMIT_S)

    def processes(self) -> tuple[ProcessInfo, ...]:
        """The supervisor's table."""
        return self._processes.value(self._clock.now()).processes

    def process(self, name: str) -> ProcessInfo:
        """One line of it."""
        return next(row for row in self.processes() if row.name == name)

    def wait_until_whole(self) -> float:
        """Wait until every process runs and a spare is warm; how long that took [s]. Raises RuntimeError."""
        began = self._clock.now()
        while not self._whole():
            if seconds_between(began, self._clock.now()) > PATIENCE_S:
                states = {row.name: row.state for row in self.processes()}
                raise RuntimeError(f"after {PATIENCE_S:g} s {states} were found; all running was expected")
            time.sleep(LOOK_EVERY_S)
        return seconds_between(began, self._clock.now())

    def _whole(self) -> bool:
        rows = self.processes()
        spares = [row for row in rows if row.name.startswith(SPARE)]
        others = [row for row in rows if row not in spares]
        return all(row.state in (RUNNING, DONE) for row in others) and any(row.state == RUNNING for row in spares)

    def strike(self, victim: Victim, how: signal.Signals) -> tuple[Instant, float]:
        """Send a signal; when that was, and how long it took until the process was back [s], PATIENCE_S at most."""
        pid = self.process(victim.name).pid
        assert pid is not None
        os.kill(pid, how)
        struck = self._clock.now()
        while not self._is_back(victim, pid, struck) and self._clock.now() - struck < PATIENCE_S * NS_PER_S:
            time.sleep(LOOK_EVERY_S)
        return struck, seconds_between(struck, self._clock.now())

    def _is_back(self, victim: Victim, pid: int, struck: Instant) -> bool:
        """Does a successor do all that it did?"""
        if not victim.tasks:
            row = self.process(victim.name)
            return row.state == RUNNING and row.pid != pid
        if not all(self._has_successor(task, pid, struck) for task in victim.tasks):
            return False
        if victim.name == WEB:
            return self.is_ready()
        if victim.on_the_way:
            view = self._reader(VIEWS).view()
            return view is not None and view.measured > struck
        return all(self._written_since(record, struck) for record in self._outputs(victim))

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
    def _outputs(victim: Victim) -> Iterator[str]:
        for task in victim.tasks:
            yield from (record for record in task.writes if record not in NOT_FRESH)

    def is_ready(self) -> bool:
        """Does the page say that the service is ready?"""
        try:
            return self.running.get("/readyz")[0] == 200
        except (OSError, urllib.error.URLError):
            return False
