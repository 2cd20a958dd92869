"""``pslv top``: the real-time database of a running service, live."""

import sys
import time
from collections import deque
from typing import TYPE_CHECKING, Annotated

import typer
from rich.console import Console
from rich.live import Live
from rich.table import Table

from vision_core.errors import ServiceError

if TYPE_CHECKING:
    from vision_core.clock import Instant
    from vision_core.net.control import Attached

EVERY_S = 0.5
RATE_OVER = 8
"""Looks over which a rate is taken: with half a second in between, four seconds."""


def top(
    service: Annotated[str | None, typer.Argument(help="Which, when several run: pslv/8000.")] = None,
    once: Annotated[bool, typer.Option("--once", help="Print once, after a second, and end.")] = False,
) -> None:
    """Show the real-time database of a running service live: item, writer, rate, age, valid (Ctrl-C ends it)."""
    from vision_core.net.control import attach_to

    view = _View(attach_to(service or _the_only_one()))
    out = Console(highlight=False, width=None if sys.stdout.isatty() else 120)
    view.look()
    time.sleep(2 * EVERY_S)
    view.look()
    if once or not out.is_terminal:
        out.print(view.drawn())
        return
    try:
        with Live(view.drawn(), console=out, auto_refresh=False, screen=True) as live:
            while view.runs():
                view.look()
                live.update(view.drawn(), refresh=True)
                time.sleep(EVERY_S)
    except KeyboardInterrupt:
        return
    raise ServiceError(f"pslv top: {view.name}", found="the service has ended")


def _the_only_one() -> str:
    """The service that runs. Raises ServiceError when there is none, or when there are several."""
    from vision_core.net.control import running_services

    names = running_services()
    if len(names) == 1:
        return names[0]
    found = f"{len(names)} services that run: {', '.join(names)}" if names else "no service that runs here"
    raise ServiceError("pslv top", found=found, accepted="the name of one" if names else "pslv serve")


class _View:
    """What is shown."""

    def __init__(self, attached: "Attached") -> None:
        from vision_core.rtdb import records

        self._attached = attached
        self.name = attached.name
        self._readers = {name: attached.store.reader(name) for name in attached.store.specs}
        self._writers = _writers(attached)
        self._processes = records.PROCESSES.reader(attached.store)
        self._looks: deque[tuple[float, dict[str, int]]] = deque(maxlen=RATE_OVER + 1)

    def runs(self) -> bool:
        """Does the service still run?"""
        return self._attached.runs()

    def look(self) -> None:
        """Note how often every record was written."""
        self._looks.append((time.monotonic(), {name: reader.sequence for name, reader in self._readers.items()}))

    def drawn(self) -> Table:
        """One line per record, as it is now."""
        from vision_core.clock import MonotonicClock, seconds_between

        now = MonotonicClock().now()
        table = Table("item", "writer", "written", "rate [Hz]", "age", "valid", "bytes", box=None, pad_edge=False)
        for column in ("written", "rate [Hz]", "age", "bytes"):
            next(c for c in table.columns if c.header == column).justify = "right"
        (first_s, first), (last_s, last) = self._looks[0], self._looks[-1]
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
        """Beats of what ran once and is done: it is not expected to live."""
        timed = self._processes.read(now)
        rows = timed.value.processes if timed is not None else ()
        return {f"heartbeat/{row.name}" for row in rows if row.state == "done"}


def _writers(attached: "Attached") -> dict[str, str]:
    """Who writes each record, by the task table of the service's own settings."""
    from vision_core.clock import MonotonicClock
    from vision_core.rtdb import records
    from vision_core.tasks.table import GIVEN, task_table

    table = task_table(records.SERVICE.reader(attached.store).value(MonotonicClock().now()).settings)
    writers = {record: task.name for task in table for record in task.writes}
    for task in table:
        writers |= {f"task/{task.name}": task.name, f"timing/{task.name}": task.name}
    beats = (name for name in attached.store.specs if name.startswith("heartbeat/"))
    return dict.fromkeys(GIVEN, "supervisor") | {name: name.partition("/")[2] for name in beats} | writers
