"""The paper's experiment: the same detectors on the same frames in one loop, and as tasks of the service.

    python -m bench.scheduling [--seconds N] [--out FOLDER]

What is looked for, and by what, tells ``bench.cambada``. (a) *One loop* looks for everything in every frame, once as an
ordinary process, as the paper's loops were, and once with the real-time priority of the highest task: what is left of
the difference is the architecture's. (b) *Tasks* have the periods, priorities and offsets of the paper's table 2 as
they stand, each a process of its own in the real service, run by its executive. Camera at 20 Hz, 640x480 (the paper's
had 320x240), the ball gone in a fifth of the frames and the goals in a sixth. All of it under full background load: on
every core a process of the ordinary policy that never rests.

Every activation is noted by the task itself when it begins (``cambada.activation_log``). Beside (b) a sleeper on
each core shows when the machine stood still. Tables 1 and 3 come with the paper's figures as the twin; the histograms
of figures 3 and 5 to 8 go to ``bench/out/scheduling.png``.
"""

import argparse
import contextlib
import subprocess
import sys
import tempfile
from pathlib import Path

from bench.cambada.activation_log import BEGAN, Rows, read_activations
from bench.cambada.detectors import DETECTORS, detector_of
from bench.cambada.monolith import BALL, LOOP
from bench.cambada.paper import RATE_HZ, TASKS
from bench.cambada.picture import draw
from bench.cambada.results import Loop, MachineStall, Modular, table_1, table_3, told_of
from bench.cambada.test_sequence import BALL_GONE, FRAMES, GOALS_GONE, write_sequence
from bench.cambada.venue import LOGS, SEQUENCE, write_venue
from bench.clients import Sleepers
from bench.frame_path import policy_of
from bench.helpers import ROOT, sit_out
from bench.load import Load, full_load
from bench.runner import OUT, Row
from bench.service import running_service
from vision_core.clock import MonotonicClock
from vision_core.native.opencv import write_picture
from vision_core.net.control import attach_to
from vision_core.rtdb import records
from vision_core.venues.loader import load_settings

SETTLE_S = 3.0
"""Before tasks are measured: the load has come, and lost things are found."""
HIGHEST = max(line.priority for line in TASKS.values())


def run(seconds: float = 60.0, out: Path = OUT) -> list[Row]:
    """Both arms under load, for some seconds each [s]; the picture goes into a folder."""
    with tempfile.TemporaryDirectory(prefix="pslv-bench-") as name:
        folder = Path(name)
        venue = write_venue(folder)
        settings = load_settings(venue=str(venue))
        write_sequence(settings, folder / SEQUENCE)
        for task in DETECTORS:
            detector_of(task, settings)  # compiled here, loaded by everybody
        with full_load() as load:
            ordinary = measure_loop(folder, venue, 0, seconds)
            privileged = measure_loop(folder, venue, HIGHEST, seconds)
            loaded = _load_rows(load, "the loops")
        modular, told = measure_tasks(folder, venue, seconds)
    size = f"{settings.camera.width_px}x{settings.camera.height_px}"
    title = f"One loop against tasks: {size} at {RATE_HZ:g} Hz, a busy process on each of {len(load.processes)} cores"
    out.mkdir(parents=True, exist_ok=True)
    write_picture(out / "scheduling.png", draw(ordinary, privileged, modular, title))
    tables = [*table_1(ordinary), *table_1(privileged), *table_3(modular), *told_of(modular)]
    return [*_film_rows(size), *loaded, *tables, *told]


def measure_loop(folder: Path, venue: Path, priority: int, seconds: float) -> Loop:
    """The monolithic loop at a priority, 0 for an ordinary process."""
    logs = folder / f"{LOGS}-{priority}"
    logs.mkdir()
    command = [sys.executable, "-m", "bench.cambada.monolith", venue, seconds, priority, logs]
    done = subprocess.run([str(word) for word in command], check=True, stdout=subprocess.PIPE, text=True, cwd=ROOT)
    return Loop(done.stdout.strip(), read_activations(logs, LOOP), read_activations(logs, BALL))


def measure_tasks(folder: Path, venue: Path, seconds: float) -> tuple[Modular, list[Row]]:
    """The tasks in the service, and what else is to be told of that run."""
    clock = MonotonicClock()
    with running_service("--venue", str(venue)) as service, contextlib.ExitStack() as stack:
        load = stack.enter_context(full_load())
        sit_out(SETTLE_S, "scheduling: settling")
        sleepers = Sleepers()
        start = clock.now()
        sit_out(seconds, "scheduling: tasks")
        end = clock.now()
        sleepers.stop()
        policies = _policies(service.control)
        told = _load_rows(load, "the tasks")
    tasks = {name: _within(read_activations(folder / LOGS, name), start, end) for name in TASKS}
    return Modular(tasks, policies, witness_of(sleepers)), [*told, *sleepers.rows()]


def witness_of(sleepers: Sleepers) -> MachineStall:
    """When the machine stood still. A sleeper without real-time priority shows that others ran, and excuses nothing."""
    if all(report["policy"] == "SCHED_FIFO" for report in sleepers.reports):
        return sleepers.stood_still_between
    return lambda _start_s, _end_s: False


def _policies(control: str) -> dict[str, str]:
    """What each task has got from the kernel, and why it is not what it asked for."""
    attached = attach_to(control)
    now = MonotonicClock().now()
    infos = {name: records.task(name).reader(attached.store).value(now) for name in TASKS}
    attached.close()
    return {name: policy_of(info) for name, info in infos.items()}


def _within(rows: Rows, start: int, end: int) -> Rows:
    began = rows[:, BEGAN]
    inside: Rows = rows[(began >= start) & (began <= end)]
    return inside


def _film_rows(size: str) -> list[Row]:
    gone = [
        f"{thing} gone in {len(when)} of {every}"
        for thing, (every, when) in (("ball", BALL_GONE), ("goals", GOALS_GONE))
    ]
    return [{"name": f"{FRAMES} frames of {size} looped, {', '.join(gone)}"}]


def _load_rows(load: Load, during: str) -> list[Row]:
    return [
        {"name": f"busy process on core {core} beside {during}: its share", "value": share, "unit": ""}
        for core, share in load.shares().items()
    ]


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seconds", type=float, default=60.0, help="how long each arm lasts")
    parser.add_argument("--out", type=Path, default=OUT, help="folder for the picture")
    arguments = parser.parse_args()
    for row in run(arguments.seconds, arguments.out):
        print(row)
