"""What the tasks and processes of a fake service say of themselves: it obeys proposals as the real one does."""

import math
import os
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cache
from typing import Any

import numpy as np

from tests.app.web.fairness.simulated import record_of
from vision_core.clock import NS_PER_MS, Instant, after
from vision_core.models.mirror import PAPER_MIRROR
from vision_core.rtdb import records
from vision_core.rtdb.infos import (
    LAGS,
    TIMINGS,
    ClientInfo,
    ProcessInfo,
    Refusal,
    RefusalKind,
    Rehearsals,
    SelfTest,
    TaskInfo,
    TaskOverride,
)
from vision_core.rtdb.items import Item
from vision_core.rtdb.process_state import ProcessState
from vision_core.rtdb.task import Task
from vision_core.scheduling.executive import with_override
from vision_core.settings.schema import MirrorConstants
from vision_core.timing.histogram import Histograms
from vision_core.types.colors import Light
from vision_core.types.objects import Team
from vision_core.types.palette import ColorChange, LivePalette, PaintShift
from vision_core.types.regions import (
    BallVisibility,
    BodyContour,
    BodyContours,
    ColorDrift,
    ExposureCheck,
    FieldBoundary,
    Finding,
    LineCheck,
)

RESPONSES_MS = {"capture": 0.08, "perceive": 1.9, "serve": 1.1, "source": 9.0, "obstacles": 8.0, "lines": 6.0}
"""Median; 3 where nothing is said."""
BLUE_3 = BodyContour(
    Team.BLUE, 3, ((0.4, 0.2), (0.7, 0.2), (0.55, 0.5)), ((400.0, 200.0), (460.0, 200.0), (430.0, 140.0)), True
)
RATE_HZ = 30.0
FRAME_MS = 1e3 / RATE_HZ
SPARES = ("spare-1", "spare-2")
COUNTED = 600


@cache
def fairness_of_a_match() -> bytes:
    """The record ``fairness``: of a match of some seconds."""
    return record_of(600).tobytes()


def refusals(priority: int) -> tuple[Refusal, Refusal]:
    """Of a kernel that grants no rights."""
    return (
        Refusal(RefusalKind.PRIORITY, str(priority), "no CAP_SYS_NICE, and ulimit -r is 0"),
        Refusal(RefusalKind.MEMORY, "", "no CAP_IPC_LOCK, and ulimit -l is 8192 KiB"),
    )


@dataclass
class Condition:
    """How the tasks do; change it while they run."""

    rights: bool = True
    """Real-time priority and locked memory are granted."""
    p99_us: float = 90.0
    """Lateness of wake-ups in the self-test."""
    silent: tuple[str, ...] = ()
    """Tasks that have never spoken."""
    reporting: bool = True
    """Clients report their lags."""
    camera_rate_hz: float = RATE_HZ
    """Pictures per second that the camera delivers."""
    notes: dict[str, str] = field(default_factory=dict)


def self_test(condition: Condition) -> SelfTest:
    """As measured at the start."""
    p99_us = condition.p99_us
    grade = "A" if p99_us < 200.0 else "B" if p99_us < 2000.0 else "C"
    refused, memory = ("", "") if condition.rights else map(str, refusals(50))
    policy = "FIFO 50" if condition.rights else "nice -10"
    return SelfTest(grade, policy, refused, condition.rights, memory, 400, 30.0, p99_us, 3.0 * p99_us)


COMPILERS = "compile", "compile_others"
"""The processes that run once."""


def process_infos(tasks: Sequence[Task], states: dict[str, tuple[str, str]]) -> tuple[ProcessInfo, ...]:
    """Of every process; states: state and detail of those that do not run."""
    names = (*COMPILERS, *dict.fromkeys(task.process for task in tasks), *SPARES)
    infos = []
    for index, name in enumerate(names):
        state, detail = states.get(name, ("done" if name in COMPILERS else "running", ""))
        running = state == ProcessState.RUNNING
        infos.append(ProcessInfo(name, 4000 + index if running else None, ProcessState(state), 0, detail))
    return tuple(infos)


