"""Activation of tasks of 50 ms: ours in the running service, and a program in C for each of them in the same run.

Five tasks of five priorities run in processes of their own in the real service. For each there is a baseline in C
(``baselines/activation.c``) of the same period and priority, between two of ours in time: 2 ms after its task for a
quarter of the run, then 4, 6 and 8 ms, since neighbors in time make more difference than the language. It sleeps until
the instant; ours wakes a little earlier and reads the clock until the instant comes (``scheduling.executive``), so a
second baseline that does the same in C is measured as well, apart.

Unloaded means that the vision rests: a camera of 1 Hz, all slow trackers switched off. Then it works as always, at
higher priorities, alone and with a busy process on each core: the camera's 29.97 Hz fit into no period, so that its
frames pass through all of them, ours and the baselines', within half a minute. What counts is the interval between
two activations, as each program reads the clock itself: the standard deviation of the central 99 %, over all tasks
together. The rest is excluded, as far as the paper's figures go, and told apart. Where the machine stands still more
often than once in 200 activations, those 99 % tell of the machine; the central 95 % do not."""

import contextlib
import json
import subprocess
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from bench.activation_task import FOLDER, begins_of
from bench.baselines.build import build_program
from bench.frame_path import policy_of
from bench.helpers import sit_out
from bench.load import full_load
from bench.runner import Row
from bench.service import configured, running_service
from vision_core.clock import NS_PER_MS, NS_PER_S, MonotonicClock
from vision_core.geometry import Floats
from vision_core.net.control import Attached, attach_to
from vision_core.rtdb import records
from vision_core.scheduling.executive import EARLY_NS

PERIOD_MS = 50
CENTRAL, USUAL = 0.99, 0.95
GOAL_RATIO, GOAL_US = 1.2, 100.0
SLEEPER, EARLY = "C that sleeps until the instant", "C that wakes as early as ours"
SETTLE_S = 3.0
BASELINE_PATIENCE_S = 10.0
BASELINES_AFTER_MS = (2, 4, 6, 8)
CAMERA_HZ = 29.97
NS_PER_US = 1000


@dataclass(frozen=True, slots=True)
class Timed:
    """One of our tasks."""

    name: str
    priority: int
    offset_ms: int

    @property
    def setting(self) -> str:
        """Its line of the service's settings."""
        times = f"period_ms = {PERIOD_MS}.0, offset_ms = {self.offset_ms}.0, priority = {self.priority}"
        return f'{self.name} = {{ module = "bench.activation_task", {times}, budget_ms = 1.0 }}'


TASKS = tuple(
    Timed(f"bench{priority}", priority, offset_ms)
    for priority, offset_ms in ((30, 31), (31, 41), (32, 1), (33, 11), (34, 21))
)
"""Boundary, of priority 30 as well, begins 13 ms into every other of these periods: none of ours meets it as a peer."""
RESTING = [
    f"{name} = {{ enabled = false }}" for name in ("obstacles", "boundary", "lines", "exposure", "colors", "diagnose")
]


def settings_of(rate_hz: float, *lines: str) -> str:
    """A service with our tasks beside a camera of a rate; lines: what else is changed of its task table."""
    return "\n".join([f"camera.rate_hz = {rate_hz}", "[tasks]", *(task.setting for task in TASKS), *lines])


@dataclass(frozen=True, slots=True)
class Regularity:
    """The intervals between activations, of one or several tasks together."""

    intervals: int
    deviation_us: float
    """Standard deviation of the central ones."""
    usual_us: float
    """The same of those that are called usual."""
    excluded: int
    worst_us: float
    """How far the worst of the excluded is from the period."""
    skipped: int
    """Releases without a run."""


def regularity_of(activations: list[Floats]) -> Regularity:
    """What the instants of activations tell [ns]; one array for each task, each over the same stretch of time."""
    intervals = np.concatenate([np.diff(instants) for instants in activations]) / NS_PER_US
    away = np.sort(np.abs(intervals - PERIOD_MS * NS_PER_MS / NS_PER_US))
    central, usual = _central(intervals, CENTRAL), _central(intervals, USUAL)
    skipped = np.round(intervals / (PERIOD_MS * NS_PER_MS / NS_PER_US)) - 1.0
    return Regularity(
        intervals=len(intervals),
        deviation_us=float(central.std()),
        usual_us=float(usual.std()),
        excluded=len(intervals) - len(central),
        worst_us=float(away[-1]),
        skipped=int(skipped.clip(0.0).sum()),
    )


def _central(values: Floats, part: float) -> Floats:
    """So much of all values, those in the middle, ascending."""
    beyond = round(len(values) * (1.0 - part) / 2.0)
    return np.sort(values)[beyond : len(values) - beyond]


def run(seconds: float = 60.0) -> list[Row]:
    """Without load, beside the vision, and with load beside it; seconds: how long each lasts, with either baseline."""
    program, word = build_program("activation")
    rows: list[Row] = [] if program else [{"name": word}]
    with _service(settings_of(1.0, *RESTING)) as (attached, folder):
        rows += _measure(attached, folder, program, seconds, "unloaded", GOAL_US)
    with _service(settings_of(CAMERA_HZ)) as (attached, folder):
        rows += _measure(attached, folder, program, seconds, "beside the vision", None)
        with full_load() as load:
            name = f"beside the vision, a busy process on each of {len(load.processes)} cores"
            rows += _measure(attached, folder, program, seconds, name, None)
        rows += _policies(attached)
    return rows


