"""How long Python's garbage collection and memory allocation pause the pipeline, over 108 000 frames.

Setup: perceive, track, write and send run for 22 clients in one process on one core, at 500 frames per second. The
process is prepared as the executive prepares its own (garbage frozen, memory locked, SCHED_FIFO) and collects garbage
when the executive does: every 10 s, between two frames. The first second is warm-up and does not count.

A pause [ms] is the time that a frame takes beyond the median of the same picture, which is shown hundreds of times. A
pause is Python's when garbage was collected during the frame or the kernel had to map memory (page fault); both are
recorded for every frame. The goal is 0.3 ms for the longest of these. On the same core a stall detector runs at a
higher priority: its late wake-ups during a frame are stalls of the machine and are subtracted. Frames that are slow
without either are given too, but not judged: on a shared machine the processor itself is slow at times.

The control is unprepared Python (garbage collected at any time, no memory locked) for a sixth of the frames. It shows
that the measurement can see pauses.

    python -m bench.gc_pauses CORE FRAMES MODE        the measured process, which prints JSON; ``run`` starts it
"""

import contextlib
import gc
import json
import os
import resource
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bench.helpers import ROOT, wait_with_progress
from bench.pictures import description_of, playback_order, render_match
from bench.runner import Row
from bench.whole_loop import Loop
from vision_core.clock import MS_PER_S, MonotonicClock, seconds_between
from vision_core.geometry import Bytes, Floats
from vision_core.scheduling.executive import COLLECT_EVERY_NS
from vision_core.scheduling.realtime import ask_priority, exact_timers, freeze_garbage, lock_memory, stay_on
from vision_core.scheduling.releases import Grid
from vision_core.settings.schema import Settings

FRAMES = 108_000
CONTROL_SHARE = 1 / 6
PREPARED, UNPREPARED = "prepared", "unprepared"
RATE_HZ = 500.0
CAMERA_HZ = 30.0
ROBOTS_PER_TEAM = 5
"""In the pictures; all 22 clients are served."""
WARM_UP_FRAMES = round(RATE_HZ)
PRIORITY = 45
SLEEP_S, MIN_LATE_S = 0.0005, 0.0001
"""Of the stall detector."""
GOAL_MS = 0.3
STALL_DETECTOR = Path(__file__).with_name("stall_detector.py")

Report = dict[str, Any]


def run(frames: int = FRAMES) -> list[Row]:
    """frames: how many are measured after the warm-up."""
    control = _measure(round(frames * CONTROL_SHARE), UNPREPARED)
    return [*_rows(*_measure(frames, PREPARED)), *_control_rows(*control)]


def _measure(frames: int, mode: str) -> tuple[Report, Report]:
    """Reports of the measured process and of the stall detector. Raises RuntimeError when the process fails."""
    core = max(os.sched_getaffinity(0))
    pipe = subprocess.PIPE
    detecting = [sys.executable, str(STALL_DETECTOR), str(core), str(SLEEP_S), str(MIN_LATE_S)]
    working = [sys.executable, "-m", "bench.gc_pauses", str(core), str(frames), mode]
    with contextlib.ExitStack() as stack:
        detector = stack.enter_context(subprocess.Popen(detecting, stdin=pipe, stdout=pipe, text=True))
        stack.callback(detector.kill)
        worker = stack.enter_context(subprocess.Popen(working, stdout=pipe, text=True, cwd=ROOT))
        stack.callback(worker.kill)
        wait_with_progress((WARM_UP_FRAMES + frames) / RATE_HZ, f"gc_pauses, {mode}")
        output, _ = worker.communicate()
        stalls = json.loads(detector.communicate()[0])
    if worker.returncode:
        raise RuntimeError(f"{working} ended with {worker.returncode}; 0 was expected")
    return json.loads(output), stalls


class FrameLog:
    """When each frame began and ended, and what interrupted it; all memory is allocated beforehand."""

    def __init__(self, frames: int) -> None:
        self.began, self.done = np.full(frames, 0.0), np.full(frames, 0.0)
        """[s of CLOCK_MONOTONIC]"""
        self.page_faults, self.collections = np.full(frames, 0), np.full(frames, 0)
        """Counts during each frame."""
        self._count = 0

    def add(self, began: float, done: float, page_faults: int, collections: int) -> None:
        """Record one frame."""
        row, self._count = self._count, self._count + 1
        self.began[row], self.done[row] = began, done
        self.page_faults[row], self.collections[row] = page_faults, collections

    def report(self) -> Report:
        """Everything as lists, for JSON."""
        times = {"began": self.began, "done": self.done}
        counts = {"page_faults": self.page_faults, "collections": self.collections}
        return {name: array.tolist() for name, array in (times | counts).items()}


