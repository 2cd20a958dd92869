"""Runs of equal samples along rays."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from vision_core.geometry import Bytes, Floats, Mask

Counts = NDArray[np.integer[Any]]


def ends_of_runs(mask: Mask) -> Counts:
    """The first sample at or after each one that is false, m for none; shape (n, m) like mask."""
    count = np.int32(mask.shape[1])
    ends = np.where(mask, count, np.arange(count, dtype=np.int32))
    return np.asarray(np.minimum.accumulate(ends[:, ::-1], axis=1)[:, ::-1])


def without_gaps(mask: Mask, longest: int) -> Mask:
    """The mask in which runs of at most so many false samples between true ones are true: a closing."""
    n, m = mask.shape
    grown = np.zeros((n, m + longest), dtype=np.bool_)
    for shift in range(longest + 1):
        grown[:, shift : shift + m] |= mask
    closed = grown[:, :m].copy()
    for shift in range(1, longest + 1):
        closed &= grown[:, shift : shift + m]
    return closed


def widths_around(mask: Mask) -> Counts:
    """How many neighbors along the first axis, which is a circle, are true without a gap, itself included."""
    twice = np.concatenate([mask, mask]).T
    ahead = ends_of_runs(twice) - np.arange(twice.shape[1])
    behind = ends_of_runs(twice[:, ::-1])[:, ::-1] - np.arange(twice.shape[1])[::-1]
    count = len(mask)
    widths = np.minimum(ahead[:, :count] + behind[:, count:] - 1, count)
    return np.asarray(np.where(mask, widths.T, 0))


def sums_before(values: Mask) -> Counts:
    """Number of true samples before each one and, at the end, of all: shape (n, m + 1)."""
    sums = np.zeros((len(values), values.shape[1] + 1), dtype=np.int32)
    np.cumsum(values, axis=1, out=sums[:, 1:])
    return sums


def crossings(rays: Bytes, first: Counts, settled: Counts, *, blur: int) -> Floats:
    """Where, in samples, each ray passes half-way from the color before a step to that behind it; shape (n,).

    rays: colors, shape (n, m, 3); first: the first sample of each ray that is no longer as before; settled: the first
    one that is as behind, both of shape (n,); blur: so many samples beside them may be mixed. Without room or without
    a clear step it is the middle between the first sample and the one before.
    """
    n, m, _ = rays.shape
    rows = np.arange(n)
    from_here = first - 2 * blur
    ends = settled + blur
    before = 0.5 * (_at(rays, from_here) + _at(rays, from_here + 1))
    step = 0.5 * (_at(rays, ends) + _at(rays, ends - 1)) - before
    size = np.square(step).sum(axis=1)
    width = int((ends - from_here).max(initial=0)) + 1
    window = from_here[:, None] + np.arange(width)
    colors = rays[rows[:, None], np.clip(window, 0, m - 1)] - before[:, None]
    share = np.einsum("nkc,nc->nk", colors, step) / np.maximum(size, 1.0)[:, None]
    passed = (share[:, 1:] >= 0.5) & (window[:, 1:] <= ends[:, None])
    k = passed.argmax(axis=1)
    low, high = share[rows, k], share[rows, k + 1]
    exact = from_here + k + (0.5 - low) / np.where(high > low, high - low, 1.0)
    clear = (from_here >= 0) & (ends < m) & (size > 1.0) & passed.any(axis=1) & (low < 0.5)
    return np.where(clear, exact, first - 0.5)


def _at(rays: Bytes, samples: Counts) -> Floats:
    """The color of one sample of each ray, the first or last one instead of none; shape (n, 3)."""
    inside = np.clip(samples, 0, rays.shape[1] - 1)
    return np.asarray(rays[np.arange(len(rays)), inside].astype(np.float64))
