"""Gated one-to-one assignment, greedy: the nearest pair first.

Robots do not pass through each other, and between two frames a robot moves less than its own width
from where it is predicted. So the nearest pair is a true pair, and greedy gives what an optimal
assignment gives; where it does not (something jumped), a minimal total distance would move a second,
well-tracked robot to make room for the first. Greedy leaves the sure ones alone.
"""

import numpy as np

from vision_core.geometry import Floats

GATE_SIGMAS = 3.0


def gates(variances: Floats, gate_m: float) -> Floats:
    """How far from its prediction each sighting may lie [m], shape (n,): gate_m, or three standard deviations
    of the distance where the prediction is less sure than that. variances: per axis, shape (n,) [m^2]."""
    return np.maximum(gate_m, GATE_SIGMAS * np.sqrt(variances))


def distances_between(places: Floats, found: Floats) -> Floats:
    """All distances [m] of n predictions and m sightings: shapes (n, 2), (m, 2) -> (n, m)."""
    steps = places[:, None, :] - found[None, :, :]
    return np.hypot(steps[:, :, 0], steps[:, :, 1])


def assign(distances: Floats, reach: Floats) -> list[tuple[int, int]]:
    """Pairs (row, column), each row and column at most once, nearest first.

    distances: shape (n, m) [m], inf where a pair is impossible; reach: the gate of each row, shape (n,) [m].
    """
    rows, columns = np.nonzero(distances <= np.minimum(reach, np.finfo(np.float64).max)[:, None])
    order = np.argsort(distances[rows, columns], kind="stable")
    pairs: list[tuple[int, int]] = []
    used_rows: set[int] = set()
    used_columns: set[int] = set()
    for row, column in zip(rows[order].tolist(), columns[order].tolist(), strict=True):
        if row not in used_rows and column not in used_columns:
            pairs.append((row, column))
            used_rows.add(row)
            used_columns.add(column)
    return pairs
