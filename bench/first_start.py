"""How long the first start and the second one take, and what the service costs when nobody is connected.

Setup: ``pslv serve`` with its default source on a free port of loopback, first with an empty data folder, then with the
folder that the first start has filled. Nothing is connected beside the benchmark itself, which asks for readiness.

Measured [s]: from starting the command until /readyz answers 200; until every process runs; the processor time that the
service has used by then. While the rest is compiled, frames are served already: how many the tasks on the frame path
missed meanwhile is counted. The last row is the processor time of the running service as a share of one core.
"""

import contextlib
import os
import tempfile
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from bench.helpers import wait_with_progress
from bench.runner import Row
from bench.service import RunningService, running_service
from vision_core.clock import MonotonicClock
from vision_core.net.control import attach_to
from vision_core.rtdb import records
from vision_core.rtdb.process_state import ProcessState

COLD_GOAL_S, WARM_GOAL_S = 30.0, 2.0
LOOK_EVERY_S = 0.05
ALL_RUN_TIMEOUT_S = 290.0
SETTLE_S = 5.0
"""After the start, for the spare processes to load."""
IDLE_S = 20.0
TICKS_PER_S = os.sysconf("SC_CLK_TCK")


@dataclass(frozen=True, slots=True)
class Start:
    """One start of the service."""

    ready_s: float
    all_run_s: float
    processor_s: float
    """Processor time of all its processes until every one ran."""
    frames: int
    """That the frame path served from being ready until every process ran."""
    missed: int
    """The most of these that a task of the frame path missed."""


def run(idle_s: float = IDLE_S) -> list[Row]:
    """Both starts. idle_s: how long the running service is watched."""
    with tempfile.TemporaryDirectory(prefix="pslv-bench-") as folder:
        with _started(folder) as (first, _service):
            pass
        with _started(folder) as (second, service):
            wait_with_progress(SETTLE_S, "first_start: settling")
            before = _processor_s(service)
            wait_with_progress(idle_s, "first_start: nobody is connected")
            share = (_processor_s(service) - before) / idle_s
    return [
        *_rows("first start", first, COLD_GOAL_S),
        {"name": "first start: frames served until all processes run", "value": first.frames, "unit": ""},
        {"name": "first start: of these missed at most by a task", "value": first.missed, "unit": ""},
        *_rows("second start", second, WARM_GOAL_S),
        {"name": "processor time of the service, nobody connected", "value": share, "unit": "cores"},
    ]


@contextlib.contextmanager
def _started(folder: str) -> Iterator[tuple[Start, RunningService]]:
    """A service of which every process runs, and how its start was. folder: its data folder."""
    began = time.monotonic()
    with running_service(variables={"PSLV_DATA_DIR": folder}) as service, contextlib.ExitStack() as stack:
        ready_s = time.monotonic() - began
        attached = attach_to(service.control)
        stack.callback(attached.close)
        clock = MonotonicClock()
        info = records.SERVICE.reader(attached.store).value(clock.now())
        counters = [records.task(task.name).reader(attached.store) for task in info.tasks if task.on_frame_path]

        def counts() -> list[tuple[int, int]]:
            """Runs and missed releases of each task on the frame path."""
            return [(one.runs, one.missed) for one in (reader.value(clock.now()) for reader in counters)]

        processes = records.PROCESSES.reader(attached.store)
        at_ready = counts()
        while any(
            one.state not in (ProcessState.RUNNING, ProcessState.DONE)
            for one in processes.value(clock.now()).processes
            if not one.name.startswith("spare")
        ):
            if time.monotonic() - began > ALL_RUN_TIMEOUT_S:
                raise RuntimeError("not all processes run")
            time.sleep(LOOK_EVERY_S)
        all_run_s = time.monotonic() - began
        done = [
            (runs - old_runs, missed - old) for (runs, missed), (old_runs, old) in zip(counts(), at_ready, strict=True)
        ]
        frames, missed = min(runs for runs, _ in done), max(missed for _, missed in done)
        yield Start(ready_s, all_run_s, _processor_s(service), frames, missed), service


def _processor_s(service: RunningService) -> float:
    """Processor time of the service's living processes, and of those that have ended [s]."""
    total = 0
    for pid in {service.process.pid, *service.pids().values()}:
        with contextlib.suppress(FileNotFoundError):
            fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
            total += sum(int(value) for value in fields[11:15])  # user, system, and both of children that have ended
    return total / TICKS_PER_S


def _rows(name: str, start: Start, goal_s: float) -> list[Row]:
    return [
        {
            "name": f"{name}: until ready",
            "value": start.ready_s,
            "unit": "s",
            "goal": f"<= {goal_s:g}",
            "met": start.ready_s <= goal_s,
        },
        {"name": f"{name}: until all processes run", "value": start.all_run_s, "unit": "s"},
        {"name": f"{name}: processor time until then", "value": start.processor_s, "unit": "s"},
    ]
