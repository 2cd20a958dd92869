"""Histograms of durations: fine enough for a p99, small enough for shared memory, cheap enough for every frame.

As in an HDR histogram, an octave has 32 bins (3 % wide), from 1 us to 17 s: the index of a bin consists of the
position of the highest bit and of the five bits behind it, without a logarithm. Counts never decrease while a
process runs, so the difference of two readings is the histogram of the time between them.
"""

from collections.abc import Iterable, Mapping

import numpy as np
from numpy.typing import NDArray

from vision_core.clock import NS_PER_S
from vision_core.geometry import Floats

Counts = NDArray[np.uint64]

FIRST_BIT = 10
"""Durations shorter than 2^10 ns are in bin 0."""
OCTAVES = 24
BITS = 5
"""Of the position within an octave."""
PER_OCTAVE = 1 << BITS
BINS = 1 + OCTAVES * PER_OCTAVE


def bin_of(duration_ns: int) -> int:
    """Index of a duration's bin [ns]; a negative one is in bin 0, one beyond the last bin is in the last bin."""
    bit = duration_ns.bit_length() - 1
    if duration_ns < 0 or bit < FIRST_BIT:
        return 0
    number = 1 + ((bit - FIRST_BIT) << BITS) + ((duration_ns >> (bit - BITS)) & (PER_OCTAVE - 1))
    return min(number, BINS - 1)


def edges_s() -> Floats:
    """Lower edges of all bins and the upper edge of the last one [s], shape (BINS + 1,)."""
    octave, part = np.divmod(np.arange(BINS), PER_OCTAVE)
    begins = (PER_OCTAVE + part) * 2.0 ** (octave + FIRST_BIT - BITS)
    edges: Floats = np.concatenate([[0.0], begins]) / NS_PER_S
    return edges


EDGES_S = edges_s()


def quantile_s(counts: Counts, share: float) -> float | None:
    """The duration [s] below which a share 0..1 of all durations lies, interpolated within its bin; None: no durations.

    counts: shape (BINS,).
    """
    total = int(counts.sum())
    if not total:
        return None
    below = np.cumsum(counts)
    number = min(int(np.searchsorted(below, share * total, side="left")), BINS - 1)
    before = float(below[number - 1]) if number else 0.0
    inside = (share * total - before) / max(float(counts[number]), 1.0)
    return float(EDGES_S[number] + min(max(inside, 0.0), 1.0) * (EDGES_S[number + 1] - EDGES_S[number]))


class Histograms:
    """Several histograms by name, counted in lists of Python integers and encoded as one block."""

    def __init__(self, names: Iterable[str]) -> None:
        self.counts: dict[str, list[int]] = {name: [0] * BINS for name in names}

    def add(self, name: str, duration_ns: int) -> None:
        """Count a duration."""
        self.counts[name][bin_of(duration_ns)] += 1

    def encode(self) -> bytes:
        """All counts, one histogram after the other."""
        return np.array(list(self.counts.values()), dtype=np.uint64).tobytes()


def decode(names: Iterable[str], data: bytes) -> Mapping[str, Counts]:
    """The counts of an encoded block by name, each of shape (BINS,). Raises ValueError for another number of names."""
    listed = tuple(names)
    return dict(zip(listed, np.frombuffer(data, dtype=np.uint64).reshape(len(listed), BINS), strict=True))


def size_of(names: Iterable[str]) -> int:
    """Size of an encoded block [bytes]."""
    return 8 * BINS * len(tuple(names))
