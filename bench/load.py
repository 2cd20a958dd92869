"""Full background load: on each core a process of the ordinary policy that never sleeps.

python -m bench.load CORE PARENT        until PARENT ends it, or dies
"""

import contextlib
import os
import subprocess
import sys
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from vision_core.scheduling.attachment import end_with

TICKS_PER_S = os.sysconf("SC_CLK_TCK")


@dataclass(frozen=True, slots=True)
class Load:
    """Busy processes."""

    processes: dict[int, "subprocess.Popen[bytes]"]
    """By core."""
    began_s: float

    def shares(self) -> dict[int, float]:
        """How much of its core each has got since the beginning, 0..1: the more, the less others wanted."""
        elapsed_s = time.monotonic() - self.began_s
        return {core: _spent_s(process.pid) / elapsed_s for core, process in self.processes.items()}


@contextlib.contextmanager
def full_load() -> Iterator[Load]:
    """One busy process on each core that we may use, until the block ends."""
    processes: dict[int, subprocess.Popen[bytes]] = {}
    try:
        for core in sorted(os.sched_getaffinity(0)):
            command = [sys.executable, "-m", "bench.load", str(core), str(os.getpid())]
            processes[core] = subprocess.Popen(command, cwd=Path(__file__).resolve().parents[1])
        yield Load(processes, time.monotonic())
    finally:
        for process in processes.values():
            process.kill()
            process.wait()


def main(core: int, parent: int) -> None:
    """Be busy."""
    end_with(parent)
    os.sched_setaffinity(0, {core})
    while True:
        sum(range(1000))


def _spent_s(pid: int) -> float:
    """Processor time of a process [s]."""
    fields = Path(f"/proc/{pid}/stat").read_text(encoding="ascii").rsplit(")", 1)[1].split()
    return (int(fields[11]) + int(fields[12])) / TICKS_PER_S


if __name__ == "__main__":
    main(int(sys.argv[1]), int(sys.argv[2]))
