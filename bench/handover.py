"""Latency from a published frame to the last of 22 clients, in the running service at 30 and 200 Hz.

Setup: the service shows a folder of pictures to 22 connected clients. The latency [ms] of a frame begins when capture
publishes it (timestamp in the database, read by ``record_timestamps``) and ends when the kernel has put the last of its
datagrams into a client's socket (``receiver``). Median and p99 are given; the goal is 0.8 ms for the median.

Two baselines in C (``baselines/handover.c``): four processes that hand a frame's number on in the same way. One does no
work, so its latency is what the kernel needs. The other computes for as long as perceive and serve do, less the time
that sending takes in C: the same work without Python between the stages. They run after the service, for as long.
"""

import contextlib
import json
import subprocess
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

from bench.baselines.build import build_program
from bench.frame_path import FRAME_PATH, FRAMES, histograms_of, policies_of, quantile_us
from bench.helpers import Helper, Report, wait_with_progress
from bench.pictures import ROBOTS_PER_TEAM, match_service
from bench.record_timestamps import Timestamps
from bench.runner import Row
from vision_core.clock import NS_PER_US, US_PER_MS
from vision_core.geometry import Floats

RATES_HZ = (30.0, 200.0)
CLIENTS = 2 * ROBOTS_PER_TEAM
GOAL_MS = 0.8
SETTLE_S = 2.0
MEDIAN, P99 = 0.5, 0.99


@dataclass(frozen=True, slots=True)
class Handover:
    """What was measured at one rate."""

    latencies_us: Floats
    """Of every frame that all clients received, shape (n,)."""
    frames: int
    incomplete: int
    """Frames that some clients received, not all."""
    skipped: int
    """Frames that no client received, since a newer one overtook them."""
    work_us: dict[str, float]
    """Median time from the start of a run to its result, for perceive and serve."""
    notes: list[str]


def run(seconds: float = 60.0) -> list[Row]:
    """Both rates. seconds: how long the service is measured at each; the baselines take as long again."""
    rows: list[Row] = []
    for rate_hz in RATES_HZ:
        service = _measure(rate_hz, seconds)
        baselines, reason = _baselines(rate_hz, seconds, service.work_us)
        rows += _rows(f"{rate_hz:g} Hz", seconds, service, baselines)
        if not baselines:
            rows.append({"name": reason})
    return rows


def _measure(rate_hz: float, seconds: float) -> Handover:
    """The service with all its clients."""
    with contextlib.ExitStack() as stack:
        service, attached, description = stack.enter_context(match_service(rate_hz))
        receiver = stack.enter_context(Helper("bench.receiver", service.udp_port, ROBOTS_PER_TEAM))
        wait_with_progress(SETTLE_S, f"handover at {rate_hz:g} Hz: settling")
        watcher = stack.enter_context(Helper("bench.record_timestamps", service.control, *FRAME_PATH))
        before = histograms_of(attached, "lateness")
        wait_with_progress(seconds, f"handover at {rate_hz:g} Hz")
        late_us = {
            task: quantile_us(counts - before[task], MEDIAN)
            for task, counts in histograms_of(attached, "lateness").items()
        }
        written, received = watcher.finish(), receiver.finish()
        helpers = f"clients: {received['policy']}, timestamps: {written['policy']}"
        notes = [description, helpers, policies_of(attached)]
        work_us = work_by_task(written["timestamps"], late_us)
        return joined(written["timestamps"][FRAMES], received, attached.boot, work_us, notes)


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


def joined(
    frames: list[Timestamps], received: Report, boot: int, work_us: dict[str, float], notes: list[str]
) -> Handover:
    """Join frames and received views by Time: a view's Time is when its frame was measured, since the boot [us]."""
    clients = {time_us: count for time_us, count, _first, _last in received["views"]}
    newest = max(clients, default=0)  # later frames were still on their way when the measurement ended
    times_us = [(measured - boot) // NS_PER_US for measured, _ in frames]
    counts = [clients.get(time_us, 0) for time_us in times_us if time_us <= newest]
    incomplete = sum(0 < count < received["clients"] for count in counts)
    latencies_us = np.array([latency / NS_PER_US for _, latency in joined_latencies(frames, received, boot)])
    return Handover(latencies_us, len(counts), incomplete, counts.count(0), work_us, notes)


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
            wait_with_progress(seconds, f"handover at {rate_hz:g} Hz: baseline in C")
            report: Report = json.loads(process.communicate()[0])
        finally:
            process.kill()
    return report


def _rows(name: str, seconds: float, service: Handover, baselines: dict[str, Report]) -> list[Row]:
    rows: list[Row] = []
    for word, share in (("median", MEDIAN), ("p99", P99)):
        value = _quantile_ms(service.latencies_us, share)
        row: Row = {
            "name": f"{name}: frame published -> last of {CLIENTS} clients, {word}",
            "value": value,
            "unit": "ms",
        }
        if share == MEDIAN:
            row |= {"goal": f"<= {GOAL_MS} ms", "met": value <= GOAL_MS}
        rows.append(row)
        for work, report in baselines.items():
            baseline = _quantile_ms(np.array(report["delivered_us"]), share)
            rows.append(
                {
                    "name": f"{name}: {word}, baseline in C with {work}",
                    "value": value,
                    "unit": "ms",
                    "baseline": baseline,
                    "ratio": value / baseline,
                }
            )
    rows += [
        {"name": f"{name}: frames per second", "value": round(service.frames / seconds, 1), "unit": "1/s"},
        {"name": f"{name}: frames that some clients received, not all", "value": service.incomplete},
        {"name": f"{name}: frames that a newer one overtook", "value": service.skipped},
    ]
    rows += [
        {"name": f"{name}: {task}, from the start of a run to its result, median", "value": took, "unit": "us"}
        for task, took in service.work_us.items()
    ]
    return [*rows, *({"name": f"{name}: {note}"} for note in service.notes), *_baseline_notes(name, baselines)]


def _baseline_notes(name: str, baselines: dict[str, Report]) -> list[Row]:
    return [{"name": f"{name}: baseline in C with {work}: {_summary(report)}"} for work, report in baselines.items()]


def _summary(report: dict[str, Any]) -> str:
    policies = ", ".join(f"{process} {policy}" for process, policy in report["policies"].items())
    return f"{policies}; {report['skipped'] + report['incomplete']} of {report['published']} frames not served"


def _quantile_ms(times_us: Floats, share: float) -> float:
    """Quantile [ms], infinite without any values."""
    return float(np.quantile(times_us, share)) / US_PER_MS if len(times_us) else float("inf")
