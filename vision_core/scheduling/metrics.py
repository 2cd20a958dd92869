"""The metrics of a task: every run is measured, and the figures are written twice a second."""

import math
import os
from collections import deque

from vision_core.clock import NS_PER_MS, NS_PER_S, Instant
from vision_core.rtdb import records
from vision_core.rtdb.infos import TIMINGS, Refusal, Rehearsals, TaskInfo
from vision_core.rtdb.store import Store
from vision_core.rtdb.task import Task
from vision_core.scheduling.releases import Release, StepResult
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
        self.rehearsals: Rehearsals | None = None
        self.note = ""

    def count_run(self, release: Release, result: StepResult, done: Instant) -> None:
        """Count a run, from its release to its result."""
        due = release.due if result.due is None else result.due
        began = release.began if result.began is None else result.began
        self._runs += 1
        execution, response, budget_s = done - began, done - due, self._task.times.budget_s
        self._overruns += bool(budget_s) and execution > budget_s * NS_PER_S
        self._responses_ns.append(response)
        add = self._histograms.add
        add("lateness", began - due)
        add("execution", execution)
        add("response", response)
        if self._last_began is not None:
            add("interval", began - self._last_began)
            self._intervals_ns.append(began - self._last_began)
        self._last_began = began

    def count_missed(self, releases: int) -> None:
        """Count releases that passed without a run."""
        self._missed += releases

    def pause(self) -> None:
        """Note that the task was switched off: the time until its next run is no interval."""
        self._last_began = None
        self._rate.forget()

    def hurry(self) -> None:
        """Publish at the next call of ``publish_if_due``, however short the time since the last one."""
        self._hurried = True

    def publish_if_due(self, now: Instant, task: Task, policy: str, refusals: tuple[Refusal, ...]) -> None:
        """Write the records every half second. task: as it runs now."""
        if self._hurried or now - self._published >= PUBLISH_EVERY_NS:
            self.publish(now, task, policy, refusals)

    def publish(self, now: Instant, task: Task, policy: str, refusals: tuple[Refusal, ...]) -> None:
        """Write the records; the next ones have the responses from now on."""
        self._task = task
        responses = sorted(self._responses_ns)
        info = TaskInfo(
            pid=os.getpid(),
            process=self._process,
            trigger=task.trigger,
            times=task.times,
            policy=policy,
            refusals=refusals,
            runs=self._runs,
            missed=self._missed,
            overruns=self._overruns,
            collections=self.collections,
            rate_hz=self._rate.of(now, self._runs),
            response_median_ms=responses[len(responses) // 2] / NS_PER_MS if responses else 0.0,
            response_max_ms=responses[-1] / NS_PER_MS if responses else 0.0,
            interval_mean_ms=_mean(self._intervals_ns) / NS_PER_MS,
            interval_sd_ms=_deviation(self._intervals_ns) / NS_PER_MS,
            rehearsals=self.rehearsals,
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
