"""How regularly 50 ms tasks of the running service are activated, against C programs of the same period and priority.

Five tasks of five priorities run in the real service, each in a process of its own (``activation_task``). For each
there is a baseline in C (``baselines/activation.c``) of the same period and priority. Its offset lies 2 ms after that
of its task for a quarter of the run, then 4, 6 and 8 ms: what runs just before makes more difference than the language.
There are two kinds of baseline: one sleeps until the instant, as programs usually do; the other wakes a little earlier
and polls the clock until the instant, as the executive does (``scheduling.executive``).

Measured [us]: the standard deviation of the interval between two activations, over the central 99 % of all five tasks'
intervals. The remaining 1 % is excluded, as the paper's figures exclude it, and given apart. Where the machine stalls
more often than once in 200 activations, the 99 % describe the machine; the central 95 % do not. A ratio of 1 means that
the tasks are as regular as C; the goal is 1.2 against the sleeping baseline.

Three loads: *unloaded* (camera at 1 Hz, all slow trackers disabled); beside the vision as it runs normally, at higher
priorities; and the same with a busy process on each core. The camera's 29.97 Hz divide no period of 50 ms, so its
frames meet every phase of the tasks and of the baselines within half a minute.
"""

import contextlib
import json
import subprocess
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from bench.activation_task import FOLDER, activations_of
from bench.baselines.build import build_program
from bench.frame_path import policy_of
from bench.helpers import wait_with_progress
from bench.load import full_load
from bench.runner import Row
from bench.service import attached_service
from vision_core.clock import NS_PER_MS, NS_PER_S, NS_PER_US, MonotonicClock
from vision_core.geometry import Floats
from vision_core.net.control import Attached
from vision_core.rtdb import records
from vision_core.scheduling.executive import EARLY_NS

PERIOD_MS = 50
CENTRAL, INNER = 0.99, 0.95
"""Shares of all intervals whose standard deviations are given."""
GOAL_RATIO, GOAL_US = 1.2, 100.0
SLEEPING, POLLING = "C that sleeps until the instant", "C that wakes early and polls, as the executive"
SETTLE_S = 3.0
BASELINE_TIMEOUT_S = 10.0
BASELINES_AFTER_MS = (2, 4, 6, 8)
"""Offsets of the baselines after their tasks, in turn."""
CAMERA_HZ = 29.97


@dataclass(frozen=True, slots=True)
class PeriodicTask:
    """One of the measured tasks."""

    name: str
    priority: int
    offset_ms: int

    @property
    def setting(self) -> str:
        """Its line in the service's settings."""
        times = f"period_ms = {PERIOD_MS}.0, offset_ms = {self.offset_ms}.0, priority = {self.priority}"
        return f'{self.name} = {{ module = "bench.activation_task", {times}, budget_ms = 1.0 }}'


TASKS = tuple(
    PeriodicTask(f"bench{priority}", priority, offset_ms)
    for priority, offset_ms in ((30, 31), (31, 41), (32, 1), (33, 11), (34, 21))
)
"""The service's boundary task, of priority 30 too, begins 13 ms into every other period and meets none of these."""
TRACKERS_OFF = [
    f"{name} = {{ enabled = false }}"
    for name in ("obstacles", "boundary", "lines", "exposure", "colors", "diagnose", "overlay")
]


def settings_of(rate_hz: float, *lines: str) -> str:
    """Settings of a service with the measured tasks and a camera of a rate. lines: further lines of its task table."""
    return "\n".join([f"camera.rate_hz = {rate_hz}", "[tasks]", *(task.setting for task in TASKS), *lines])


@dataclass(frozen=True, slots=True)
class Regularity:
    """Statistics of the intervals between activations, over all tasks."""

    intervals: int
    deviation_us: float
    """Standard deviation of the central 99 %."""
    inner_deviation_us: float
    """Standard deviation of the central 95 %."""
    excluded: int
    """Intervals outside the central 99 %."""
    worst_us: float
    """Largest difference of an interval from the period."""
    skipped: int
    """Releases without an activation."""


