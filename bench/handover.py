"""From a frame that is ready to the last of 22 clients having its datagram, in the running service; beside it C.

A frame is ready when capture publishes it; a client has its datagram when the kernel has put it into the client's
socket. Both are read from the same clock by programs that stand beside the service: ``stamps`` looks into the database,
``receiver`` is all the clients. The camera is a folder of pictures, since a simulated one is not that fast.

The twins (``twins/handover.c``) are four processes that hand a number on in the same way: without any work, which is
what the kernel takes, and busy for as long as our perceive and serve are from their beginning to what they pass on,
less what sending takes there: the same work in C's frame. They run after the service, for as long.
"""

import contextlib
import json
import subprocess
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from bench.baselines.build import build_program
from bench.frame_path import FRAMES, WAY, WORKERS, histograms_of, policies_of, quantile_us
from bench.helpers import Companion, Report, sit_out
from bench.pictures import ROBOTS_PER_TEAM, config_of, wait_for_all, write_match
from bench.record_timestamps import Stamp
from bench.runner import Row
from bench.service import configured, running_service
from vision_core.geometry import Floats
from vision_core.net.control import attach_to

RATES_HZ = (30.0, 200.0)
CLIENTS = 2 * ROBOTS_PER_TEAM
GOAL_MS = 0.8
SETTLE_S = 2.0
NS_PER_US = 1000
US_PER_MS = 1e3
MEDIAN, P99 = 0.5, 0.99


@dataclass(frozen=True, slots=True)
class Handover:
    """What was measured at one rate."""

    delivered_us: Floats
    """Of every frame that all clients got."""
    frames: int
    incomplete: int
    """Frames that some clients got and others did not."""
    unserved: int
    """Frames that nobody got."""
    busy_us: dict[str, float]
    """Of perceive until its sightings are written, of serve until its last datagram is sent; medians."""
    notes: list[str]


def run(seconds: float = 60.0) -> list[Row]:
    """Both rates; seconds: how long each lasts, twins apart."""
    rows: list[Row] = []
    for rate_hz in RATES_HZ:
        ours = _measure(rate_hz, seconds)
        twins, word = _twins(rate_hz, seconds, ours.busy_us)
        rows += _rows(f"{rate_hz:g} Hz", seconds, ours, twins)
        if not twins:
            rows.append({"name": word})
    return rows


def _measure(rate_hz: float, seconds: float) -> Handover:
    """The service with all its clients."""
    with contextlib.ExitStack() as stack:
        folder = Path(stack.enter_context(tempfile.TemporaryDirectory(prefix="pslv-bench-")))
        shown = write_match(folder, rate_hz)
        path = stack.enter_context(configured(config_of(rate_hz)))
        service = stack.enter_context(running_service("--config", path, "--source", f"file:{folder}"))
        attached = attach_to(service.control)
        stack.callback(attached.close)
        wait_for_all(attached)
        receiver = stack.enter_context(Companion("bench.receiver", service.udp_port, ROBOTS_PER_TEAM))
        sit_out(SETTLE_S, f"handover at {rate_hz:g} Hz: settling")
        stamps = stack.enter_context(Companion("bench.record_timestamps", service.control, *WAY))
        before = histograms_of(attached, "lateness")
        sit_out(seconds, f"handover at {rate_hz:g} Hz")
        late_us = {
            task: quantile_us(counts - before[task], MEDIAN)
            for task, counts in histograms_of(attached, "lateness").items()
        }
        written, heard = stamps.finish(), receiver.finish()
        notes = [shown, f"clients: {heard['policy']}, stamps: {written['policy']}", policies_of(attached)]
        busy_us = busy_by_task(written["stamps"], late_us)
        return joined(written["stamps"][FRAMES], heard, attached.boot, busy_us, notes)


def busy_by_task(stamps: dict[str, list[Stamp]], late_us: dict[str, float]) -> dict[str, float]:
    """Medians from the beginning of a run to what it passes on [us].

    That is from one record's writing to the next one's, less late_us: how late the task begins, in the median.
    """
    written = [dict(stamps[record]) for record in WAY]
    busy = {}
    for task, earlier, later in zip(WORKERS, written, written[1:], strict=False):
        took = [(at - earlier[measured]) / NS_PER_US for measured, at in later.items() if measured in earlier]
        busy[task] = max(float(np.median(took)) - late_us[task], 0.0)
    return busy


