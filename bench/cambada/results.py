"""What was measured, as the paper's tables 1 and 3: ours, with the paper's figures as the twin."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from bench.cambada.activation_log import BEGAN, DONE, DUE, FOUND, IMAGE, Rows
from bench.cambada.paper import LOOPS, RATE_HZ, TASKS
from bench.runner import Row
from vision_core.clock import NS_PER_MS, NS_PER_S
from vision_core.geometry import Floats

NEAR_S = 0.1
"""A stall of the machine so long before a frame was missed still explains it."""
FRAME_MS = 1e3 / RATE_HZ

MachineStall = Callable[[float, float], bool]
"""Did the machine stand still between two instants [s of CLOCK_MONOTONIC]?"""


@dataclass(frozen=True, slots=True)
class Spread:
    """Of some durations [ms]."""

    max_ms: float
    min_ms: float
    mean_ms: float
    sd_ms: float


@dataclass(frozen=True, slots=True)
class Loop:
    """A run of the monolithic loop."""

    policy: str
    """That it has got."""
    runs: Rows
    ball: Rows
    """Of the ball's detector within."""


@dataclass(frozen=True, slots=True)
class Modular:
    """A run of the tasks."""

    tasks: dict[str, Rows]
    policies: dict[str, str]
    """That they have got, with the reason where it is not what was asked for."""
    stood_still: MachineStall


@dataclass(frozen=True, slots=True)
class Skipped:
    """Frames that a task of the frames' rate has not looked at, and releases without a run."""

    ours: int
    machine: int
    """The machine stood still just then."""
    releases: int


def intervals_ms(rows: Rows) -> Floats:
    """Between the beginnings of two runs."""
    intervals: Floats = np.diff(rows[:, BEGAN]) / NS_PER_MS
    return intervals


def execution_ms(rows: Rows) -> Floats:
    """From the beginning of a run to its end, whatever came in between."""
    times: Floats = (rows[:, DONE] - rows[:, BEGAN]) / NS_PER_MS
    return times


def spread_of(durations_ms: Floats) -> Spread:
    """Raises ValueError for none."""
    if not len(durations_ms):
        raise ValueError("the spread of no durations: the task has run less than twice")
    return Spread(*(float(measure(durations_ms)) for measure in (np.max, np.min, np.mean, np.std)))


def skipped_of(rows: Rows, period_ms: float, stood_still: MachineStall) -> Skipped:
    """What a task that should look at every frame has left out."""
    ours = machine = releases = 0
    for before, after in pairwise(rows.tolist()):
        frames = max(after[IMAGE] - before[IMAGE] - 1, 0)
        releases += max(round((after[DUE] - before[DUE]) / NS_PER_MS / period_ms) - 1, 0)
        if frames and stood_still(before[BEGAN] / NS_PER_S - NEAR_S, after[DONE] / NS_PER_S):
            machine += frames
        else:
            ours += frames
    return Skipped(ours, machine, releases)


def table_1(loop: Loop) -> Iterator[Row]:
    """Response times of the loop, beside those of the paper's two loops."""
    ours = spread_of(execution_ms(loop.runs))
    for name, paper in LOOPS.items():
        for key in ("max_ms", "min_ms", "mean_ms", "sd_ms"):
            word = f"table 1, one loop ({loop.policy}) beside {name}: response, {key[:-3]}"
            yield _beside(word, getattr(ours, key), getattr(paper, key))
    intervals = spread_of(intervals_ms(loop.runs))
    word = f"one loop ({loop.policy}): activation interval, "
    yield {"name": f"{word}max", "value": intervals.max_ms, "unit": "ms"}
    yield {"name": f"{word}sd", "value": intervals.sd_ms, "unit": "ms"}
    left_out = int(np.diff(loop.runs[:, IMAGE]).sum()) - (len(loop.runs) - 1)
    yield {"name": f"one loop ({loop.policy}): frames skipped, of {len(loop.runs) + left_out}", "value": left_out}


def table_3(modular: Modular) -> Iterator[Row]:
    """Intervals between activations of every task, beside the paper's, and what was skipped."""
    for name, paper in TASKS.items():
        rows = modular.tasks[name]
        ours = spread_of(intervals_ms(rows))
        word = f"table 3, {name}: interval, "
        yield _beside(f"{word}max", ours.max_ms, paper.max_ms)
        yield _beside(f"{word}min", ours.min_ms, paper.min_ms)
        goal = {"goal": f"< {paper.sd_ms:g} ms", "met": ours.sd_ms < paper.sd_ms}
        yield _beside(f"{word}sd", ours.sd_ms, paper.sd_ms) | goal
    for name, rows in modular.tasks.items():
        if TASKS[name].period_ms == FRAME_MS:
            yield from _skipped_rows(name, rows, modular.stood_still)


def told_of(modular: Modular) -> Iterator[Row]:
    """Policy, runs, execution time and how often the thing was there, for every task."""
    for name, rows in modular.tasks.items():
        times = spread_of(execution_ms(rows))
        found = f"found in {rows[:, FOUND].mean():.0%} of {len(rows)} runs"
        line = TASKS[name]
        when = f"every {line.period_ms:g} ms + {line.offset_ms:g}"
        yield {
            "name": f"{name}, {when}, {modular.policies[name]}, {found}: execution, mean",
            "value": times.mean_ms,
            "unit": "ms",
        }
        yield {"name": f"{name}: execution, max", "value": times.max_ms, "unit": "ms"}


def _skipped_rows(name: str, rows: Rows, stood_still: MachineStall) -> Iterator[Row]:
    skipped = skipped_of(rows, FRAME_MS, stood_still)
    goal = {"goal": "0", "met": skipped.ours == 0}
    yield {"name": f"{name}: frames skipped, our fault", "value": skipped.ours} | goal
    yield {"name": f"{name}: frames skipped, machine stood still", "value": skipped.machine}
    yield {"name": f"{name}: releases without a run", "value": skipped.releases}


def _beside(name: str, ours: float, paper: float) -> Row:
    return {"name": name, "value": ours, "unit": "ms", "twin": paper, "ratio": ours / paper}