def regularity_of(activations: list[Floats]) -> Regularity:
    """Statistics of the instants of activation; one array [ns] for each task."""
    intervals = np.concatenate([np.diff(instants) for instants in activations]) / NS_PER_US
    period_us = PERIOD_MS * NS_PER_MS / NS_PER_US
    central, inner = _central(intervals, CENTRAL), _central(intervals, INNER)
    skipped = np.round(intervals / period_us) - 1.0
    return Regularity(
        intervals=len(intervals),
        deviation_us=float(central.std()),
        inner_deviation_us=float(inner.std()),
        excluded=len(intervals) - len(central),
        worst_us=float(np.abs(intervals - period_us).max()),
        skipped=int(skipped.clip(0.0).sum()),
    )


def _central(values: Floats, share: float) -> Floats:
    """The central share of all values, ascending."""
    beyond = round(len(values) * (1.0 - share) / 2.0)
    return np.sort(values)[beyond : len(values) - beyond]


def run(seconds: float = 60.0) -> list[Row]:
    """All three loads. seconds: how long each lasts with each kind of baseline."""
    program, message = build_program("activation")
    rows: list[Row] = [] if program else [{"name": message}]
    with _service(settings_of(1.0, *TRACKERS_OFF)) as (attached, folder):
        rows += _measure(attached, folder, program, seconds, "unloaded", GOAL_US)
    with _service(settings_of(CAMERA_HZ)) as (attached, folder):
        rows += _measure(attached, folder, program, seconds, "beside the vision", None)
        with full_load() as load:
            name = f"beside the vision, a busy process on each of {len(load.processes)} cores"
            rows += _measure(attached, folder, program, seconds, name, None)
        rows += _policy_rows(attached)
    return rows


@contextlib.contextmanager
def _service(settings: str) -> Iterator[tuple[Attached, Path]]:
    """A service that has settled, and the folder in which the measured tasks record their activations."""
    with (
        tempfile.TemporaryDirectory(prefix="pslv-bench-") as folder,
        attached_service(settings, variables={FOLDER: folder}) as (_, attached),
    ):
        wait_with_progress(SETTLE_S, "activation: settling")
        yield attached, Path(folder)


def _measure(
    attached: Attached, folder: Path, program: Path | None, seconds: float, load: str, goal_us: float | None
) -> list[Row]:
    """Tasks and baselines over the same stretches of time, one for each offset and kind of baseline."""
    tasks: dict[str, list[Floats]] = {SLEEPING: [], POLLING: []}
    baselines: dict[str, list[Floats]] = {SLEEPING: [], POLLING: []}
    policies: set[str] = set()
    for after_ms in BASELINES_AFTER_MS:
        for kind in tasks:
            duration_s = seconds / len(BASELINES_AFTER_MS)
            start, end, reports = _stretch(attached, program, duration_s, load, after_ms, kind)
            activations = [activations_of(folder / task.name).astype(np.float64) for task in TASKS]
            wakes = [np.array(report["wakes_ns"], dtype=np.float64) for report in reports]
            tasks[kind] += [_within(instants, start, end) for instants in activations]
            baselines[kind] += [_within(instants, start, end) for instants in wakes]
            policies |= {f"{report['policy']}, {_refusal(report)}" for report in reports}
    sleeping = regularity_of(baselines[SLEEPING]) if program else None
    rows = _rows(load, regularity_of(tasks[SLEEPING]), sleeping, goal_us)
    if program:
        name = f"{load}, {POLLING}"
        rows.append(_deviation_row(name, regularity_of(tasks[POLLING]), regularity_of(baselines[POLLING])))
    return [*rows, *({"name": f"{load}: baselines in C run under {policy}"} for policy in sorted(policies))]