class MeasuredProcess:
    """The pipeline in this process."""

    def __init__(self, settings: Settings, frames: list[Bytes], stack: contextlib.ExitStack) -> None:
        self._loop = Loop(settings, stack)
        self._loop.perception.warm_up()
        self._frames = [frames[picture] for picture in playback_order()]
        """In the order in which they are played, in a loop."""
        self._clock = MonotonicClock()
        self._collects_between_frames = False
        self._last_collection = self._clock.now()
        self._between_frames_s: list[float] = []
        """Duration of each collection between two frames [s]."""
        self._collections = 0
        """All collections, during frames and between them."""
        gc.callbacks.append(self._count_collection)

    def prepare(self, core: int) -> str:
        """Prepare the process as the executive does. Returns what the kernel granted, in words."""
        self._collects_between_frames = True
        freeze_garbage()
        exact_timers()
        memory = lock_memory()
        return "; ".join((str(memory or "memory locked"), self.request_realtime(core)))

    def request_realtime(self, core: int) -> str:
        """Ask for real-time priority on one core, nothing else. Returns what the kernel granted, in words."""
        refusal, granted = stay_on([core]), ask_priority(PRIORITY)
        return "; ".join(map(str, filter(None, (granted.policy, granted.refusal, refusal))))

    def measure(self, count: int) -> Report:
        """Process a number of frames. Returns the log of all frames, and the collections and releases between them."""
        log, grid = FrameLog(count), Grid(self._clock.now(), 1.0 / RATE_HZ)
        self._between_frames_s, skipped, blocks = [], 0, sys.getallocatedblocks()
        for number in range(count):
            skipped += self._wait(grid)
            page_faults, collections = _page_faults(), self._collections
            times = self._loop.turn(self._frames[number % len(self._frames)])
            log.add(times[0], times[-1], _page_faults() - page_faults, self._collections - collections)
            self._loop.drain()
        grown = sys.getallocatedblocks() - blocks
        return log.report() | {"blocks": grown, "between_frames_s": self._between_frames_s, "skipped": skipped}

    def _wait(self, grid: Grid) -> int:
        """Wait for the next release, and collect garbage when it is time. Returns how many releases were skipped."""
        now = self._clock.now()
        if self._collects_between_frames and now - self._last_collection > COLLECT_EVERY_NS:
            gc.collect()
            self._last_collection = self._clock.now()
            self._between_frames_s.append(seconds_between(now, self._last_collection))
        while (release := grid.take(now := self._clock.now())) is None:
            time.sleep(max(seconds_between(now, grid.due(now)), 0.0))
        return release.missed

    def _count_collection(self, phase: str, _info: dict[str, int]) -> None:
        self._collections += phase == "start"


