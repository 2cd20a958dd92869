"""Records every run of a task, in memory that is allocated beforehand, and saves it when the process ends.

Recording a run takes a microsecond and needs no other process.
"""

import os
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

Rows = NDArray[np.int64]
"""One row for each run, shape (n, 5); columns:"""
DUE, BEGAN, DONE, IMAGE, FOUND = range(5)
"""Three instants [ns of CLOCK_MONOTONIC], the image's number, and 1 when the detector found its object, else 0."""
MAX_RUNS = 50_000
"""41 minutes at 20 Hz. Later runs are not recorded."""


class ActivationLog:
    """The runs of one task or loop."""

    def __init__(self) -> None:
        self._rows: Rows = np.empty((MAX_RUNS, 5), dtype=np.int64)
        self._rows.fill(0)  # touches every page, so that none faults later
        self._count = 0

    @property
    def rows(self) -> Rows:
        """All runs recorded so far."""
        return self._rows[: self._count]

    def add(self, due: int, began: int, done: int, image: int, *, found: bool) -> None:
        """Record one run."""
        if self._count < MAX_RUNS:
            self._rows[self._count] = due, began, done, image, found
            self._count += 1

    def save(self, folder: Path, name: str) -> None:
        """Save all runs in a file of this process. Saves nothing when the folder does not exist."""
        if folder.is_dir():
            np.save(folder / f"{name}.{os.getpid()}.npy", self.rows)


def read_log(folder: Path, name: str) -> Rows:
    """All runs of a name, from the files of all processes, ordered by their beginning."""
    parts = [np.load(path) for path in folder.glob(f"{name}.*.npy")]
    rows: Rows = np.concatenate([np.empty((0, 5), dtype=np.int64), *parts])
    return rows[rows[:, BEGAN].argsort(kind="stable")]
