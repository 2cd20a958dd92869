"""The experiment's venue: the image sequence at the paper's rate, and the paper's table 2 as tasks of the service.

The tasks that look at every frame are released by the frames. On a grid of the clock of the same period they would look
at some frames twice and at others never whenever a frame comes at about the instant at which they read it. The slower
tasks are released by the clock. The service goes on serving robots, at priorities below all of the paper's; its own
slower trackers are disabled.
"""

from collections.abc import Iterator
from pathlib import Path

from bench.cambada.paper import RATE_HZ, TASKS, TaskTiming
from bench.frame_path import FRAMES
from vision_core.clock import MS_PER_S

IMAGES, LOGS, VENUE = "images", "logs", "venue.toml"
"""Names in the experiment's folder."""
DISABLED = ("obstacles", "boundary", "lines", "exposure", "colors", "diagnose", "overlay")
PRIORITIES = {"perceive": 12, "serve": 11, "source": 10}
"""Of the service's own tasks that stay enabled: below all of the paper's. The source has one because a camera's images
do not come late when a computer has other work."""
BUDGETS_MS = {"avoid_om": 7.0, "avoid_fr": 9.0}
"""As measured in the paper; all others:"""
BUDGET_MS = 5.0


def write_venue(folder: Path) -> Path:
    """Write the venue of an experiment into its folder, make the folder of the logs, and return the venue's path."""
    (folder / LOGS).mkdir(exist_ok=True)
    path = folder / VENUE
    path.write_text("\n".join(_lines(folder)) + "\n", encoding="utf-8")
    return path


def log_folder_of(source_uri: str) -> Path:
    """The folder in which a task saves its log, from the URI of its images: beside their folder."""
    return Path(source_uri.partition(":")[2]).parent / LOGS


def _lines(folder: Path) -> Iterator[str]:
    yield f'source.uri = "file:{folder / IMAGES}"'
    yield f"camera.rate_hz = {RATE_HZ}"
    for name in DISABLED:
        yield f"tasks.{name}.enabled = false"
    for name, priority in PRIORITIES.items():
        yield f"tasks.{name}.priority = {priority}"
    for name, timing in TASKS.items():
        yield f"[tasks.{name}]"
        yield 'module = "bench.cambada.tasks"'
        yield f'reads = ["{FRAMES}"]'
        yield f'writes = ["cambada/{name}"]'
        yield f"priority = {timing.priority}"
        yield from _release(timing)
        yield f"budget_ms = {BUDGETS_MS.get(name, BUDGET_MS)}"


def _release(timing: TaskTiming) -> Iterator[str]:
    if timing.period_ms == MS_PER_S / RATE_HZ:
        yield f'trigger = "{FRAMES}"'
        yield "period_ms = 0"
    else:
        yield f"period_ms = {timing.period_ms}"
        yield f"offset_ms = {timing.offset_ms}"