def joined(stamps: list[Stamp], heard: Report, boot: int, busy_us: dict[str, float], notes: list[str]) -> Handover:
    """Frames and views by their Time: a view's Time is when its frame was measured, since the boot [us]."""
    views = {time_us: (count, last) for time_us, count, _first, last in heard["views"]}
    newest = max(views, default=0)
    delivered, incomplete, unserved = [], 0, 0
    for measured, written in stamps:
        time_us = (measured - boot) // NS_PER_US
        if time_us > newest:  # it was still under way at the end
            continue
        count, last = views.get(time_us, (0, 0))
        if count == heard["clients"]:
            delivered.append((last - written) / NS_PER_US)
        else:
            incomplete, unserved = incomplete + (count > 0), unserved + (count == 0)
    frames = len(delivered) + incomplete + unserved
    return Handover(np.array(delivered), frames, incomplete, unserved, busy_us, notes)


def _twins(rate_hz: float, seconds: float, busy_us: dict[str, float]) -> tuple[dict[str, Report], str]:
    """The reports of the twin without work and with ours; none and a word without a compiler."""
    program, word = build_program("handover")
    if program is None:
        return {}, word
    floor = _twin(program, rate_hz, seconds, 0.0, 0.0)
    sending_us = float(np.median(floor["sending_us"]))
    work = _twin(program, rate_hz, seconds, busy_us["perceive"], max(busy_us["serve"] - sending_us, 0.0))
    return {"no work": floor, "the same work": work}, word


def _twin(program: Path, rate_hz: float, seconds: float, perceive_us: float, serve_us: float) -> Report:
    numbers = [rate_hz, round(rate_hz * seconds), round(perceive_us), round(serve_us)]
    with subprocess.Popen([str(program), *map(str, numbers)], stdout=subprocess.PIPE, text=True) as process:
        try:
            sit_out(seconds, f"handover at {rate_hz:g} Hz: twin in C")
            said: Report = json.loads(process.communicate()[0])
        finally:
            process.kill()
    return said


def _rows(name: str, seconds: float, ours: Handover, twins: dict[str, Report]) -> list[Row]:
    rows: list[Row] = []
    for word, share in (("median", MEDIAN), ("p99", P99)):
        value = _ms(ours.delivered_us, share)
        by_itself: Row = {
            "name": f"{name}: frame ready -> last of {CLIENTS} clients, {word}",
            "value": value,
            "unit": "ms",
        }
        if share == MEDIAN:
            by_itself |= {"goal": f"<= {GOAL_MS} ms", "met": value <= GOAL_MS}
        rows.append(by_itself)
        for work, report in twins.items():
            twin = _ms(np.array(report["delivered_us"]), share)
            rows.append(
                {
                    "name": f"{name}: {word}, twin in C with {work}",
                    "value": value,
                    "unit": "ms",
                    "twin": twin,
                    "ratio": value / twin,
                }
            )
    rows += [
        {"name": f"{name}: frames a second that came", "value": round(ours.frames / seconds, 1), "unit": "1/s"},
        {"name": f"{name}: frames that some clients got, not all", "value": ours.incomplete},
        {"name": f"{name}: frames that a newer one overtook", "value": ours.unserved},
    ]
    rows += [
        {"name": f"{name}: {task}, from its beginning to its result, median", "value": took, "unit": "us"}
        for task, took in ours.busy_us.items()
    ]
    return [*rows, *({"name": f"{name}: {note}"} for note in ours.notes), *_twin_notes(name, twins)]


def _twin_notes(name: str, twins: dict[str, Report]) -> list[Row]:
    return [{"name": f"{name}: twin in C with {work}: {_in_words(report)}"} for work, report in twins.items()]


def _in_words(report: dict[str, Any]) -> str:
    policies = ", ".join(f"{process} {policy}" for process, policy in report["policies"].items())
    return f"{policies}; {report['skipped'] + report['incomplete']} of {report['published']} frames not served"


def _ms(times_us: Floats, share: float) -> float:
    return float(np.quantile(times_us, share)) / US_PER_MS if len(times_us) else float("inf")