def _stretch(
    attached: Attached, program: Path | None, seconds: float, load: str, after_ms: int, kind: str
) -> tuple[int, int, list[dict[str, Any]]]:
    """Run all baselines of one kind. Returns start and end [ns of CLOCK_MONOTONIC] and the baselines' reports."""
    early_ns = EARLY_NS if kind == POLLING else 0
    with contextlib.ExitStack() as stack:
        baselines = []
        for task in TASKS if program is not None else ():
            offset_ms = task.offset_ms + after_ms
            baselines.append(_baseline(program, task.priority, attached.boot, offset_ms, seconds, early_ns))
            stack.callback(_kill, baselines[-1])
        start = MonotonicClock().now()
        wait_with_progress(seconds, f"activation, {load}, {kind}")
        end = MonotonicClock().now()
        outputs = [baseline.communicate(timeout=BASELINE_TIMEOUT_S)[0] for baseline in baselines]
        return start, end, [json.loads(output) for output in outputs]


def _baseline(
    program: Path | None, priority: int, boot: int, offset_ms: int, seconds: float, early_ns: int
) -> "subprocess.Popen[str]":
    """Start a baseline. Its grid begins at an offset from the start of the service, as the tasks' grids do."""
    period, now = PERIOD_MS * NS_PER_MS, MonotonicClock().now()
    origin = boot + offset_ms * NS_PER_MS
    first = origin + ((now - origin) // period + 2) * period
    count = round(seconds * NS_PER_S / period)
    command = [str(argument) for argument in (program, period, count, priority, first, early_ns)]
    return subprocess.Popen(command, stdout=subprocess.PIPE, text=True)


def _kill(process: "subprocess.Popen[str]") -> None:
    process.kill()
    process.wait()


def _within(instants: Floats, start: int, end: int) -> Floats:
    return instants[(instants >= start) & (instants <= end)]


def _rows(load: str, tasks: Regularity, baseline: Regularity | None, goal_us: float | None) -> list[Row]:
    """Tasks and sleeping baselines, side by side."""

    def row(name: str, key: str, unit: str) -> Row:
        value, beside = getattr(tasks, key), getattr(baseline, key, None)
        return {"name": f"{load}: {name}", "value": value, "unit": unit, "baseline": beside}

    deviation = _deviation_row(f"{load}, {SLEEPING}", tasks, baseline)
    if "ratio" in deviation:
        deviation |= {"goal": f"<= {GOAL_RATIO}x", "met": deviation["ratio"] <= GOAL_RATIO}
    rows = [deviation]
    if goal_us is not None:
        goal = {"goal": f"<= {goal_us:g} us", "met": tasks.deviation_us <= goal_us}
        rows.append(row("the same without a baseline", "deviation_us", "us") | {"baseline": None} | goal)
    return [
        *rows,
        row(f"standard deviation of the central {INNER * 100:g} %", "inner_deviation_us", "us"),
        row("intervals", "intervals", ""),
        row("intervals excluded", "excluded", ""),
        row("largest difference of an interval from the period", "worst_us", "us"),
        row("releases without an activation", "skipped", ""),
    ]


def _deviation_row(name: str, tasks: Regularity, baseline: Regularity | None) -> Row:
    row: Row = {"name": f"{name}: standard deviation of the central {CENTRAL * 100:g} %", "unit": "us"}
    row |= {"value": tasks.deviation_us}
    if baseline is None:
        return row
    return row | {"baseline": baseline.deviation_us, "ratio": tasks.deviation_us / max(baseline.deviation_us, 1e-9)}


def _refusal(report: dict[str, Any]) -> str:
    return f"{report['refused']} refused" if report["refused"] else "memory locked"


def _policy_rows(attached: Attached) -> list[Row]:
    """The scheduling policy of each measured task, and the camera's rate."""
    rows: list[Row] = []
    now = MonotonicClock().now()
    for task in TASKS:
        info = records.task(task.name).reader(attached.store).value(now)
        rows.append({"name": f"{task.name}, every {PERIOD_MS} ms + {task.offset_ms}: {policy_of(info)}"})
    return [*rows, {"name": f"beside the vision: a camera of {CAMERA_HZ} Hz"}]
