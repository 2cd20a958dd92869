"""Latency from a published frame to the last client, in the running service, with rehearsals and without, in turns.

Setup: the service shows a folder of pictures to connected clients, at 30 Hz with 22 and with 10 robots, and at 200 Hz.
The latency [ms] of a frame begins when capture publishes it (timestamp in the database, read by ``record_timestamps``)
and ends when the kernel has put the last of its datagrams into a client's socket (``receiver``). Median and p99 are
given, and their goals. Blocks of BLOCK_S in which ``perceive`` and ``serve`` rehearse alternate with blocks in which
they do not: the live setting ``tasks.NAME.rehearse`` is changed. The first part of a block does not count.

Baselines: the same service in the blocks without rehearsals; and in C (``baselines/handover.c``) four processes that
hand a frame's number on in the same way. One of these does no work, so its latency is what the kernel needs. The other
computes for as long as perceive and serve do without rehearsals, less the time that sending takes in C. They run after
the service, for as long. At last ``perceive`` and ``serve`` run in one process (docs/decisions/0019); its baseline is
the service with two.
"""

import contextlib
import json
import subprocess
import time
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from bench.baselines.build import build_program
from bench.frame_path import FRAME_PATH, FRAMES, histograms_of, policies_of, quantile_us, workers_of
from bench.helpers import Helper, Report, wait_with_progress, with_progress
from bench.load import full_load
from bench.pictures import match_service
from bench.record_timestamps import Timestamps
from bench.runner import Row
from bench.service import RunningService
from vision_core.clock import NS_PER_US, US_PER_MS, MonotonicClock
from vision_core.geometry import Floats
from vision_core.net.control import Attached
from vision_core.rtdb import records
from vision_core.timing.histogram import Counts

BLOCK_S, IGNORED_S = 5.0, 1.0
SETTLE_S = 2.0
QUANTILES = (("median", 0.5), ("p99", 0.99))
ONE_PROCESS = """
[tasks.perceive]
process = "perceive"
[tasks.serve]
process = "perceive"
priority = 45
"""
"""Settings with which ``serve`` shares the process of ``perceive``."""


class Case(NamedTuple):
    """What is measured."""

    rate_hz: float
    per_team: int
    goals_ms: tuple[float | None, float | None]
    """Of QUANTILES."""
    is_busy: bool = False
    """All cores are."""

    @property
    def name(self) -> str:
        busy = ", all cores busy" if self.is_busy else ""
        return f"{self.rate_hz:g} Hz, {2 * self.per_team} robots and clients{busy}"


CASES = (
    Case(30.0, 11, (0.8, 1.2)),
    Case(30.0, 5, (0.45, None)),
    Case(200.0, 11, (0.6, None)),
    Case(30.0, 11, (None, None), is_busy=True),
)


@dataclass(frozen=True, slots=True)
class Block:
    """For so long the tasks rehearsed, or not [ns of CLOCK_MONOTONIC]."""

    rehearses: bool
    began: int
    ended: int
    late: dict[str, Counts]
    """How late runs began, by task: a histogram."""


@dataclass(frozen=True, slots=True)
class Handover:
    """What was measured of one service."""

    rehearsed_us: Floats
    """Latencies of the frames that all clients received, in the blocks with rehearsals, shape (n,)."""
    plain_us: Floats
    """The same in the blocks without."""
    served: str
    """How many frames were served to all clients, to some and to none."""
    work_us: dict[str, float]
    """Median time from the start of a run to its result without rehearsals, for perceive and serve."""
    notes: str


def run(seconds: float = 60.0) -> list[Row]:
    """All cases. seconds: how long each service is measured; the baselines take as long again."""
    return [row for case in CASES for row in _rows(case, seconds)]


