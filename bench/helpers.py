"""Processes beside a measurement: each says that it is ready, works until its standard input ends, and prints JSON.

They keep time as well as they may: ``keep_time`` asks for SCHED_FIFO and says what came of it.
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
BELOW_SERVE = 38
"""Real-time priority of who watches the pipeline: below everything between a frame and its datagrams."""
STEP_S = 0.5

Report = dict[str, Any]
T = TypeVar("T")


class Companion:
    """A module that runs beside a measurement: ``python -m MODULE ARGUMENTS``."""

    def __init__(self, module: str, *arguments: object) -> None:
        """Start it and wait until it is ready. Raises RuntimeError when it never is."""
        command = [sys.executable, "-m", module, *map(str, arguments)]
        pipe = subprocess.PIPE
        self.process = subprocess.Popen(command, stdin=pipe, stdout=pipe, text=True, cwd=ROOT)
        assert self.process.stdout is not None
        if (said := self.process.stdout.readline().strip()) != READY:
            self.kill()
            raise RuntimeError(f"{module} should say {READY!r}; it said {said!r}")

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_error: object) -> None:
        self.kill()

    def tell(self, line: str) -> None:
        """Say one line to it."""
        assert self.process.stdin is not None
        self.process.stdin.write(f"{line}\n")
        self.process.stdin.flush()

    def finish(self) -> Report:
        """End its work; what it found. Raises RuntimeError when it failed."""
        said, _ = self.process.communicate()
        if self.process.returncode:
            raise RuntimeError(f"{self.process.args!r} ended with {self.process.returncode}; 0 was expected")
        found: Report = json.loads(said)
        return found

    def kill(self) -> None:
        """End it, whatever it does."""
        self.process.kill()
        self.process.wait()
        for pipe in (self.process.stdin, self.process.stdout):
            if pipe is not None:
                pipe.close()


def keep_time(priority: int) -> str:
    """Ask for real-time priority, and have no garbage looked for; the policy that was obtained."""
    gc.collect()
    gc.freeze()
    gc.disable()
    exact_timers()
    granted = ask_priority(priority)
    return f"{granted.policy} ({granted.refusal})" if granted.refusal else granted.policy


def told_to_end(timeout_s: float = 0.0) -> bool:
    """Has standard input ended? Waits for it up to a timeout [s]."""
    return bool(select.select([sys.stdin], [], [], timeout_s)[0])


def stepwise(steps: Sequence[T], what: str) -> Iterator[T]:
    """One step after the other; a terminal sees how far they are."""
    console = Console(stderr=True)
    yield from track(steps, what, console=console, disable=not console.is_terminal, transient=True)


def sit_out(duration_s: float, what: str) -> None:
    """Let a measurement last [s]; a terminal sees how far it is."""
    begun = time.monotonic()
    count = max(round(duration_s / STEP_S), 1)
    for step in stepwise(range(count), what):
        time.sleep(max(begun + (step + 1) * duration_s / count - time.monotonic(), 0.0))
