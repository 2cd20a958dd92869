"""Duration of the whole pipeline for one frame, from pixels to sent datagrams: back to back, and at 30 Hz.

Distinct frames of a simulated match, rendered beforehand and looped; the table says how many. In one process and thread
each frame is perceived (known robots verified, a window around the ball, scan band, the whole picture when something is
missing), tracked, rendered as every robot's view, encoded for every client and sent over loopback through one socket
per client. The service does the same in two processes, one after the other.

Measured [us]: median duration of a frame, and of each stage, back to back; then frames that come at 30 Hz (``paced``),
from the publication of a frame to its last datagram, with rehearsals and without. Baseline: the reference segmentation
of the same frames alone, in Python and in C, back to back and at 30 Hz; a ratio below 1 means that the whole pipeline
takes less time than that one stage of a classical system. Pipeline and baselines take turns in blocks of frames. At
1280x1024 with 22 robots the sustained rate is given too [frames per second], the clients' receiving included.
"""

import json
import subprocess
import sys
import time
from collections.abc import Callable

import numpy as np

from bench.helpers import ROOT
from bench.paced import IN_C, LOOP, REFERENCE, REHEARSED
from bench.runner import Row
from bench.segmentation import c_reference_of
from bench.segmenters import ReferenceSegmenter
from bench.whole_loop import BLOCK, STAGES, UNMEASURED, Loop, match_frames, open_loop
from vision_core.clock import US_PER_S
from vision_core.geometry import Bytes

CASES = {("640x480", 10): 0.5, ("1280x1024", 10): 0.2, ("1280x1024", 22): 0.4, ("2048x1536", 22): None}
"""Size and robots of each case, and its goal: the largest ratio to the reference segmentation alone."""
ROUNDS = 4
"""Times that all frames are looped."""
SUSTAINED = ("1280x1024", 22)
SUSTAINED_HZ = 500.0


def run() -> list[Row]:
    """Rows for every case."""
    rows: list[Row] = []
    for (size, robots), goal in CASES.items():
        name = f"{size}, {robots} robots"
        with open_loop(size, robots) as loop:
            frames = match_frames(size, robots)
            rows += _back_to_back(loop, frames, f"{name}, {len(frames)} frames", goal)
            if (size, robots) == SUSTAINED:
                rows.append(_sustained(loop, frames))
            del frames
        rows += _paced(size, robots, f"{name}, 30 Hz", goal)
    return rows


def _back_to_back(loop: Loop, frames: list[Bytes], name: str, goal: float | None) -> list[Row]:
    table = loop.perception.table
    reference = ReferenceSegmenter(*loop.perception.camera.size_px, loop.settings.blobs)
    references: dict[str, Callable[[int], object]] = {REFERENCE: lambda frame: reference.segment(frames[frame], table)}
    c_reference, _ = c_reference_of(loop.settings, table, frames)
    if c_reference is not None:
        references[IN_C] = c_reference[0]
    timestamps: list[tuple[float, ...]] = []
    reference_times: dict[str, list[float]] = {key: [] for key in references}
    sent = 0
    # pipeline and baselines take turns, a block of frames each
    for block in range(0, ROUNDS * len(frames), BLOCK):
        for place in range(BLOCK):
            times = loop.turn(frames[(block + place) % len(frames)])
            sent += loop.drain()
            if place >= UNMEASURED:
                timestamps.append(times)
        for key, call in references.items():
            times_s = [_seconds(call, (block + place) % len(frames)) for place in range(BLOCK)]
            reference_times[key] += times_s[UNMEASURED:]
    durations = np.diff(np.array(timestamps), axis=1)
    whole_us = float(np.median(durations.sum(axis=1))) * US_PER_S
    rows = [
        _row(f"{name}: pixels to sent, {key} alone", whole_us, float(np.median(seconds)) * US_PER_S, goal)
        for key, seconds in reference_times.items()
    ]
    for stage, seconds in zip(STAGES, np.median(durations, axis=0).tolist(), strict=True):
        rows.append({"name": f"{name}: {stage}", "value": seconds * US_PER_S, "unit": "us"})
    rows.append({"name": f"{name}: datagrams per frame", "value": round(sent / (ROUNDS * len(frames)), 2), "unit": ""})
    return rows


def _paced(size: str, robots: int, name: str, goal: float | None) -> list[Row]:
    """Frames at 30 Hz, in a process with the priority of perceive."""
    command = [sys.executable, "-m", "bench.paced", size, str(robots)]
    done = subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True, cwd=ROOT)
    report = json.loads(done.stdout)
    times_us = report["times_us"]
    rows: list[Row] = []
    for loop, judged in ((REHEARSED, goal), (LOOP, None)):
        for key in (REFERENCE, IN_C):
            if key in times_us:
                median, alone = (float(np.median(times_us[method])) for method in (loop, key))
                rows.append(_row(f"{name}: {loop}, {key} alone", median, alone, judged))
        p99, alone = (float(np.quantile(times_us[method], 0.99)) for method in (loop, REFERENCE))
        rows.append(_row(f"{name}: {loop}, {REFERENCE} alone, p99", p99, alone, None))
    return [*rows, {"name": f"{name}: {report['policies']}; {report['rehearsals']}"}]


def _seconds(call: Callable[[int], object], frame: int) -> float:
    began = time.perf_counter()
    call(frame)
    return time.perf_counter() - began


def _sustained(loop: Loop, frames: list[Bytes]) -> Row:
    """The sustained rate [frames per second]: the clients' receiving is the only other work, and counts."""
    count = ROUNDS * len(frames)
    began = time.perf_counter()
    for turn in range(count):
        loop.turn(frames[turn % len(frames)])
        loop.drain()
    rate = count / (time.perf_counter() - began)
    size, robots = SUSTAINED
    return {
        "name": f"{size}, {robots} robots, {len(frames)} frames: sustained, clients' receiving included",
        "value": round(rate, 1),
        "unit": "1/s",
        "goal": f">= {SUSTAINED_HZ:g} 1/s",
        "met": rate >= SUSTAINED_HZ,
    }


def _row(name: str, us: float, baseline_us: float, goal: float | None) -> Row:
    judged: Row = {} if goal is None else {"goal": f"<= {goal:g}x", "met": us <= goal * baseline_us}
    return {"name": name, "value": us, "unit": "us", "baseline": baseline_us, "ratio": us / baseline_us} | judged
