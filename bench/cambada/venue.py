"""The experiment's venue: the image sequence at the paper's rate, and the paper's table 2 as tasks of the service.

The service goes on serving robots, at priorities below all of the paper's; its own slower trackers are disabled.
"""

from collections.abc import Iterator
from pathlib import Path

from bench.cambada.paper import RATE_HZ, TASKS

IMAGES, LOGS, VENUE = "images", "logs", "venue.toml"
"""Names in the experiment's folder."""
DISABLED = ("obstacles", "boundary", "lines", "exposure", "colors", "diagnose", "overlay")
PRIORITIES = {"perceive": 12, "serve": 11}
"""Of the service's own tasks that stay enabled: below all of the paper's."""
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
        yield 'reads = ["frames/main"]'
        yield f'writes = ["cambada/{name}"]'
        yield f"priority = {timing.priority}"
        yield f"period_ms = {timing.period_ms}"
        yield f"offset_ms = {timing.offset_ms}"
        yield f"budget_ms = {BUDGETS_MS.get(name, BUDGET_MS)}"