def _rows(case: Case, seconds: float) -> list[Row]:
    two = _measure(case, seconds, "")
    one = _measure(case, seconds, ONE_PROCESS)
    in_c, reason = _baselines(case.rate_hz, seconds, two.work_us)
    rows: list[Row] = []
    for (word, share), goal_ms in zip(QUANTILES, case.goals_ms, strict=True):
        value = _quantile_ms(two.rehearsed_us, share)
        judged: Row = {} if goal_ms is None else {"goal": f"<= {goal_ms} ms", "met": value <= goal_ms}
        plain = _quantile_ms(two.plain_us, share)
        rows.append(_row(f"{case.name}: {word}, without rehearsals", value, plain) | judged)
        for work, report in in_c.items():
            delivered = _quantile_ms(np.array(report["delivered_us"]), share)
            rows.append(_row(f"{case.name}: {word}, in C with {work}", value, delivered))
        rows.append(_row(f"{case.name}: {word} in one process, in two", _quantile_ms(one.rehearsed_us, share), value))
    rows += [
        {
            "name": f"{case.name}: {task}, from the start of a cold run to its result, median",
            "value": took,
            "unit": "us",
        }
        for task, took in two.work_us.items()
    ]
    notes = [two.served, two.notes, f"in one process: {one.served}; {one.notes}"]
    notes += [f"in C with {work}: {_summary(report)}" for work, report in in_c.items()] if in_c else [reason]
    return [*rows, *({"name": f"{case.name}: {note}"} for note in notes)]


def _row(name: str, value: float, baseline: float) -> Row:
    return {"name": name, "value": value, "unit": "ms", "baseline": baseline, "ratio": value / baseline}


def _measure(case: Case, seconds: float, settings: str) -> Handover:
    """The service with all its clients, with further settings."""
    with contextlib.ExitStack() as stack:
        service, attached, description = stack.enter_context(match_service(case.rate_hz, case.per_team, settings))
        receiver = stack.enter_context(Helper("bench.receiver", service.udp_port, case.per_team))
        if case.is_busy:
            stack.enter_context(full_load())
        wait_with_progress(SETTLE_S, f"{case.name}: settling")
        watcher = stack.enter_context(Helper("bench.record_timestamps", service.control, *FRAME_PATH))
        numbers = range(2 * max(round(seconds / BLOCK_S / 2), 1))
        blocks = [_block(service, attached, number % 2 == 0) for number in with_progress(numbers, case.name)]
        written, received = watcher.finish(), receiver.finish()
        notes = f"{description}; {policies_of(attached)}; {_rehearsals(attached)}; clients: {received['policy']}"
    timestamps, plain = written["timestamps"], [block for block in blocks if not block.rehearses]
    latencies = joined_latencies(timestamps[FRAMES], received, attached.boot)
    late_us = {task: quantile_us(sum_of(plain, task), 0.5) for task in plain[0].late}
    return Handover(
        _in_blocks(latencies, [block for block in blocks if block.rehearses]),
        _in_blocks(latencies, plain),
        served(timestamps[FRAMES], received, attached.boot),
        work_by_task({record: _within(found, plain) for record, found in timestamps.items()}, late_us),
        notes,
    )


def _block(service: RunningService, attached: Attached, rehearses: bool) -> Block:
    for task in workers_of(attached):
        status, answer = service.request("PATCH", f"/api/v1/tasks/{task}", {"rehearse": rehearses})
        if status != 200:
            raise RuntimeError(f"a change of {task}: {answer}")
    time.sleep(IGNORED_S)
    began, before = time.monotonic_ns(), histograms_of(attached, "lateness")
    time.sleep(BLOCK_S - IGNORED_S)
    after = histograms_of(attached, "lateness")
    return Block(rehearses, began, time.monotonic_ns(), {task: after[task] - before[task] for task in after})


def sum_of(blocks: list[Block], task: str) -> Counts:
    """The histogram of a task over several blocks."""
    total: Counts = np.sum([block.late[task] for block in blocks], axis=0)
    return total


def _within(timestamps: list[Timestamps], blocks: list[Block]) -> list[Timestamps]:
    """Of values that were measured in some blocks."""
    return [one for one in timestamps if any(block.began <= one[0] < block.ended for block in blocks)]


