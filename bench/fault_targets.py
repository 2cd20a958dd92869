"""Processes of a running service as targets of fault injection, and the condition that each has recovered.

Everything is read from the service's real-time database; for the page's process, /readyz is asked as well.
"""

import os
import signal
import time
import urllib.error
from dataclasses import dataclass, replace

from bench.frame_path import VIEWS
from bench.service import RunningService
from vision_core.clock import NS_PER_S, Instant, MonotonicClock, seconds_between
from vision_core.net.control import Attached
from vision_core.rtdb import records
from vision_core.rtdb.infos import ProcessInfo
from vision_core.rtdb.process_state import ProcessState
from vision_core.rtdb.slots import SlotReader
from vision_core.rtdb.task import Task

PAGE_PERIOD_S = 0.5
"""A process with a loop of its own serves the page; it counts as a task with this period."""
FRAME_PATH_LIMIT_S = 1.0
"""Longest recovery of a process on the frame path that meets the goal."""
OTHERS_LIMIT_S, OTHERS_PERIODS = 1.0, 2.0
"""The same for all other processes: so many seconds and periods of the task together."""
TIMEOUT_S = 60.0
POLL_EVERY_S = 0.005
SPARE = "spare-"


@dataclass(frozen=True, slots=True)
class FaultTarget:
    """A process that must recover after a fault."""

    name: str
    tasks: tuple[Task, ...]
    limit_s: float | None
    """Longest recovery that meets the goal; None: there is no goal."""

    @property
    def is_on_frame_path(self) -> bool:
        """Do the robots' views depend on it?"""
        return any(task.on_frame_path for task in self.tasks)

    @property
    def serves_page(self) -> bool:
        """Does it serve the page, in a loop of its own?"""
        return any(task.own_loop for task in self.tasks)


class ServiceUnderTest:
    """A running service and its database."""

    def __init__(self, running: RunningService, attached: Attached) -> None:
        self.running = running
        self.attached = attached
        self._clock = MonotonicClock()
        self._processes = records.PROCESSES.reader(attached.store)
        self._readers: dict[str, SlotReader] = {}
        self.tasks = records.SERVICE.reader(attached.store).value(self._clock.now()).tasks

    def targets(self) -> list[FaultTarget]:
        """Every process that runs permanently, spare processes included."""
        return [self._target(row.name) for row in self.processes() if row.state != ProcessState.DONE]

    def _target(self, name: str) -> FaultTarget:
        tasks = tuple(task for task in self.tasks if task.process == name)
        target = FaultTarget(name, tasks, None)
        if not tasks:  # a spare
            return target
        if target.is_on_frame_path:
            return replace(target, limit_s=FRAME_PATH_LIMIT_S)
        period_s = PAGE_PERIOD_S if target.serves_page else max(task.times.period_s for task in tasks)
        return replace(target, limit_s=OTHERS_PERIODS * period_s + OTHERS_LIMIT_S)

    def processes(self) -> tuple[ProcessInfo, ...]:
        """The supervisor's table of processes."""
        return self._processes.value(self._clock.now()).processes

    def process(self, name: str) -> ProcessInfo:
        """One row of the supervisor's table."""
        return next(row for row in self.processes() if row.name == name)

    def wait_until_healthy(self) -> float:
        """Wait until every process runs and at least one spare process is ready. Returns how long that took [s].

        Raises RuntimeError after TIMEOUT_S.
        """
        began = self._clock.now()
        while not self._is_healthy():
            if seconds_between(began, self._clock.now()) > TIMEOUT_S:
                states = {row.name: row.state for row in self.processes()}
                raise RuntimeError(f"after {TIMEOUT_S:g} s {states} were found; all running was expected")
            time.sleep(POLL_EVERY_S)
        return seconds_between(began, self._clock.now())

    def _is_healthy(self) -> bool:
        rows = self.processes()
        spares = [row for row in rows if row.name.startswith(SPARE)]
        others = [row for row in rows if row not in spares]
        return all(row.state in (ProcessState.RUNNING, ProcessState.DONE) for row in others) and any(
            row.state == ProcessState.RUNNING for row in spares
        )

    def inject(self, target: FaultTarget, fault: signal.Signals) -> tuple[Instant, float]:
        """Send a signal to a process and wait until it has recovered, TIMEOUT_S at most.

        Returns when the signal was sent and how long the recovery took [s].
        """
        pid = self.process(target.name).pid
        assert pid is not None
        os.kill(pid, fault)
        injected = self._clock.now()
        while not self._has_recovered(target, pid, injected) and self._clock.now() - injected < TIMEOUT_S * NS_PER_S:
            time.sleep(POLL_EVERY_S)
        return injected, seconds_between(injected, self._clock.now())

    def _has_recovered(self, target: FaultTarget, pid: int, injected: Instant) -> bool:
        """Does a successor do the work of the process that had a pid when the fault was injected?"""
        if not target.tasks:
            row = self.process(target.name)
            return row.state == ProcessState.RUNNING and row.pid != pid
        if not all(self._has_successor(task, pid, injected) for task in target.tasks):
            return False
        if target.serves_page:
            return self.is_ready()
        if target.is_on_frame_path:
            view = self._reader(VIEWS).view()
            return view is not None and view.measured > injected
        return all(self._was_written_since(record, injected) for task in target.tasks for record in task.writes)

    def _has_successor(self, task: Task, pid: int, injected: Instant) -> bool:
        item = records.task(task.name)
        reading = item.over_reader(self._reader(item.spec.name)).read(self._clock.now())
        return reading is not None and reading.value.pid != pid and reading.written > injected

    def _was_written_since(self, record: str, injected: Instant) -> bool:
        reading = self._reader(record).read(self._clock.now())
        return reading is not None and reading.valid and reading.written > injected

    def _reader(self, record: str) -> SlotReader:
        if record not in self._readers:
            self._readers[record] = self.attached.store.reader(record)
        return self._readers[record]

    def is_ready(self) -> bool:
        """Does /readyz answer with status 200?"""
        try:
            return self.running.get("/readyz")[0] == 200
        except (OSError, urllib.error.URLError):
            return False
