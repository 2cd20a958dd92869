"""Rigid fits of a marker pattern to blobs, as one compiled kernel."""

import math

import numpy as np

from vision_core.geometry import Floats
from vision_core.kernels import kernel

SCORE, CENTER, X, Y, HEADING, MATCHED, FIRST_DOT = range(7)
"""Columns of a hypothesis: its score 0..1, the number of its center blob, its pose [m, rad], how many
dots it has, then for each place of the pattern the number of the dot there, -1 for none."""

MOST_NEAR = 24
"""Dots looked at round one center; a real robot has as many as its pattern."""

GATHER = 1.5
"""Before the fit a dot may be this many tolerances off, as one dot alone fixed the heading."""


def propose(
    centers_m: Floats,
    center_likeness: Floats,
    dots_m: Floats,
    dot_likeness: Floats,
    slots_m: Floats,
    tolerance_m: float,
) -> Floats:
    """All ways to see a robot at each center: shape (n, 6 + slots), columns as named above.

    centers_m, dots_m: shape (n, 2) at marker height [m]; *_likeness: shape (n,), how well their sizes
    fit; slots_m: where the pattern has dots, in robot space [m]. The score is the share of the
    marker's dots that are there (the center counts) * 1 - (rms residual / tolerance)^2 * mean likeness.
    """
    most = len(centers_m) * min(len(dots_m), MOST_NEAR) * len(slots_m)
    rows = np.empty((most, FIRST_DOT + len(slots_m)))
    count = _propose(
        np.ascontiguousarray(centers_m), center_likeness, np.ascontiguousarray(dots_m), dot_likeness,
        slots_m, tolerance_m, rows,
    )  # fmt: skip
    return rows[:count]


@kernel
def _propose(
    centers: Floats,
    center_likeness: Floats,
    dots: Floats,
    dot_likeness: Floats,
    slots: Floats,
    tolerance: float,
    rows: Floats,
) -> int:
    reach = np.hypot(slots[:, 0], slots[:, 1])
    nearest, farthest = reach.min() - tolerance, reach.max() + tolerance
    near = np.empty(MOST_NEAR, dtype=np.int64)
    count = 0
    for center in range(len(centers)):
        found = 0
        for dot in range(len(dots)):
            distance = math.hypot(dots[dot, 0] - centers[center, 0], dots[dot, 1] - centers[center, 1])
            if nearest <= distance <= farthest and found < MOST_NEAR:
                near[found] = dot
                found += 1
        for first in near[:found]:
            for slot in range(len(slots)):
                row = rows[count]
                row[CENTER] = center
                heading = math.atan2(dots[first, 1] - centers[center, 1], dots[first, 0] - centers[center, 0])
                row[HEADING] = heading - math.atan2(slots[slot, 1], slots[slot, 0])
                _gather(centers[center], dots, near[:found], slots, GATHER * tolerance, row)
                misfit = _fit(centers[center], dots, slots, tolerance, row)
                if row[MATCHED] > 0 and misfit <= 1.0:
                    share = (1.0 + row[MATCHED]) / (1.0 + len(slots))
                    row[SCORE] = share * (1.0 - misfit) * _mean_likeness(center_likeness[center], dot_likeness, row)
                    count += 1
    return count


@kernel
def _gather(center: Floats, dots: Floats, near: np.ndarray, slots: Floats, gate: float, row: Floats) -> None:
    """For every place of the pattern the nearest dot within the gate, with the row's heading."""
    c, s = math.cos(row[HEADING]), math.sin(row[HEADING])
    row[MATCHED] = 0
    for slot in range(len(slots)):
        x = center[0] + c * slots[slot, 0] - s * slots[slot, 1]
        y = center[1] + s * slots[slot, 0] + c * slots[slot, 1]
        row[FIRST_DOT + slot] = -1
        best = gate
        for dot in near:
            distance = math.hypot(dots[dot, 0] - x, dots[dot, 1] - y)
            if distance <= best and not (row[FIRST_DOT : FIRST_DOT + slot] == dot).any():
                best = distance
                row[FIRST_DOT + slot] = dot
        if row[FIRST_DOT + slot] >= 0:
            row[MATCHED] += 1


@kernel
def _fit(center: Floats, dots: Floats, slots: Floats, tolerance: float, row: Floats) -> float:
    """Least-squares pose over the center and all gathered dots (Procrustes in the plane: Umeyama, 1991).

    Writes the pose; returns the mean squared residual in squared tolerances, inf when a dot is too far off.
    """
    number = 1.0 + row[MATCHED]
    mean_x, mean_y, model_x, model_y = center[0], center[1], 0.0, 0.0
    for slot in range(len(slots)):
        dot = int(row[FIRST_DOT + slot])
        if dot >= 0:
            mean_x += dots[dot, 0]
            mean_y += dots[dot, 1]
            model_x += slots[slot, 0]
            model_y += slots[slot, 1]
    mean_x, mean_y, model_x, model_y = mean_x / number, mean_y / number, model_x / number, model_y / number
    along = -model_x * (center[0] - mean_x) - model_y * (center[1] - mean_y)
    across = -model_x * (center[1] - mean_y) + model_y * (center[0] - mean_x)
    for slot in range(len(slots)):
        dot = int(row[FIRST_DOT + slot])
        if dot >= 0:
            a, b = slots[slot, 0] - model_x, slots[slot, 1] - model_y
            u, v = dots[dot, 0] - mean_x, dots[dot, 1] - mean_y
            along += a * u + b * v
            across += a * v - b * u
    row[HEADING] = math.atan2(across, along)
    c, s = math.cos(row[HEADING]), math.sin(row[HEADING])
    row[X] = mean_x - c * model_x + s * model_y
    row[Y] = mean_y - s * model_x - c * model_y
    misfit: float = _misfit(center, dots, slots, tolerance, row) / number
    return misfit


@kernel
def _misfit(center: Floats, dots: Floats, slots: Floats, tolerance: float, row: Floats) -> float:
    """Sum of squared residuals in squared tolerances; inf when one alone exceeds its tolerance."""
    c, s = math.cos(row[HEADING]), math.sin(row[HEADING])
    total: float = ((center[0] - row[X]) ** 2 + (center[1] - row[Y]) ** 2) / tolerance**2
    for slot in range(len(slots)):
        dot = int(row[FIRST_DOT + slot])
        if dot >= 0:
            x = row[X] + c * slots[slot, 0] - s * slots[slot, 1] - dots[dot, 0]
            y = row[Y] + s * slots[slot, 0] + c * slots[slot, 1] - dots[dot, 1]
            residual = (x * x + y * y) / tolerance**2
            total += residual if residual <= 1.0 else math.inf
    return total


@kernel
def _mean_likeness(center: float, dots: Floats, row: Floats) -> float:
    total = center
    for place in row[FIRST_DOT:]:
        if place >= 0:
            total += dots[int(place)]
    mean: float = total / (1.0 + row[MATCHED])
    return mean