def task_info(task: Task, override: TaskOverride, frames: int, condition: Condition) -> TaskInfo:
    """Of one task after some frames, as it runs with an override."""
    times = with_override(task, override).times
    interval_ms = times.period_ms or FRAME_MS
    response_ms = RESPONSES_MS.get(task.name, 3.0)
    granted = condition.rights or not times.priority
    rate_hz = 1.0 / times.period_s if times.period_s else condition.camera_rate_hz
    return TaskInfo(
        pid=os.getpid(),
        process=task.process,
        trigger=task.trigger,
        times=times,
        policy=("ordinary" if not times.priority else f"FIFO {times.priority}" if granted else "nice -10"),
        refusals=() if granted else refusals(times.priority),
        runs=frames,
        missed=2,
        overruns=1 if task.name == "lines" else 0,
        collections=3,
        rate_hz=rate_hz if times.enabled else 0.0,
        response_median_ms=response_ms,
        response_max_ms=2.4 * response_ms,
        interval_mean_ms=interval_ms,
        interval_sd_ms=0.02 * interval_ms,
        rehearsals=Rehearsals(frames - 9, 4, 5, 0.002 * frames) if task.on_frame_path else None,
        note=condition.notes.get(task.name, ""),
    )


@cache
def timing_of(task: Task) -> bytes:
    """Histograms of one task: the same ones every time."""
    response_ms = RESPONSES_MS.get(task.name, 3.0)
    middles_ms = {"lateness": 0.03, "execution": 0.97 * response_ms, "response": response_ms}
    return _drawn(TIMINGS, middles_ms | {"interval": task.times.period_ms or FRAME_MS})


def lags_of(condition: Condition) -> bytes:
    """Histograms of the lags: B and C only when clients report them."""
    reported = {"network": 0.12, "client": 2.0} if condition.reporting else {}
    return _drawn(LAGS, {"server": 12.4, **reported})


def clients_of(condition: Condition, count: int, per_team: int, sent: int, since: Instant) -> tuple[ClientInfo, ...]:
    """A count of clients, of which the second reports nothing."""
    return tuple(
        ClientInfo(
            team=Team.BLUE if index < per_team else Team.YELLOW,
            number=index % per_team + 1,
            address="127.0.0.1",
            port=50000 + index,
            since=since,
            sent=sent,
            dropped=3 if index == 2 else 0,
            rate_hz=RATE_HZ,
            mean_rank=0.48 + 0.004 * index,
            network_ms=0.1 + 0.01 * index if condition.reporting and index != 1 else None,
            client_ms=2.0 if condition.reporting and index != 1 else None,
            heard=after(since, 0.1),
            mirror=MirrorConstants(a=PAPER_MIRROR.a, b=PAPER_MIRROR.b, c=PAPER_MIRROR.c),
        )
        for index in range(count)
    )


def findings(camera: str, number: int, grabbed: Instant) -> list[tuple[Item[Any], Finding[Any]]]:
    """What the slow trackers find in one frame of a camera that nobody has bumped, and their records."""
    found = (
        (records.boundary, FieldBoundary(((10.0, 12.0), (math.nan, math.nan)), (0.9, 0.0), 0.94, 0.3, 0.6)),
        (records.lines, LineCheck(12, 11, 0.97, 0.4, 0.0)),
        (records.contours, BodyContours((BLUE_3,), BallVisibility.MAY_BE_HIDDEN, (0.5, 0.25), ((Team.BLUE, 3),))),
        (records.exposure, ExposureCheck(231.0, 88.0, 0.001, ())),
        (records.colors, ColorDrift((1.02, 1.0, 0.97), "")),
    )
    return [(item(camera), Finding(camera, number, grabbed, value)) for item, value in found]


def adapted(now: Instant, set_up: Light, *, held: bool) -> LivePalette:
    """Light and colors that have followed a warmer light, or are held as they were set up."""
    warmer = Light(set_up.black_bgr, (1.42, 1.05, 0.8))
    changes = (
        ColorChange(after(now, -95.0), "light", warmer),
        ColorChange(after(now, -94.0), "learned", warmer, 10, 9),
    )
    paints = (
        PaintShift("blue", (0.52, -0.6), (0.4, -0.31), 5),
        PaintShift("yellow", (-1.1, 0.02), (-0.9, 0.1), 5),
        PaintShift("pink", (0.2, 0.5), (0.3, 0.62), 0),
    )
    if held:
        return LivePalette((*changes, ColorChange(now, "held", set_up)), set_up, True, (), b"", (), ())
    return LivePalette(changes, warmer, False, paints, b"", (), ())


def _drawn(names: tuple[str, ...], middles_ms: dict[str, float]) -> bytes:
    histograms, random = Histograms(names), np.random.default_rng(5)
    for name, middle_ms in middles_ms.items():
        for duration_ms in middle_ms * random.lognormal(0.0, 0.25, COUNTED):
            histograms.add(name, round(duration_ms * NS_PER_MS))
    return histograms.encode()
