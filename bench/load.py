"""Full background load: on each core a process of ordinary scheduling policy that never sleeps.

python -m bench.load CORE PARENT        until the process PARENT kills it or ends
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
    """The busy processes."""

    processes: dict[int, "subprocess.Popen[bytes]"]
    """By core."""
    began_s: float
    """[s of CLOCK_MONOTONIC]"""

    def shares(self) -> dict[int, float]:
        """Share of its core that each busy process has had since the beginning, 0..1, by core."""
        elapsed_s = time.monotonic() - self.began_s
        return {core: _cpu_time_s(process.pid) / elapsed_s for core, process in self.processes.items()}


@contextlib.contextmanager
def full_load() -> Iterator[Load]:
    """One busy process on each core that this process may use, until the block ends."""
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
    """Compute for ever on one core."""
    end_with(parent)
    os.sched_setaffinity(0, {core})
    while True:
        sum(range(1000))


def _cpu_time_s(pid: int) -> float:
    """CPU time of a process, user and system [s]."""
    fields = Path(f"/proc/{pid}/stat").read_text(encoding="ascii").rsplit(")", 1)[1].split()
    return (int(fields[11]) + int(fields[12])) / TICKS_PER_S


if __name__ == "__main__":
    main(int(sys.argv[1]), int(sys.argv[2]))
