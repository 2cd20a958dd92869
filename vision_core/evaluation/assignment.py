"""Pairs two sets one to one, as many as possible and then as near as possible."""

import numpy as np

from vision_core.geometry import Floats

FORBIDDEN = 1e9


def best_pairs(distances: Floats, tolerance: float) -> list[tuple[int, int]]:
    """Pairs (row, column) of distances, shape (n, m), none farther than the tolerance; inf where a pair is impossible.

    No other pairing has more pairs, none as large has a smaller sum of distances. By shortest augmenting
    paths (H. W. Kuhn, "The Hungarian method for the assignment problem", 1955).
    """
    if distances.shape[0] > distances.shape[1]:
        return sorted((row, column) for column, row in best_pairs(distances.T, tolerance))
    allowed = distances <= tolerance
    costs = np.where(allowed, distances, FORBIDDEN)
    row_of = _assigned(costs)
    pairs = [(row, column) for column, row in enumerate(row_of) if row >= 0 and allowed[row, column]]
    return sorted(pairs)


def _assigned(costs: Floats) -> list[int]:
    """The row of every column, -1 for none; every row has one. costs: shape (n, m), n <= m."""
    n, m = costs.shape
    row_price, column_price = np.zeros(n), np.zeros(m + 1)
    row_of = np.full(m + 1, -1)  # the last column is where a new row waits
    for row in range(n):
        row_of[m], column = row, m
        least, before, done = np.full(m, np.inf), np.full(m, m), np.zeros(m + 1, dtype=np.bool_)
        while row_of[column] >= 0:
            done[column] = True
            here = row_of[column]
            reduced = costs[here] - row_price[here] - column_price[:m]
            nearer = ~done[:m] & (reduced < least)
            least[nearer], before[nearer] = reduced[nearer], column
            following = int(np.argmin(np.where(done[:m], np.inf, least)))
            step = least[following]
            row_price[row_of[done]] += step
            column_price[done] -= step
            least[~done[:m]] -= step
            column = following
        while column != m:
            row_of[column] = row_of[before[column]]
            column = int(before[column])
    assigned: list[int] = row_of[:m].tolist()
    return assigned
