"""When something ran: noted in memory that is taken beforehand, saved when its process ends.

So noting costs a microsecond, and nobody has to read along: every activation is there, to the nanosecond.
"""

import os
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

Rows = NDArray[np.int64]
"""Shape (n, 5); columns:"""
DUE, BEGAN, DONE, IMAGE, FOUND = range(5)
"""Three instants [ns of CLOCK_MONOTONIC], the number of the image, and 1 when the thing was found in it."""
ROOM = 50_000
"""Runs; 41 minutes at 20 Hz. Later ones are not noted."""


class ActivationLog:
    """The runs of one thing."""

    def __init__(self) -> None:
        self._rows: Rows = np.empty((ROOM, 5), dtype=np.int64)
        self._rows.fill(0)  # touched: no page is missing later
        self._count = 0

    @property
    def rows(self) -> Rows:
        """What was noted so far."""
        return self._rows[: self._count]

    def note(self, due: int, began: int, done: int, image: int, *, found: bool) -> None:
        """One run."""
        if self._count < ROOM:
            self._rows[self._count] = due, began, done, image, found
            self._count += 1

    def save(self, folder: Path, name: str) -> None:
        """Save all runs, beside those of other processes of the same name. No folder: nobody wants to know."""
        if folder.is_dir():
            np.save(folder / f"{name}.{os.getpid()}.npy", self.rows)


def read_activations(folder: Path, name: str) -> Rows:
    """All runs of a name, in order."""
    parts = [np.load(path) for path in folder.glob(f"{name}.*.npy")]
    rows: Rows = np.concatenate([np.empty((0, 5), dtype=np.int64), *parts])
    return rows[rows[:, BEGAN].argsort(kind="stable")]
