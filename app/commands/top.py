"""``pslv top``: the real-time database of a running service, live."""

import sys
import time
from collections import deque
from typing import TYPE_CHECKING, Annotated

import typer
from rich.console import Console
from rich.live import Live
from rich.table import Table

from app.commands.running import only_service
from vision_core.errors import ServiceError

if TYPE_CHECKING:
    from vision_core.clock import Instant
    from vision_core.net.control import Attached

EVERY_S = 0.5
RATE_INTERVALS = 8
"""Number of intervals of EVERY_S over which a rate is measured: four seconds."""


def top(
    service: Annotated[str | None, typer.Argument(help="Name of the service when several run: pslv/8000.")] = None,
    once: Annotated[bool, typer.Option("--once", help="Print once, after a second, and end.")] = False,
) -> None:
    """Show the real-time database of a running service live: item, writer, rate, age, valid (Ctrl-C ends it)."""
    from vision_core.net.control import attach_to

    view = _View(attach_to(service or only_service("pslv top")))
    out = Console(highlight=False, width=None if sys.stdout.isatty() else 120)
    view.sample()
    time.sleep(2 * EVERY_S)
    view.sample()
    if once or not out.is_terminal:
        out.print(view.table())
        return
    try:
        with Live(view.table(), console=out, auto_refresh=False, screen=True) as live:
            while view.is_running():
                view.sample()
                live.update(view.table(), refresh=True)
                time.sleep(EVERY_S)
    except KeyboardInterrupt:
        return
    raise ServiceError(f"pslv top: {view.name}", found="the service has ended")


class _View:
    """The database as a table."""

    def __init__(self, attached: "Attached") -> None:
        from vision_core.rtdb import records

        self._attached = attached
        self.name = attached.name
        self._readers = {name: attached.store.reader(name) for name in attached.store.specs}
        self._writers = _writers(attached)
        self._processes = records.PROCESSES.reader(attached.store)
        self._samples: deque[tuple[float, dict[str, int]]] = deque(maxlen=RATE_INTERVALS + 1)

    def is_running(self) -> bool:
        """Does the service still run?"""
        return self._attached.runs()

    def sample(self) -> None:
        """Note how often every record was written."""
        self._samples.append((time.monotonic(), {name: reader.sequence for name, reader in self._readers.items()}))

    def table(self) -> Table:
        """One line per record, as it is now."""
        from vision_core.clock import MonotonicClock, seconds_between

        now = MonotonicClock().now()
        table = Table("item", "writer", "written", "rate [Hz]", "age", "valid", "bytes", box=None, pad_edge=False)
        for column in ("written", "rate [Hz]", "age", "bytes"):
            next(c for c in table.columns if c.header == column).justify = "right"
        (first_s, first), (last_s, last) = self._samples[0], self._samples[-1]
        ended = self._ended(now)
        for name, reader in sorted(self._readers.items()):
            if name in ended:
                continue
            view = reader.view()
            spec = self._attached.store.specs[name]
            if view is None:
                table.add_row(name, self._writers.get(name, "-"), "never", "", "", "no", "", style="dim")
                continue
            age_s = seconds_between(view.measured, now)
            valid = not spec.validity_s or age_s <= spec.validity_s
            table.add_row(
                name,
                self._writers.get(name, "-"),
                str(view.sequence),
                f"{(last[name] - first[name]) / max(last_s - first_s, 1e-9):.1f}",
                f"{age_s * 1e3:.1f} ms" if age_s < 1.0 else f"{age_s:.1f} s",
                ("for ever" if not spec.validity_s else "yes") if valid else "NO",
                str(len(view.payload)),
                style="" if valid else "red",
            )
        return table

    def _ended(self, now: "Instant") -> set[str]:
        """Heartbeat records of processes that ran once and are done: no more heartbeats are expected."""
        from vision_core.rtdb.process_state import ProcessState

        timed = self._processes.read(now)
        rows = timed.value.processes if timed is not None else ()
        return {f"heartbeat/{row.name}" for row in rows if row.state == ProcessState.DONE}


def _writers(attached: "Attached") -> dict[str, str]:
    """The writer of each record, by the task table of the service's own settings."""
    from vision_core.clock import MonotonicClock
    from vision_core.rtdb import records
    from vision_core.tasks.table import GIVEN

    table = records.SERVICE.reader(attached.store).value(MonotonicClock().now()).tasks
    writers = {record: task.name for task in table for record in task.writes}
    for task in table:
        writers |= {f"task/{task.name}": task.name, f"timing/{task.name}": task.name}
    heartbeats = (name for name in attached.store.specs if name.startswith("heartbeat/"))
    return GIVEN | {name: name.partition("/")[2] for name in heartbeats} | writers
