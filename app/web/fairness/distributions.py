"""Probabilities of the tests, and how the places and lags of robots are distributed. Pure functions."""

import math

import numpy as np

from vision_core.geometry import Floats
from vision_core.timing.histogram import EDGES_S, Counts
from vision_core.types.fairness import MAX_ROBOTS, places_of
from vision_core.types.tables import Table

SHARES = 10
"""Parts of the order of sending that a picture shows."""


def two_sided_p(z: float) -> float:
    """Probability that a standard normal variable is at least as far from 0 as z."""
    return math.erfc(abs(z) / math.sqrt(2.0))


def chi_square_p(chi_square: float, freedom: int) -> float:
    """Probability that a chi-square variable is at least so large; 1 without degrees of freedom.

    The regularized incomplete gamma function Q(freedom / 2, chi_square / 2), whose series ends for whole freedoms
    (Abramowitz and Stegun, 26.4.4 and 26.4.5).
    """
    half = chi_square / 2.0
    if freedom < 1 or half <= 0.0:
        return 1.0
    is_odd = freedom % 2
    powers = np.arange(is_odd / 2.0, freedom / 2.0)
    series = sum(math.exp(power * math.log(half) - half - math.lgamma(power + 1.0)) for power in powers)
    return min((math.erfc(math.sqrt(half)) if is_odd else 0.0) + series, 1.0)


def place_shares(robots: Table) -> Floats:
    """Shares of the datagrams of some robots that were sent in each tenth of the order, first to last, shape (SHARES,).

    robots: SERVED, shape (n,). A place among fewer than ten datagrams counts in each tenth that it overlaps, as far as
    it does: when every place is as likely as any other, all shares are the same. All are 0 without datagrams.
    """
    found = np.zeros(SHARES)
    tenths = np.arange(SHARES + 1) / SHARES
    for count in range(1, MAX_ROBOTS + 1):
        counts = places_of(robots, count).sum(axis=0, dtype=np.float64)
        if counts.any():
            below = np.interp(tenths, np.arange(count + 1) / count, np.concatenate([[0.0], np.cumsum(counts)]))
            found += np.diff(below)
    total = found.sum()
    return found / total if total else found


def mean_place(robots: Table) -> float:
    """Mean place of some robots in the order of sending, 0 first .. 1 last; 0.5 is fair."""
    total, datagrams = 0.0, 0
    for count in range(1, MAX_ROBOTS + 1):
        counts = places_of(robots, count).sum(axis=0, dtype=np.int64)
        datagrams += int(counts.sum())
        total += float(counts @ np.arange(count)) / (count - 1) if count > 1 else 0.5 * int(counts[0])
    return total / datagrams if datagrams else 0.5


def lag_bins_ms(counts: Counts) -> list[tuple[float, int]]:
    """Upper end [ms] and count of each bin of a histogram that is not empty."""
    filled = np.flatnonzero(counts)
    return [(round(float(EDGES_S[1:][bin_] * 1000.0), 6), int(counts[bin_])) for bin_ in filled]
