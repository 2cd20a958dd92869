"""The task that ``activation`` measures: it records when it is called, in a file that outlives its process.

The file has the task's name and lies in the folder that PSLV_BENCH_FOLDER names. It holds int64: how many instants
follow, then the instants [ns of CLOCK_MONOTONIC].
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
MAX_ACTIVATIONS = 100_000
"""In a file: 80 minutes at 50 ms. Later ones are not recorded."""
WORD_BYTES = 8


def start(handle: Handle) -> Step:
    """Make the file and map it; writing all of it avoids page faults later."""
    path = Path(os.environ[FOLDER]) / handle.task.name
    path.write_bytes(bytes(WORD_BYTES * (MAX_ACTIVATIONS + 1)))
    with path.open("r+b") as file:
        words = memoryview(mmap.mmap(file.fileno(), 0)).cast("q")

    def step(_release: Release) -> StepResult:
        now = time.monotonic_ns()
        if words[0] < MAX_ACTIVATIONS:
            words[words[0] + 1] = now
            words[0] += 1
        return RAN

    return step


def activations_of(path: Path) -> NDArray[np.int64]:
    """All instants that a task has recorded so far, shape (n,) [ns of CLOCK_MONOTONIC]."""
    words = np.fromfile(path, dtype=np.int64)
    return words[1 : 1 + words[0]]