def _page_faults() -> int:
    """Minor page faults of this process so far."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_minflt


def pauses_of(began: Floats, done: Floats, pictures: int, stalls: list[list[float]]) -> tuple[Floats, Floats]:
    """Each frame's time beyond the median of its picture [s], shape (n,): as measured, and without the stalls.

    began, done: shape (n,) [s]; frame k shows picture k mod pictures. stalls: when the detector woke, and how late [s].
    """
    took = done - began
    medians = np.array([np.median(took[picture::pictures]) for picture in range(min(pictures, len(took)))])
    pauses = took - medians[np.arange(len(took)) % pictures]
    stalled = np.zeros(len(took))
    for woke, late in stalls:
        first, last = np.searchsorted(done, woke - late), np.searchsorted(began, woke)
        for frame in range(first, last):
            stalled[frame] += max(min(done[frame], woke) - max(began[frame], woke - late), 0.0)
    return pauses, pauses - stalled


def _pauses_ms(report: Report, stalls: Report) -> tuple[Floats, Floats, NDArray[np.bool_]]:
    """Pauses as measured and without the stalls [ms], and whether each frame's pause is Python's; shape (n,)."""
    began, done = np.array(report["began"]), np.array(report["done"])
    # without real-time priority the detector may be late because of the measured process itself
    machine = stalls["late"] if stalls["policy"] == "SCHED_FIFO" else []
    measured, remaining = pauses_of(began, done, report["pictures"], machine)
    is_pythons = (np.array(report["page_faults"]) > 0) | (np.array(report["collections"]) > 0)
    return measured * MS_PER_S, remaining * MS_PER_S, is_pythons


def _rows(report: Report, stalls: Report) -> list[Row]:
    measured_ms, remaining_ms, is_pythons = _pauses_ms(report, stalls)
    longest_ms = float(remaining_ms[is_pythons].max(initial=0.0))
    during, late_ms = sum(report["collections"]), [late * MS_PER_S for _, late in stalls["late"]]
    return [
        {"name": "frames", "value": len(remaining_ms)},
        {"name": "longest pause by garbage collection or page fault", "value": longest_ms, "unit": "ms",
         "goal": f"<= {GOAL_MS} ms", "met": longest_ms <= GOAL_MS},
        {"name": "garbage collections during frames", "value": during, "goal": "0", "met": during == 0},
        {"name": "frames with a page fault", "value": int(np.count_nonzero(report["page_faults"]))},
        {"name": "garbage collections between frames", "value": len(report["between_frames_s"])},
        {"name": "longest of them", "value": max(report["between_frames_s"], default=0.0) * MS_PER_S, "unit": "ms"},
        {"name": "growth of allocated blocks over all frames", "value": report["blocks"]},
        *_quantile_rows(np.subtract(report["done"], report["began"]) * MS_PER_S),
        {"name": f"frames {GOAL_MS} ms beyond their median, of any cause", "value": _count_above_goal(measured_ms)},
        {"name": "the same without stalls of the machine", "value": _count_above_goal(remaining_ms)},
        {"name": "longest of them, baseline the latest wake-up of the stall detector",
         "value": float(remaining_ms.max()), "unit": "ms", "baseline": max(late_ms, default=0.0)},
        {"name": f"wake-ups of the stall detector over {GOAL_MS} ms late",
         "value": _count_above_goal(np.array(late_ms))},
        {"name": "releases skipped", "value": report["skipped"]},
        {"name": f"{report['granted']}; stall detector {stalls['policy']}, {stalls['sleeps']} sleeps of "
                 f"{SLEEP_S * MS_PER_S:g} ms"},
        {"name": f"{report['description']}; at {RATE_HZ:g} frames per second"},
    ]  # fmt: skip


def _control_rows(report: Report, stalls: Report) -> list[Row]:
    _, remaining_ms, is_pythons = _pauses_ms(report, stalls)
    longest_ms = float(remaining_ms[is_pythons].max(initial=0.0))
    name = f"control, unprepared Python, {len(remaining_ms)} frames"
    return [
        {"name": f"{name}: garbage collections during frames", "value": sum(report["collections"])},
        {"name": f"{name}: frames with a page fault", "value": int(np.count_nonzero(report["page_faults"]))},
        {"name": f"{name}: longest pause by either", "value": longest_ms, "unit": "ms"},
    ]


def _count_above_goal(times_ms: Floats) -> int:
    return int((times_ms > GOAL_MS).sum())


def _quantile_rows(took_ms: Floats) -> Iterator[Row]:
    for name, share in (("median", 0.5), ("p99", 0.99), ("p99.9", 0.999), ("longest", 1.0)):
        yield {"name": f"duration of a frame, {name}", "value": float(np.quantile(took_ms, share)), "unit": "ms"}


def main(core: int, frames: int, mode: str) -> None:
    """Process the warm-up and the frames, print the report."""
    settings, pictures = render_match(CAMERA_HZ, ROBOTS_PER_TEAM)
    with contextlib.ExitStack() as stack:
        process = MeasuredProcess(settings, pictures, stack)
        granted = process.prepare(core) if mode == PREPARED else process.request_realtime(core)
        process.measure(WARM_UP_FRAMES)
        report = process.measure(frames)
    setup = {"granted": granted, "pictures": len(playback_order()), "description": description_of(settings)}
    print(json.dumps(report | setup))


if __name__ == "__main__":
    main(int(sys.argv[1]), int(sys.argv[2]), sys.argv[3])
