"""The CAMBADA paper's experiment: ten detectors on the same frames, in one loop and as real-time tasks of the service.

    python -m bench.scheduling [--seconds N] [--out FOLDER]

*One loop* runs all detectors on every frame (``cambada.monolith``): once as an ordinary process, as the paper's loops
were, and once with the real-time priority of the highest task. What differs between the second and the tasks is due to
the architecture alone. *Tasks* have the periods, priorities and offsets of the paper's table 2, each in a process of
its own in the running service (``cambada.tasks``). Those of the camera's own period are released by the frames, the
others by the clock; ``cambada.venue`` says why. The camera delivers 640x480 at 20 Hz; the ball is missing in a fifth of
the frames and the goals in a sixth. Everything runs under full load: a busy process on each core.

Measured [ms]: response times of the loop (the paper's table 1) and intervals between activations of every task (its
table 3), with the paper's figures as the baseline; the goal is a smaller standard deviation than the paper's for every
task. Skipped frames are attributed to the machine while a stall detector on any core woke late, else to the task. Each
task records its own activations (``cambada.activation_log``). The histograms of the paper's figures 3 and 5 to 8 go to
``bench/out/scheduling.png``. ``bench.cambada`` says what each detector detects.
"""

import argparse
import contextlib
import subprocess
import sys
import tempfile
from pathlib import Path

from bench.cambada.activation_log import BEGAN, Rows, read_log
from bench.cambada.detectors import DETECTORS, detector_of
from bench.cambada.image_sequence import BALL_MISSING, FRAMES, GOALS_MISSING, write_sequence
from bench.cambada.monolith import BALL, LOOP
from bench.cambada.paper import RATE_HZ, TASKS
from bench.cambada.picture import draw
from bench.cambada.results import HasStalled, Loop, Modular, execution_rows, table_1, table_3
from bench.cambada.venue import IMAGES, LOGS, write_venue
from bench.clients import StallDetectors
from bench.frame_path import policy_of
from bench.helpers import ROOT, wait_with_progress
from bench.load import Load, full_load
from bench.runner import OUT, Row
from bench.service import running_service
from vision_core.clock import MonotonicClock
from vision_core.models.camera_setup import CameraSetup
from vision_core.native.opencv import write_picture
from vision_core.net.control import attach_to
from vision_core.rtdb import records
from vision_core.venues.loader import load_settings

SETTLE_S = 3.0
"""Before the tasks are measured, for load and trackers to settle."""
HIGHEST = max(timing.priority for timing in TASKS.values())


def run(seconds: float = 60.0, out: Path = OUT) -> list[Row]:
    """Both architectures under load. seconds: how long each runs; out: the picture's folder."""
    with tempfile.TemporaryDirectory(prefix="pslv-bench-") as name:
        folder = Path(name)
        venue = write_venue(folder)
        settings = load_settings(venue=str(venue))
        write_sequence(settings, folder / IMAGES)
        for task in DETECTORS:
            detector_of(task, settings)  # compiles its kernels; the other processes load them
        with full_load() as load:
            ordinary = measure_loop(folder, venue, 0, seconds)
            privileged = measure_loop(folder, venue, HIGHEST, seconds)
            loaded = _load_rows(load, "the loops")
        modular, notes = measure_tasks(folder, venue, seconds)
    width, height = CameraSetup.from_settings(settings).size_px
    size = f"{width}x{height}"
    title = f"One loop against tasks: {size} at {RATE_HZ:g} Hz, a busy process on each of {len(load.processes)} cores"
    out.mkdir(parents=True, exist_ok=True)
    write_picture(out / "scheduling.png", draw(ordinary, privileged, modular, title))
    tables = [*table_1(ordinary), *table_1(privileged), *table_3(modular), *execution_rows(modular)]
    return [_sequence_row(size), *loaded, *tables, *notes]


def measure_loop(folder: Path, venue: Path, priority: int, seconds: float) -> Loop:
    """Run the monolithic loop at a priority, 0 for an ordinary process."""
    logs = folder / f"{LOGS}-{priority}"
    logs.mkdir()
    command = [sys.executable, "-m", "bench.cambada.monolith", venue, seconds, priority, logs]
    done = subprocess.run([str(word) for word in command], check=True, stdout=subprocess.PIPE, text=True, cwd=ROOT)
    return Loop(done.stdout.strip(), read_log(logs, LOOP), read_log(logs, BALL))


def measure_tasks(folder: Path, venue: Path, seconds: float) -> tuple[Modular, list[Row]]:
    """Run the tasks in the service. Returns their runs, and rows about load and stalls."""
    clock = MonotonicClock()
    with running_service("--venue", str(venue)) as service, contextlib.ExitStack() as stack:
        load = stack.enter_context(full_load())
        wait_with_progress(SETTLE_S, "scheduling: settling")
        detectors = StallDetectors()
        start = clock.now()
        wait_with_progress(seconds, "scheduling: tasks")
        end = clock.now()
        detectors.stop()
        policies = _policies(service.control)
        loaded = _load_rows(load, "the tasks")
    tasks = {name: _within(read_log(folder / LOGS, name), start, end) for name in TASKS}
    return Modular(tasks, policies, stall_test(detectors)), [*loaded, *detectors.rows()]


def stall_test(detectors: StallDetectors) -> HasStalled:
    """The test whether the machine stalled. It is never true when a detector had no real-time priority.

    Such a detector may be late because other processes ran.
    """
    if all(report["policy"] == "SCHED_FIFO" for report in detectors.reports):
        return detectors.has_stalled_between
    return lambda _start_s, _end_s: False


def _policies(control: str) -> dict[str, str]:
    """The scheduling policy that each task was granted, with the reason where it is not the requested one."""
    attached = attach_to(control)
    now = MonotonicClock().now()
    infos = {name: records.task(name).reader(attached.store).value(now) for name in TASKS}
    attached.close()
    return {name: policy_of(info) for name, info in infos.items()}


def _within(rows: Rows, start: int, end: int) -> Rows:
    began = rows[:, BEGAN]
    inside: Rows = rows[(began >= start) & (began <= end)]
    return inside


def _sequence_row(size: str) -> Row:
    missing = [
        f"{name} missing in {len(frames)} of {period}"
        for name, (period, frames) in (("ball", BALL_MISSING), ("goals", GOALS_MISSING))
    ]
    return {"name": f"{FRAMES} frames of {size} in a loop, {', '.join(missing)}"}


def _load_rows(load: Load, during: str) -> list[Row]:
    return [
        {"name": f"busy process on core {core} during {during}: its share of the core", "value": share, "unit": ""}
        for core, share in load.shares().items()
    ]


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seconds", type=float, default=60.0, help="how long each architecture runs [s]")
    parser.add_argument("--out", type=Path, default=OUT, help="folder of the picture")
    arguments = parser.parse_args()
    for row in run(arguments.seconds, arguments.out):
        print(row)
