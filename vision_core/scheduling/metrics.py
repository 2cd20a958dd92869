"""How a task does: every run is measured, and told twice a second."""

import math
import os
from collections import deque

from vision_core.clock import NS_PER_MS, NS_PER_S, Instant
from vision_core.rtdb import records
from vision_core.rtdb.infos import TIMINGS, TaskInfo
from vision_core.rtdb.store import Store
from vision_core.scheduling.releases import Release
from vision_core.scheduling.task import Task
from vision_core.timing.histogram import Histograms
from vision_core.timing.running_rate import RunningRate

PUBLISH_EVERY_NS = NS_PER_S // 2
INTERVALS_KEPT = 256
MAX_NOTE = 500


class TaskMetrics:
    """Measures one task."""

    def __init__(self, store: Store, task: Task, process: str) -> None:
        self._writer = records.task(task.name).writer(store)
        self._timing = store.writer(records.timing(task.name).name)
        self._task, self._process = task, process
        self._histograms = Histograms(TIMINGS)
        self._runs = self._missed = self._overruns = 0
        self._responses_ns: list[int] = []
        self._intervals_ns: deque[int] = deque(maxlen=INTERVALS_KEPT)
        self._last_began: Instant | None = None
        self._published, self._hurried = Instant(0), False
        self._rate = RunningRate()
        self.collections = 0
        self.note = ""

    def ran(self, release: Release, done: Instant) -> None:
        """A run, from its release to its result."""
        self._runs += 1
        self._missed += release.missed
        execution, response = done - release.began, done - release.due
        self._overruns += bool(self._task.budget_s) and execution > self._task.budget_s * NS_PER_S
        self._responses_ns.append(response)
        add = self._histograms.add
        add("lateness", release.began - release.due)
        add("execution", execution)
        add("response", response)
        if self._last_began is not None:
            add("interval", release.began - self._last_began)
            self._intervals_ns.append(release.began - self._last_began)
        self._last_began = release.began

    def missed(self, releases: int) -> None:
        """Releases passed before a run that had nothing to do."""
        self._missed += releases

    def pause(self) -> None:
        """The task was switched off: the time until its next run is no interval."""
        self._last_began = None
        self._rate.forget()

    def hurry(self) -> None:
        """The next chance to publish is to be taken."""
        self._hurried = True

    def publish_if_due(self, now: Instant, task: Task, standing: str, refused: str) -> None:
        """Write the records when half a second has passed. task: as it is in effect now."""
        if self._hurried or now - self._published >= PUBLISH_EVERY_NS:
            self.publish(now, task, standing, refused)

    def publish(self, now: Instant, task: Task, standing: str, refused: str) -> None:
        """Write the records and begin the next stretch."""
        self._task = task
        responses = sorted(self._responses_ns)
        info = TaskInfo(
            pid=os.getpid(),
            process=self._process,
            enabled=task.enabled,
            trigger=task.trigger,
            period_ms=task.period_s * 1e3,
            offset_ms=task.offset_s * 1e3,
            priority=task.priority,
            budget_ms=task.budget_s * 1e3,
            policy=standing,
            refused=refused,
            runs=self._runs,
            missed=self._missed,
            overruns=self._overruns,
            collections=self.collections,
            rate_hz=self._rate.of(now, self._runs),
            response_median_ms=responses[len(responses) // 2] / NS_PER_MS if responses else 0.0,
            response_max_ms=responses[-1] / NS_PER_MS if responses else 0.0,
            interval_mean_ms=_mean(self._intervals_ns) / NS_PER_MS,
            interval_sd_ms=_deviation(self._intervals_ns) / NS_PER_MS,
            note=self.note[:MAX_NOTE],
        )
        self._writer.write(info, now, now)
        self._timing.write(self._histograms.encode(), now, now)
        self._published, self._hurried = now, False
        self._responses_ns = []


def _mean(values: deque[int]) -> float:
    return sum(values) / len(values) if values else 0.0


def _deviation(values: deque[int]) -> float:
    mean = _mean(values)
    return math.sqrt(sum((value - mean) ** 2 for value in values) / len(values)) if values else 0.0
