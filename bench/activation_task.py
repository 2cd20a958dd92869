"""Task of the benchmark ``activation``: notes when it is called, in a file that outlives it.

The file lies in the folder that PSLV_BENCH_FOLDER names and has the task's name: int64, the first how many there are,
then the instants [ns of CLOCK_MONOTONIC].
"""

import mmap
import os
import time
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from vision_core.scheduling.handle import Handle, Step
from vision_core.scheduling.releases import RAN, Release, StepResult

FOLDER = "PSLV_BENCH_FOLDER"
ROOM = 100_000
"""Begins in a file: 80 minutes of 50 ms."""
WORD = 8


def start(handle: Handle) -> Step:
    """Make the file and touch all of it."""
    path = Path(os.environ[FOLDER]) / handle.task.name
    path.write_bytes(bytes(WORD * (ROOM + 1)))
    with path.open("r+b") as file:
        begins = memoryview(mmap.mmap(file.fileno(), 0)).cast("q")

    def step(_release: Release) -> StepResult:
        now = time.monotonic_ns()
        if begins[0] < ROOM:
            begins[begins[0] + 1] = now
            begins[0] += 1
        return RAN

    return step


def begins_of(path: Path) -> NDArray[np.int64]:
    """What a task has noted so far [ns of CLOCK_MONOTONIC]."""
    noted = np.fromfile(path, dtype=np.int64)
    return noted[1 : 1 + noted[0]]
