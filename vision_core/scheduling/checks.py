"""Is a table of tasks sound? One writer per record, no missing input, no cycle, and rates that add up."""

import math
import os
from collections import defaultdict
from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations

from vision_core.clock import MS_PER_S
from vision_core.rtdb.task import DRIVER, HIGHEST_PRIORITY, NONE, PERIOD, Task

MIN_PERIOD_S = 0.001
MAX_SHARE = 0.95
"""Share of a core that the kernel gives to real-time tasks together."""


@dataclass(frozen=True, slots=True)
class TableProblem:
    """What is wrong with one line of the table."""

    key: str
    """The setting at fault, "tasks.obstacles.period_ms"."""
    found: str
    accepted: str


def problems(tasks: Sequence[Task], given: Collection[str], camera_rate_hz: float) -> list[TableProblem]:
    """Everything that is wrong with a task table. given: names of records that no task of the table writes."""
    return [
        *_writers(tasks, given),
        *_inputs(tasks, given),
        *_cycles(tasks),
        *rate_problems(tasks, camera_rate_hz),
    ]


def warnings(tasks: Sequence[Task]) -> list[str]:
    """What is allowed, but probably not intended."""
    found = []
    periodic = [task for task in tasks if task.trigger == PERIOD and task.times.enabled]
    for one, other in combinations(periodic, 2):
        same_times = (one.times.priority, one.times.offset_ms) == (other.times.priority, other.times.offset_ms)
        if same_times and one.process != other.process:
            found.append(
                f"{one.name} and {other.name} have equal priority ({one.times.priority}) and offset "
                f"({one.times.offset_ms:g} ms): they swap places and give each other jitter"
            )
    return found


def load(tasks: Sequence[Task], camera_rate_hz: float) -> float:
    """Cores that the budgets of all real-time tasks fill at their rates."""
    return sum(
        task.times.budget_s * task.rate_hz(camera_rate_hz)
        for task in tasks
        if task.times.enabled and task.times.priority and task.times.budget_s
    )


def _writers(tasks: Sequence[Task], given: Collection[str]) -> Iterator[TableProblem]:
    writers = dict.fromkeys(given, "the service itself")
    for task in tasks:
        for record in task.writes:
            if record in writers:
                yield TableProblem(
                    f"tasks.{task.name}.writes", f"{record}, which {writers[record]} writes", "one writer for a record"
                )
            writers.setdefault(record, task.name)


def _inputs(tasks: Sequence[Task], given: Collection[str]) -> Iterator[TableProblem]:
    written = {*given, *(record for task in tasks for record in task.writes)}
    known = f"a record that is written: {', '.join(sorted(written))}"
    for task in tasks:
        for record in task.reads:
            if record not in written:
                yield TableProblem(f"tasks.{task.name}.reads", f"{record}, which no task writes", known)
        if task.trigger not in (DRIVER, PERIOD, NONE) and task.trigger not in task.reads:
            yield TableProblem(
                f"tasks.{task.name}.trigger",
                f"{task.trigger}, which it does not read",
                f"{PERIOD}, or a record of its reads: {', '.join(task.reads) or 'it has none'}",
            )


def _cycles(tasks: Sequence[Task]) -> Iterator[TableProblem]:
    by_record = {record: task for task in tasks for record in task.writes}
    for task in tasks:
        path, at = [task.name], by_record.get(task.trigger)
        while at is not None and at.name not in path:
            path.append(at.name)
            at = by_record.get(at.trigger)
        if at is not None and at.name == task.name:
            yield TableProblem(
                f"tasks.{task.name}.trigger",
                f"a cycle: {' <- '.join([*path, task.name])}",
                "a chain that begins with a camera or a period",
            )


def rate_problems(tasks: Sequence[Task], camera_rate_hz: float) -> Iterator[TableProblem]:
    """Problems of periods, budgets, priorities and processes: those that a change at run time can cause, too."""
    for task in tasks:
        yield from _rate(task, camera_rate_hz)
        if task.trigger in (DRIVER, NONE) and any(other.process == task.process for other in tasks if other != task):
            found = f"{task.process}, with others in it"
            yield TableProblem(f"tasks.{task.name}.process", found, "a process of its own: it waits for its device")
    shared: dict[str, float] = defaultdict(float)
    for task in tasks:
        if task.times.enabled and task.trigger != NONE:
            shared[task.process] += task.times.budget_s * task.rate_hz(camera_rate_hz)
    for process, share in shared.items():
        if share > 1.0:
            named = next(task.name for task in tasks if task.process == process)
            yield TableProblem(
                f"tasks.{named}.budget_ms",
                f"budgets that fill {share:.2f} cores in process {process}",
                "one core at most",
            )
    cores, needed = len(os.sched_getaffinity(0)), load(tasks, camera_rate_hz)
    if needed > MAX_SHARE * cores:
        heaviest = max(
            tasks, key=lambda task: task.times.budget_s * task.rate_hz(camera_rate_hz) if task.times.priority else 0.0
        )
        yield TableProblem(
            f"tasks.{heaviest.name}.budget_ms",
            f"budgets of real-time tasks that fill {needed:.2f} cores at a camera of {camera_rate_hz:g} Hz",
            f"{MAX_SHARE * cores:.2f} of the {cores} there are: longer periods, smaller budgets, or priority 0",
        )


def _rate(task: Task, camera_rate_hz: float) -> Iterator[TableProblem]:
    key, times = f"tasks.{task.name}", task.times
    if not all(math.isfinite(value) and value >= 0.0 for value in (times.period_ms, times.offset_ms, times.budget_ms)):
        yield TableProblem(f"{key}.period_ms", "a time that is no number or negative", "milliseconds, 0 or more")
        return
    if task.trigger == PERIOD and not times.period_ms:
        yield TableProblem(f"{key}.period_ms", "0", "a period: nothing else releases it")
        return
    if task.own_loop and (times.priority or times.cores or times.period_ms):
        yield TableProblem(f"{key}.priority", "a priority, a period or cores", "none of them: it has a loop of its own")
        return
    if 0.0 < times.period_s < MIN_PERIOD_S:
        yield TableProblem(f"{key}.period_ms", f"{times.period_ms:g}: an impossible rate", "1 ms or more")
        return
    if task.trigger == DRIVER and times.period_ms:
        yield TableProblem(f"{key}.period_ms", f"{times.period_ms:g}", "0: only its driver releases it")
    if times.period_ms and times.offset_ms >= times.period_ms:
        found = f"{times.offset_ms:g} at a period of {times.period_ms:g} ms"
        yield TableProblem(f"{key}.offset_ms", found, "less than the period")
    between_s = 1.0 / task.rate_hz(camera_rate_hz)
    if not task.own_loop and times.budget_s > between_s:
        found = f"{times.budget_ms:g} for what comes every {between_s * MS_PER_S:g} ms: an impossible rate"
        yield TableProblem(f"{key}.budget_ms", found, "at most the time between two releases")
    if times.budget_s > task.max_run_s:
        limit = f"at most {task.max_run_s * MS_PER_S:g}: a longer run is taken for hung"
        yield TableProblem(f"{key}.budget_ms", f"{times.budget_ms:g}", limit)
    if not 0 <= times.priority <= HIGHEST_PRIORITY:
        yield TableProblem(f"{key}.priority", f"{times.priority}", f"0 (ordinary) to {HIGHEST_PRIORITY}")
