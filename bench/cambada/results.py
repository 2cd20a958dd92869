"""The measurements as the paper's tables 1 and 3, with the paper's figures as the baseline."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from bench.cambada.activation_log import BEGAN, DONE, DUE, FOUND, IMAGE, Rows
from bench.cambada.paper import LOOPS, RATE_HZ, TASKS
from bench.runner import Row
from vision_core.clock import NS_PER_MS, NS_PER_S
from vision_core.geometry import Floats

BEFORE_FRAME_S = 0.1
"""A stall of the machine that ended so long before a skipped frame still explains it."""
FRAME_MS = 1e3 / RATE_HZ

HasStalled = Callable[[float, float], bool]
"""Did the machine stall between two instants [s of CLOCK_MONOTONIC]?"""


@dataclass(frozen=True, slots=True)
class Spread:
    """Statistics of durations [ms]."""

    max_ms: float
    min_ms: float
    mean_ms: float
    sd_ms: float


@dataclass(frozen=True, slots=True)
class Loop:
    """A run of the monolithic loop."""

    policy: str
    """Scheduling policy that was granted."""
    runs: Rows
    ball: Rows
    """Runs of the ball's detector within the loop."""


@dataclass(frozen=True, slots=True)
class Modular:
    """A run of the tasks."""

    tasks: dict[str, Rows]
    policies: dict[str, str]
    """Scheduling policies that were granted, with the reason where one is not the requested policy."""
    has_stalled: HasStalled


@dataclass(frozen=True, slots=True)
class Skipped:
    """What a task that runs for every frame has skipped."""

    by_task: int
    """Frames."""
    by_machine: int
    """Frames that were skipped while the machine stalled."""
    undelivered: int
    """Periods in which the camera delivered no frame."""


def intervals_ms(rows: Rows) -> Floats:
    """Intervals between the beginnings of two runs [ms], shape (n - 1,)."""
    intervals: Floats = np.diff(rows[:, BEGAN]) / NS_PER_MS
    return intervals


def execution_ms(rows: Rows) -> Floats:
    """From the beginning of each run to its end, preemption included [ms], shape (n,)."""
    times: Floats = (rows[:, DONE] - rows[:, BEGAN]) / NS_PER_MS
    return times


def spread_of(durations_ms: Floats) -> Spread:
    """Statistics of durations, shape (n,) [ms]. Raises ValueError without any."""
    if not len(durations_ms):
        raise ValueError("spread_of: no durations were found; a task that has run at least twice was expected")
    return Spread(*(float(measure(durations_ms)) for measure in (np.max, np.min, np.mean, np.std)))


def skipped_of(rows: Rows, period_ms: float, has_stalled: HasStalled) -> Skipped:
    """Count what a task that runs for every frame has skipped."""
    by_task = by_machine = undelivered = 0
    for before, after in pairwise(rows.tolist()):
        frames = max(after[IMAGE] - before[IMAGE] - 1, 0)
        undelivered += max(round((after[DUE] - before[DUE]) / NS_PER_MS / period_ms) - 1 - frames, 0)
        if frames and has_stalled(before[BEGAN] / NS_PER_S - BEFORE_FRAME_S, after[DONE] / NS_PER_S):
            by_machine += frames
        else:
            by_task += frames
    return Skipped(by_task, by_machine, undelivered)


def table_1(loop: Loop) -> Iterator[Row]:
    """Table 1: response times of the loop; baseline: the paper's two loops."""
    ours = spread_of(execution_ms(loop.runs))
    for name, paper in LOOPS.items():
        for key in ("max_ms", "min_ms", "mean_ms", "sd_ms"):
            label = f"table 1, one loop ({loop.policy}) beside {name}: response, {key[:-3]}"
            yield _beside(label, getattr(ours, key), getattr(paper, key))
    intervals = spread_of(intervals_ms(loop.runs))
    label = f"one loop ({loop.policy}): activation interval, "
    yield {"name": f"{label}max", "value": intervals.max_ms, "unit": "ms"}
    yield {"name": f"{label}sd", "value": intervals.sd_ms, "unit": "ms"}
    skipped = int(np.diff(loop.runs[:, IMAGE]).sum()) - (len(loop.runs) - 1)
    yield {"name": f"one loop ({loop.policy}): frames skipped, of {len(loop.runs) + skipped}", "value": skipped}


def table_3(modular: Modular) -> Iterator[Row]:
    """Table 3: intervals between activations of every task; baseline: the paper's. Then what was skipped."""
    for name, paper in TASKS.items():
        rows = modular.tasks[name]
        ours = spread_of(intervals_ms(rows))
        label = f"table 3, {name}: interval, "
        yield _beside(f"{label}max", ours.max_ms, paper.max_ms)
        yield _beside(f"{label}min", ours.min_ms, paper.min_ms)
        goal = {"goal": f"< {paper.sd_ms:g} ms", "met": ours.sd_ms < paper.sd_ms}
        yield _beside(f"{label}sd", ours.sd_ms, paper.sd_ms) | goal
    for name, rows in modular.tasks.items():
        if TASKS[name].period_ms == FRAME_MS:
            yield from _skipped_rows(name, rows, modular.has_stalled)


def execution_rows(modular: Modular) -> Iterator[Row]:
    """For every task: policy, number of runs, how often its object was found, and execution time."""
    for name, rows in modular.tasks.items():
        times = spread_of(execution_ms(rows))
        found = f"found in {rows[:, FOUND].mean():.0%} of {len(rows)} runs"
        timing = TASKS[name]
        when = f"every {timing.period_ms:g} ms + {timing.offset_ms:g}"
        yield {
            "name": f"{name}, {when}, {modular.policies[name]}, {found}: execution, mean",
            "value": times.mean_ms,
            "unit": "ms",
        }
        yield {"name": f"{name}: execution, max", "value": times.max_ms, "unit": "ms"}


def _skipped_rows(name: str, rows: Rows, has_stalled: HasStalled) -> Iterator[Row]:
    skipped = skipped_of(rows, FRAME_MS, has_stalled)
    goal = {"goal": "0", "met": skipped.by_task == 0}
    yield {"name": f"{name}: frames skipped by the task", "value": skipped.by_task} | goal
    yield {"name": f"{name}: frames skipped while the machine stalled", "value": skipped.by_machine}
    yield {"name": f"{name}: periods in which the camera delivered no frame", "value": skipped.undelivered}


def _beside(name: str, ours: float, paper: float) -> Row:
    return {"name": name, "value": ours, "unit": "ms", "baseline": paper, "ratio": ours / paper}
