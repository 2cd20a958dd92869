"""108 000 frames through perceive, track, write and send, at 500 a second: does anything of Python's pause it?

One process, prepared as the executive prepares its own (garbage frozen, memory locked, SCHED_FIFO), on one core; it
collects garbage when the executive does, every 10 s between two frames. What pauses a frame beyond the median of the
same picture, which comes round hundreds of times, is Python's doing when garbage was collected in it, or when memory
had to be fetched (a page fault): every frame is asked for both. Beside it on the same core, at a higher priority,
sleeps ``sleeper``: what it oversleeps while a frame is worked on is the machine's standing still, and is taken off. A
machine that is merely slow for a while, as one is whose processor others share, shows in neither; such frames are told
apart. The first second is warm-up and does not count. The control is Python as it comes: collecting when it likes, no
memory locked, for a sixth of the frames.

    python -m bench.gc_pauses CORE FRAMES HOW        the process itself, which prints JSON; ``run`` starts it
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

from bench.helpers import ROOT, sit_out
from bench.loop import Loop
from bench.pictures import forwards_and_backwards, in_words, match
from bench.runner import Row
from vision_core.clock import MonotonicClock, seconds_between
from vision_core.geometry import Bytes, Floats
from vision_core.scheduling.executive import COLLECT_EVERY_NS
from vision_core.scheduling.realtime import ask_priority, exact_timers, freeze_garbage, lock_memory, stay_on
from vision_core.scheduling.releases import Grid
from vision_core.settings.schema import Settings

FRAMES = 108_000
CONTROL_SHARE = 1 / 6
PREPARED, AS_IT_COMES = "prepared", "as-it-comes"
RATE_HZ = 500.0
CAMERA_HZ = 30.0
ROBOTS_SHOWN = 5
"""Per team; all 22 clients are served."""
WARM_UP = round(RATE_HZ)
"""Frames."""
PRIORITY = 45
NAP_S, WORTH_TELLING_S = 0.0005, 0.0001
GOAL_MS = 0.3
MS_PER_S = 1e3
SLEEPER = Path(__file__).with_name("sleeper.py")

Report = dict[str, Any]


def run(frames: int = FRAMES) -> list[Row]:
    """So many frames after the warm-up."""
    control = _measure(round(frames * CONTROL_SHARE), AS_IT_COMES)
    return [*_rows(*_measure(frames, PREPARED)), *_control_rows(*control)]


def _measure(frames: int, how: str) -> tuple[Report, Report]:
    """What the process and the sleeper beside it print. Raises RuntimeError when the process fails."""
    core = max(os.sched_getaffinity(0))
    pipe = subprocess.PIPE
    sleeping = [sys.executable, str(SLEEPER), str(core), str(NAP_S), str(WORTH_TELLING_S)]
    working = [sys.executable, "-m", "bench.gc_pauses", str(core), str(frames), how]
    with contextlib.ExitStack() as stack:
        sleeper = stack.enter_context(subprocess.Popen(sleeping, stdin=pipe, stdout=pipe, text=True))
        stack.callback(sleeper.kill)
        worker = stack.enter_context(subprocess.Popen(working, stdout=pipe, text=True, cwd=ROOT))
        stack.callback(worker.kill)
        sit_out((WARM_UP + frames) / RATE_HZ, f"pauses, {how}")
        said, _ = worker.communicate()
        naps = json.loads(sleeper.communicate()[0])
    if worker.returncode:
        raise RuntimeError(f"{working} ended with {worker.returncode}; 0 was expected")
    return json.loads(said), naps


class Diary:
    """What is written down of every frame, in memory that is there from the beginning."""

    def __init__(self, frames: int) -> None:
        self.began, self.done = np.full(frames, 0.0), np.full(frames, 0.0)
        """[s of CLOCK_MONOTONIC]"""
        self.faults, self.collections = np.full(frames, 0), np.full(frames, 0)
        """How many there were while a frame was worked on."""
        self.kept = 0

    def keep(self, began: float, done: float, faults: int, collections: int) -> None:
        """One frame."""
        place, self.kept = self.kept, self.kept + 1
        self.began[place], self.done[place] = began, done
        self.faults[place], self.collections[place] = faults, collections

    def told(self) -> Report:
        """All of it, as JSON can tell it."""
        arrays = {"began": self.began, "done": self.done, "faults": self.faults, "collections": self.collections}
        return {name: array.tolist() for name, array in arrays.items()}


class Work:
    """The process under test."""

    def __init__(self, settings: Settings, frames: list[Bytes], stack: contextlib.ExitStack) -> None:
        self._loop = Loop(settings, frames, stack)
        self._loop.perception.warm_up()
        self._order = forwards_and_backwards()
        self._clock = MonotonicClock()
        self._tidies = False
        self._collected = self._clock.now()
        self._tidied_s: list[float] = []
        """How long each collection between two frames took [s]."""
        self._collections = 0
        """All of them."""
        gc.callbacks.append(self._count)

    def prepare(self, core: int) -> str:
        """As the executive does; what was obtained."""
        self._tidies = True
        freeze_garbage()
        exact_timers()
        memory = lock_memory()
        return "; ".join((str(memory or "memory locked"), self.keep_time(core)))

    def keep_time(self, core: int) -> str:
        """Real-time priority on one core, nothing else; what was obtained."""
        refusal, granted = stay_on([core]), ask_priority(PRIORITY)
        return "; ".join(map(str, filter(None, (granted.policy, granted.refusal, refusal))))

    def frames(self, count: int) -> Report:
        """Work on some frames; what was noted of each, and what Python did meanwhile."""
        diary, grid = Diary(count), Grid(self._clock.now(), 1.0 / RATE_HZ)
        self._tidied_s, skipped, blocks = [], 0, sys.getallocatedblocks()
        for number in range(count):
            skipped += self._rest(grid)
            faults, collections = _faults_so_far(), self._collections
            times = self._loop.turn(self._order[number % len(self._order)])
            diary.keep(times[0], times[-1], _faults_so_far() - faults, self._collections - collections)
            self._loop.drain()
        grown = sys.getallocatedblocks() - blocks
        return diary.told() | {"blocks": grown, "tidied": self._tidied_s, "skipped": skipped}

    def _rest(self, grid: Grid) -> int:
        """Until the next release, with time for garbage now and then; how many releases were skipped."""
        now = self._clock.now()
        if self._tidies and now - self._collected > COLLECT_EVERY_NS:
            gc.collect()
            self._collected = self._clock.now()
            self._tidied_s.append(seconds_between(now, self._collected))
        while (release := grid.take(now := self._clock.now())) is None:
            time.sleep(max(seconds_between(now, grid.due(now)), 0.0))
        return release.missed

    def _count(self, phase: str, _about: dict[str, int]) -> None:
        self._collections += phase == "start"


def _faults_so_far() -> int:
    return resource.getrusage(resource.RUSAGE_SELF).ru_minflt


def pauses_of(began: Floats, done: Floats, pictures: int, naps: list[list[float]]) -> tuple[Floats, Floats]:
    """Per frame, what it took beyond the median of its picture, and the same without what the sleeper overslept [s].

    began, done: shape (n,) [s]; frame k shows picture k mod pictures. naps: when it woke and how late it was then [s].
    """
    took = done - began
    medians = np.array([np.median(took[picture::pictures]) for picture in range(min(pictures, len(took)))])
    beyond = took - medians[np.arange(len(took)) % pictures]
    stood = np.zeros(len(took))
    for woke, late in naps:
        first, last = np.searchsorted(done, woke - late), np.searchsorted(began, woke)
        for frame in range(first, last):
            stood[frame] += max(min(done[frame], woke) - max(began[frame], woke - late), 0.0)
    return beyond, beyond - stood


def _judged(report: Report, naps: Report) -> tuple[Floats, Floats, NDArray[np.bool_]]:
    """Beyond the median, and without the sleeper's share [ms]; and which of these are Python's doing."""
    began, done = np.array(report["began"]), np.array(report["done"])
    excused = naps["overslept"] if naps["policy"] == "SCHED_FIFO" else []  # who may not wake in time excuses nobody
    beyond, left = pauses_of(began, done, report["pictures"], excused)
    pythons = (np.array(report["faults"]) > 0) | (np.array(report["collections"]) > 0)
    return beyond * MS_PER_S, left * MS_PER_S, pythons


def _rows(report: Report, naps: Report) -> list[Row]:
    beyond_ms, left_ms, pythons = _judged(report, naps)
    longest_ms = float(left_ms[pythons].max(initial=0.0))
    inside, late_ms = sum(report["collections"]), [late * MS_PER_S for _, late in naps["overslept"]]
    return [
        {"name": "frames", "value": len(left_ms)},
        {"name": "longest pause by collection or allocation, beyond the sleeper's", "value": longest_ms, "unit": "ms",
         "goal": f"<= {GOAL_MS} ms", "met": longest_ms <= GOAL_MS},
        {"name": "collections of garbage in frames", "value": inside, "goal": "0", "met": inside == 0},
        {"name": "frames with a page fault", "value": int(np.count_nonzero(report["faults"]))},
        {"name": "collections of garbage between frames", "value": len(report["tidied"])},
        {"name": "longest of them", "value": max(report["tidied"], default=0.0) * MS_PER_S, "unit": "ms"},
        {"name": "growth of allocated blocks over all frames", "value": report["blocks"]},
        *_quantiles(np.subtract(report["done"], report["began"]) * MS_PER_S),
        {"name": f"frames {GOAL_MS} ms beyond their median, whatever the cause", "value": _over(beyond_ms)},
        {"name": "the same without what the sleeper overslept", "value": _over(left_ms)},
        {"name": "longest of them, twin the sleeper's latest nap", "value": float(left_ms.max()), "unit": "ms",
         "twin": max(late_ms, default=0.0)},
        {"name": f"the sleeper's naps over {GOAL_MS} ms late", "value": _over(np.array(late_ms))},
        {"name": "releases skipped", "value": report["skipped"]},
        {"name": f"{report['words']}; sleeper {naps['policy']}, {naps['naps']} naps of {NAP_S * MS_PER_S:g} ms"},
        {"name": f"{report['shown']}; at {RATE_HZ:g} a second"},
    ]  # fmt: skip


def _control_rows(report: Report, naps: Report) -> list[Row]:
    """Python as it comes."""
    _, left_ms, pythons = _judged(report, naps)
    name = f"control, Python as it comes, {len(left_ms)} frames"
    return [
        {"name": f"{name}: collections of garbage in frames", "value": sum(report["collections"])},
        {"name": f"{name}: frames with a page fault", "value": int(np.count_nonzero(report["faults"]))},
        {"name": f"{name}: longest pause by either", "value": float(left_ms[pythons].max(initial=0.0)), "unit": "ms"},
    ]


def _over(times_ms: Floats) -> int:
    return int((times_ms > GOAL_MS).sum())


def _quantiles(took_ms: Floats) -> Iterator[Row]:
    for name, share in (("median", 0.5), ("p99", 0.99), ("p99.9", 0.999), ("longest", 1.0)):
        yield {"name": f"a frame, {name}", "value": float(np.quantile(took_ms, share)), "unit": "ms"}


def main(core: int, frames: int, how: str) -> None:
    """Work on the frames and print everything."""
    settings, pictures = match(CAMERA_HZ, ROBOTS_SHOWN)
    with contextlib.ExitStack() as stack:
        work = Work(settings, pictures, stack)
        words = work.prepare(core) if how == PREPARED else work.keep_time(core)
        work.frames(WARM_UP)
        found = work.frames(frames)
    told = {"words": words, "pictures": len(forwards_and_backwards()), "shown": in_words(settings)}
    print(json.dumps(found | told))


if __name__ == "__main__":
    main(int(sys.argv[1]), int(sys.argv[2]), sys.argv[3])
