"""Latency from a published frame to the last client with rehearsals and without, in the running service, in turns.

Setup: as ``handover``: the service shows a folder of pictures to connected clients, at 30 Hz with 22 and 10 robots and
at 200 Hz. Blocks of BLOCK_S in which ``perceive`` and ``serve`` rehearse alternate with blocks in which they do not:
the live setting ``tasks.NAME.rehearse`` is changed. The first part of a block does not count. The baseline of each row
is the same service in the other blocks.
"""

import contextlib
import time
from dataclasses import dataclass

import numpy as np

from bench.frame_path import FRAMES, policies_of, workers_of
from bench.handover import joined_latencies
from bench.helpers import Helper, with_progress
from bench.pictures import match_service
from bench.record_timestamps import Timestamps
from bench.runner import Row
from bench.service import RunningService
from vision_core.clock import NS_PER_S, NS_PER_US, US_PER_MS, MonotonicClock
from vision_core.geometry import Floats
from vision_core.net.control import Attached
from vision_core.rtdb import records

BLOCK_S, IGNORED_S = 5.0, 1.0
SETTLE_S = 2.0
CASES = ((30.0, 11, 0.8, 1.2), (30.0, 5, 0.45, None), (200.0, 11, 0.6, None))
"""Rate [Hz], robots of a team, and the goals for median and p99 [ms]."""


@dataclass(frozen=True, slots=True)
class Block:
    """For so long the tasks rehearsed, or not [ns of CLOCK_MONOTONIC]."""

    rehearses: bool
    began: int
    ended: int


def run(seconds: float = 60.0) -> list[Row]:
    """All cases. seconds: of each."""
    return [row for case in CASES for row in _measure(case, seconds)]


def _measure(case: tuple[float, int, float, float | None], seconds: float) -> list[Row]:
    rate_hz, per_team, median_ms, p99_ms = case
    name = f"{rate_hz:g} Hz, {2 * per_team} robots and clients"
    with contextlib.ExitStack() as stack:
        service, attached, _ = stack.enter_context(match_service(rate_hz, per_team))
        receiver = stack.enter_context(Helper("bench.receiver", service.udp_port, per_team))
        time.sleep(SETTLE_S)
        watcher = stack.enter_context(Helper("bench.record_timestamps", service.control, FRAMES))
        numbers = range(max(round(seconds / BLOCK_S), 2))
        blocks = [_block(service, attached, number % 2 == 0) for number in with_progress(numbers, name)]
        written, received = watcher.finish(), receiver.finish()
        found = joined_latencies(written["timestamps"][FRAMES], received, attached.boot)
        note = f"{name}: {policies_of(attached)}; {_told(attached)}"
    with_us, without_us = (
        _in_blocks(found, [one for one in blocks if one.rehearses is value]) for value in (True, False)
    )
    rows: list[Row] = []
    for word, share, goal_ms in (("median", 0.5, median_ms), ("p99", 0.99, p99_ms)):
        value, baseline = (float(np.quantile(times_us, share)) / US_PER_MS for times_us in (with_us, without_us))
        row: Row = {
            "name": f"{name}: {word}",
            "value": value,
            "unit": "ms",
            "baseline": baseline,
            "ratio": value / baseline,
        }
        rows.append(row | ({} if goal_ms is None else {"goal": f"<= {goal_ms} ms", "met": value <= goal_ms}))
    return [*rows, {"name": note}]


def _block(service: RunningService, attached: Attached, rehearses: bool) -> Block:
    for task in workers_of(attached):
        status, answer = service.request("PATCH", f"/api/v1/tasks/{task}", {"rehearse": rehearses})
        if status != 200:
            raise RuntimeError(f"a change of {task}: {answer}")
    began = time.monotonic_ns()
    time.sleep(BLOCK_S)
    return Block(rehearses, began + round(IGNORED_S * NS_PER_S), time.monotonic_ns())


def _in_blocks(found: list[Timestamps], blocks: list[Block]) -> Floats:
    """Latencies [us] of the frames that were published in some blocks. found: instant and latency [ns] of each."""
    return np.array(
        [latency / NS_PER_US for at, latency in found if any(block.began <= at < block.ended for block in blocks)]
    )


def _told(attached: Attached) -> str:
    told = []
    for task in workers_of(attached):
        info = records.task(task).reader(attached.store).value(MonotonicClock().now())
        told.append(f"{task} {info.rehearsals}")
    return ", ".join(told)