def _in_blocks(latencies: list[Timestamps], blocks: list[Block]) -> Floats:
    """Latencies [us] of the frames that were published in some blocks. latencies: instant and latency [ns] of each."""
    return np.array([latency / NS_PER_US for _, latency in _within(latencies, blocks)])


def _rehearsals(attached: Attached) -> str:
    now, tasks = MonotonicClock().now(), workers_of(attached)
    counts = {task: records.task(task).reader(attached.store).value(now).rehearsals for task in tasks}
    return ", ".join(f"{task} {counted}" for task, counted in counts.items())


def work_by_task(timestamps: dict[str, list[Timestamps]], late_us: dict[str, float]) -> dict[str, float]:
    """Median time from the start of a task's run to its result [us].

    That is the time between the writes of its input and its output, less late_us: how late the run starts (median), by
    task in the order of the frame path.
    """
    written = [dict(timestamps[record]) for record in FRAME_PATH]
    work_us = {}
    for task, (inputs, outputs) in zip(late_us, pairwise(written), strict=True):
        took = [(at - inputs[measured]) / NS_PER_US for measured, at in outputs.items() if measured in inputs]
        work_us[task] = max(float(np.median(took)) - late_us[task], 0.0)
    return work_us


def served(frames: list[Timestamps], received: Report, boot: int) -> str:
    """How many frames reached all clients, some, and none, in words."""
    clients = {time_us: count for time_us, count, _first, _last in received["views"]}
    newest = max(clients, default=0)  # later frames were still on their way when the measurement ended
    times_us = [(measured - boot) // NS_PER_US for measured, _ in frames]
    counts = [clients.get(time_us, 0) for time_us in times_us if time_us <= newest]
    some = sum(0 < count < received["clients"] for count in counts)
    return f"{len(counts)} frames, of which {some} reached not all clients and {counts.count(0)} none"


def joined_latencies(frames: list[Timestamps], received: Report, boot: int) -> list[tuple[int, int]]:
    """When each frame was published that all clients received, and its latency [ns]."""
    views = {time_us: last for time_us, count, _first, last in received["views"] if count == received["clients"]}
    times = ((written, (measured - boot) // NS_PER_US) for measured, written in frames)
    return [(written, views[time_us] - written) for written, time_us in times if time_us in views]


def _baselines(rate_hz: float, seconds: float, work_us: dict[str, float]) -> tuple[dict[str, Report], str]:
    """Reports of the C baseline without work and with the service's work; none, and the reason, without a compiler."""
    program, message = build_program("handover")
    if program is None:
        return {}, message
    idle = _run_baseline(program, rate_hz, seconds, 0.0, 0.0)
    perceive_us, serve_us = work_us.values()
    sending_us = float(np.median(idle["sending_us"]))
    working = _run_baseline(program, rate_hz, seconds, perceive_us, max(serve_us - sending_us, 0.0))
    return {"no work": idle, "the same work": working}, message


def _run_baseline(program: Path, rate_hz: float, seconds: float, perceive_us: float, serve_us: float) -> Report:
    numbers = [rate_hz, round(rate_hz * seconds), round(perceive_us), round(serve_us)]
    with subprocess.Popen([str(program), *map(str, numbers)], stdout=subprocess.PIPE, text=True) as process:
        try:
            wait_with_progress(seconds, f"{rate_hz:g} Hz: baseline in C")
            report: Report = json.loads(process.communicate()[0])
        finally:
            process.kill()
    return report


def _summary(report: dict[str, Any]) -> str:
    policies = ", ".join(f"{process} {policy}" for process, policy in report["policies"].items())
    return f"{policies}; {report['skipped'] + report['incomplete']} of {report['published']} frames not served"


def _quantile_ms(times_us: Floats, share: float) -> float:
    """Quantile [ms], infinite without any values."""
    return float(np.quantile(times_us, share)) / US_PER_MS if len(times_us) else float("inf")