@contextlib.contextmanager
def _service(settings: str) -> Iterator[tuple[Attached, Path]]:
    """A service that has settled, and the folder in which our tasks note when they began."""
    with contextlib.ExitStack() as stack:
        folder = Path(stack.enter_context(tempfile.TemporaryDirectory(prefix="pslv-bench-")))
        path = stack.enter_context(configured(settings))
        service = stack.enter_context(running_service("--config", path, variables={FOLDER: str(folder)}))
        attached = attach_to(service.control)
        stack.callback(attached.close)
        sit_out(SETTLE_S, "activation: settling")
        yield attached, folder


def _measure(
    attached: Attached, folder: Path, program: Path | None, seconds: float, load: str, goal_us: float | None
) -> list[Row]:
    """Ours and the baselines over the same time, once for each place of the baselines among ours."""
    ours: dict[str, list[Floats]] = {SLEEPER: [], EARLY: []}
    theirs: dict[str, list[Floats]] = {SLEEPER: [], EARLY: []}
    said: set[str] = set()
    for after_ms in BASELINES_AFTER_MS:
        for kind in ours:
            start, end, reports = _stretch(attached, program, seconds / len(BASELINES_AFTER_MS), load, after_ms, kind)
            ours[kind] += [_within(begins_of(folder / task.name).astype(np.float64), start, end) for task in TASKS]
            theirs[kind] += [_within(np.array(report["wakes_ns"], dtype=np.float64), start, end) for report in reports]
            said |= {f"{report['policy']}, {_refusal(report)}" for report in reports}
    rows = _rows(load, regularity_of(ours[SLEEPER]), regularity_of(theirs[SLEEPER]) if program else None, goal_us)
    if program:
        rows.append(_deviation_row(f"{load}, {EARLY}", regularity_of(ours[EARLY]), regularity_of(theirs[EARLY])))
    return [*rows, *({"name": f"{load}: baselines in C run under {words}"} for words in sorted(said))]


def _stretch(
    attached: Attached, program: Path | None, seconds: float, load: str, after_ms: int, kind: str
) -> tuple[int, int, list[dict[str, Any]]]:
    """When it began and ended [ns of CLOCK_MONOTONIC], and what the baselines of all tasks report."""
    early_ns = EARLY_NS if kind == EARLY else 0
    with contextlib.ExitStack() as stack:
        baselines = []
        for task in TASKS if program is not None else ():
            baselines.append(
                _baseline(program, task.priority, attached.boot, task.offset_ms + after_ms, seconds, early_ns)
            )
            stack.callback(_end, baselines[-1])
        start = MonotonicClock().now()
        sit_out(seconds, f"activation, {load}, {kind}")
        end = MonotonicClock().now()
        return start, end, [json.loads(baseline.communicate(timeout=BASELINE_PATIENCE_S)[0]) for baseline in baselines]


def _baseline(
    program: Path | None, priority: int, boot: int, offset_ms: int, seconds: float, early_ns: int
) -> "subprocess.Popen[str]":
    """A baseline whose grid begins at an offset from the start of the service, as our tasks' grids do."""
    period, now = PERIOD_MS * NS_PER_MS, MonotonicClock().now()
    origin = boot + offset_ms * NS_PER_MS
    first = origin + ((now - origin) // period + 2) * period
    count = round(seconds * NS_PER_S / period)
    command = [str(word) for word in (program, period, count, priority, first, early_ns)]
    return subprocess.Popen(command, stdout=subprocess.PIPE, text=True)


def _end(baseline: "subprocess.Popen[str]") -> None:
    baseline.kill()
    baseline.wait()


def _within(instants: Floats, start: int, end: int) -> Floats:
    return instants[(instants >= start) & (instants <= end)]


def _rows(load: str, ours: Regularity, baseline: Regularity | None, goal_us: float | None) -> list[Row]:
    """Ours and the baselines', side by side."""

    def row(name: str, key: str, unit: str) -> Row:
        return {
            "name": f"{load}: {name}",
            "value": getattr(ours, key),
            "unit": unit,
            "twin": getattr(baseline, key, None),
        }

    deviation = _deviation_row(f"{load}, {SLEEPER}", ours, baseline)
    if "ratio" in deviation:
        deviation |= {"goal": f"<= {GOAL_RATIO}x", "met": deviation["ratio"] <= GOAL_RATIO}
    rows = [deviation]
    if goal_us is not None:
        goal = {"goal": f"<= {goal_us:g} us", "met": ours.deviation_us <= goal_us}
        rows.append(row("the same, by itself", "deviation_us", "us") | {"twin": None} | goal)
    return [
        *rows,
        row(f"standard deviation of the central {USUAL * 100:g} %", "usual_us", "us"),
        row("intervals", "intervals", ""),
        row("activations excluded", "excluded", ""),
        row("worst of the excluded, off the period by", "worst_us", "us"),
        row("releases without a run", "skipped", ""),
    ]


def _deviation_row(beside: str, ours: Regularity, baseline: Regularity | None) -> Row:
    row: Row = {"name": f"{beside}: standard deviation of the central {CENTRAL * 100:g} %", "unit": "us"}
    row |= {"value": ours.deviation_us}
    if baseline is None:
        return row
    return row | {"twin": baseline.deviation_us, "ratio": ours.deviation_us / max(baseline.deviation_us, 1e-9)}


def _refusal(report: dict[str, Any]) -> str:
    return f"{report['refused']} refused" if report["refused"] else "memory locked"


def _policies(attached: Attached) -> list[Row]:
    """What the service says of our tasks, and of the camera."""
    rows: list[Row] = []
    now = MonotonicClock().now()
    for task in TASKS:
        info = records.task(task.name).reader(attached.store).value(now)
        rows.append({"name": f"{task.name}, every {PERIOD_MS} ms + {task.offset_ms}: {policy_of(info)}"})
    return [*rows, {"name": f"beside the vision at a camera of {CAMERA_HZ} Hz"}]
