"""The venue of the experiment: the sequence at the paper's rate, and the paper's table 2 as tasks of the service.

The service goes on serving robots, with priorities below all of the paper's; its own slower trackers are switched off.
"""

from collections.abc import Iterator
from pathlib import Path

from bench.cambada.paper import RATE_HZ, TASKS

SEQUENCE, LOGS, VENUE = "sequence", "logs", "venue.toml"
"""What lies in the experiment's folder."""
OFF = ("obstacles", "boundary", "lines", "exposure", "colors", "diagnose")
BELOW = {"perceive": 12, "serve": 11}
"""Our own tasks that stay on, and their priority."""
BUDGETS_MS = {"avoid_om": 7.0, "avoid_fr": 9.0}
"""As the paper has measured it; of all others:"""
BUDGET_MS = 5.0


def write_venue(folder: Path) -> Path:
    """Write the venue of an experiment whose sequence lies in a folder, and make room for logs; returns its path."""
    (folder / LOGS).mkdir(exist_ok=True)
    path = folder / VENUE
    path.write_text("\n".join(_lines(folder)) + "\n", encoding="utf-8")
    return path


def log_folder(source_uri: str) -> Path:
    """Where a task saves its log, by the source that it looks at: beside the sequence."""
    return Path(source_uri.partition(":")[2]).parent / LOGS


def _lines(folder: Path) -> Iterator[str]:
    yield f'source.uri = "file:{folder / SEQUENCE}"'
    yield f"camera.rate_hz = {RATE_HZ}"
    for name in OFF:
        yield f"tasks.{name}.enabled = false"
    for name, priority in BELOW.items():
        yield f"tasks.{name}.priority = {priority}"
    for name, line in TASKS.items():
        yield f"[tasks.{name}]"
        yield 'module = "bench.cambada.tasks"'
        yield 'reads = ["frames/main"]'
        yield f'writes = ["cambada/{name}"]'
        yield f"priority = {line.priority}"
        yield f"period_ms = {line.period_ms}"
        yield f"offset_ms = {line.offset_ms}"
        yield f"budget_ms = {BUDGETS_MS.get(name, BUDGET_MS)}"
