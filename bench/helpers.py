"""Helper processes that run beside a measurement, and waiting with a progress bar.

A helper is a module that prints ``ready``, works until its standard input ends, and then prints its report as JSON.
Helpers ask for SCHED_FIFO (``request_realtime``), so that other processes delay their measurements as little as
possible; each report names the scheduling policy that was granted.
"""

import gc
import json
import select
import subprocess
import sys
import time
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any, Self, TypeVar

from rich.console import Console
from rich.progress import track

from vision_core.scheduling.realtime import ask_priority, exact_timers

ROOT = Path(__file__).parents[1]
READY = "ready"
OBSERVER_PRIORITY = 38
"""Real-time priority of helpers that observe the pipeline: lower than that of every task on the frame path."""
STEP_S = 0.5

Report = dict[str, Any]
T = TypeVar("T")


class Helper:
    """A module that runs beside a measurement: ``python -m MODULE ARGUMENTS``."""

    def __init__(self, module: str, *arguments: object, descriptors: Sequence[int] = ()) -> None:
        """Start it and wait until it is ready. Raises RuntimeError when its first line is not ``ready``.

        descriptors: those that it inherits under the same numbers.
        """
        command = [sys.executable, "-m", module, *map(str, arguments)]
        pipe = subprocess.PIPE
        self.process = subprocess.Popen(command, stdin=pipe, stdout=pipe, text=True, cwd=ROOT, pass_fds=descriptors)
        assert self.process.stdout is not None
        if (line := self.process.stdout.readline().strip()) != READY:
            self.kill()
            raise RuntimeError(f"{module}: its first line is {line!r}; {READY!r} was expected")

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_error: object) -> None:
        self.kill()

    def send_line(self, line: str) -> None:
        """Write one line to its standard input."""
        assert self.process.stdin is not None
        self.process.stdin.write(f"{line}\n")
        self.process.stdin.flush()

    def finish(self) -> Report:
        """End its standard input and return its report. Raises RuntimeError when it failed."""
        output, _ = self.process.communicate()
        if self.process.returncode:
            raise RuntimeError(f"{self.process.args!r} ended with {self.process.returncode}; 0 was expected")
        report: Report = json.loads(output)
        return report

    def kill(self) -> None:
        """Kill it and close its pipes."""
        self.process.kill()
        self.process.wait()
        for pipe in (self.process.stdin, self.process.stdout):
            if pipe is not None:
                pipe.close()


def request_realtime(priority: int) -> str:
    """Ask for SCHED_FIFO and disable garbage collection in this process. Returns the policy that was granted."""
    gc.collect()
    gc.freeze()
    gc.disable()
    exact_timers()
    granted = ask_priority(priority)
    return f"{granted.policy} ({granted.refusal})" if granted.refusal else granted.policy


def has_stdin_ended(timeout_s: float = 0.0) -> bool:
    """Has standard input ended? Waits for it up to a timeout [s]."""
    return bool(select.select([sys.stdin], [], [], timeout_s)[0])


def with_progress(steps: Sequence[T], label: str) -> Iterator[T]:
    """Iterate over steps; a terminal shows a progress bar with a label."""
    console = Console(stderr=True)
    yield from track(steps, label, console=console, disable=not console.is_terminal, transient=True)


def wait_with_progress(duration_s: float, label: str) -> None:
    """Wait while a measurement runs [s]; a terminal shows a progress bar with a label."""
    begun = time.monotonic()
    count = max(round(duration_s / STEP_S), 1)
    for step in with_progress(range(count), label):
        time.sleep(max(begun + (step + 1) * duration_s / count - time.monotonic(), 0.0))
