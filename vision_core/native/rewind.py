"""A run can be repeated from the state before it, and leaves no trace: for rehearsals (scheduling.rehearser)."""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager

import numpy as np
from numpy.typing import NDArray

from vision_core.geometry import Bytes


class Rewind:
    """Arrays that a run changes, and what they held before the last run."""

    def __init__(self, arrays: Sequence[NDArray[np.generic]]) -> None:
        """arrays: each in one piece of memory."""
        self._arrays = tuple(array.reshape(-1).view(np.uint8) for array in arrays)  # copied without temporary memory
        self._before = tuple(np.zeros_like(array) for array in self._arrays)
        self._after = tuple(np.zeros_like(array) for array in self._arrays)
        self._is_kept = False

    def keep(self) -> None:
        """Remember what the arrays hold: a run follows."""
        _copy(self._arrays, self._before)
        self._is_kept = True

    @contextmanager
    def rewound(self) -> Iterator[bool]:
        """The arrays as before the last run, and afterwards as they are now; gives False when there was no run."""
        if not self._is_kept:
            yield False
            return
        _copy(self._arrays, self._after)
        _copy(self._before, self._arrays)
        try:
            yield True
        finally:
            _copy(self._after, self._arrays)


def _copy(source: Sequence[Bytes], target: Sequence[Bytes]) -> None:
    for one, other in zip(source, target, strict=True):
        np.copyto(other, one)
