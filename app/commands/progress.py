"""Lines for the log, and the progress of work that takes its time."""

import contextlib
import select
import sys

from rich.console import Console
from rich.status import Status

console = Console(stderr=True, highlight=False)


def print_line(line: str) -> None:
    """Write a line to the log. That nobody reads it, or its disk is full, is no reason to stop, nor to wait."""
    with contextlib.suppress(OSError):
        if select.select([], [sys.stderr], [], 0.0)[1]:
            print(line, file=sys.stderr, flush=True)


class Progress:
    """How far a work is: a spinner on a terminal, lines elsewhere."""

    def __init__(self, work: str = "compiling") -> None:
        self._work = work
        self._status: Status | None = None

    def show(self, text: str) -> None:
        """Show how far it is; the empty string ends it."""
        if not text:
            if self._status is not None:
                self._status.stop()
            self._status = None
        elif not console.is_terminal:
            print_line(f"{self._work}: {text}")
        elif self._status is None:
            self._status = console.status(f"{self._work}: {text}")
            self._status.start()
        else:
            self._status.update(f"{self._work}: {text}")
