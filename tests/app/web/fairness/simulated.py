"""Records of fairness as a match would leave them, with an order of sending that a test chooses."""

from collections.abc import Callable, Sequence

import numpy as np

from vision_core.timing.histogram import bin_of
from vision_core.types.fairness import FAIRNESS, MATCH
from vision_core.types.tables import MAX_NUMBERS, Table

Order = Callable[[np.random.Generator, list[int]], Sequence[int]]
GRAB_TO_FIRST_US, GAP_US = 12_000.0, 3.0
"""From the grab to the first datagram, and between two of them."""
BLUE, YELLOW = tuple(range(5)), tuple(range(MAX_NUMBERS, MAX_NUMBERS + 5))
ALL = (*BLUE, *YELLOW)


def by_lot(random: np.random.Generator, robots: list[int]) -> Sequence[int]:
    """A fair order."""
    return [robots[place] for place in random.permutation(len(robots))]


def record_of(
    frames: int,
    order: Order = by_lot,
    robots: Callable[[int], Sequence[int]] = lambda _: ALL,
    seed: int = 1,
    late_us: Callable[[int], float] = lambda _: 0.0,
) -> Table:
    """A row of FAIRNESS. robots: who is sent frame number i; late_us: how much later a robot's datagram goes."""
    random = np.random.default_rng(seed)
    record: Table = np.zeros(1, dtype=FAIRNESS)[0]
    record["reason"], record["is_match"], record["seed"], record["began_s"] = MATCH, 1, 7, 1_700_000_000.0
    record["blue_name"], record["yellow_name"] = b"Graz <b>", "Köln".encode()
    for frame in range(frames):
        places = list(order(random, list(robots(frame))))
        count, blue = len(places), sum(robot < MAX_NUMBERS for robot in places)
        record["frames"][count] += 1
        record["blue"][count] += blue
        record["blue2"][count] += blue * blue
        lags = np.array([place * GAP_US + late_us(robot) for place, robot in enumerate(places)])
        for place, (robot, lag_us) in enumerate(zip(places, lags + GRAB_TO_FIRST_US, strict=True)):
            served = record["robots"][robot]
            served["sessions"], served["sent"] = 1, served["sent"] + 1
            served["places"][count * (count - 1) // 2 + place] += 1
            served["lag_us_sum"] += lag_us
            served["lag_us2_sum"] += lag_us**2
            served["lags"][bin_of(round(lag_us * 1000.0))] += 1
        is_blue = np.array(places) < MAX_NUMBERS
        record["spread_freedom"] += count - 1
        record["spread_us2_sum"] += ((lags - lags.mean()) ** 2).sum()
        if is_blue.any() and not is_blue.all():
            difference = lags[is_blue].mean() - lags[~is_blue].mean()
            record["compared"] += 1
            record["difference_us_sum"] += difference
            record["difference_us2_sum"] += difference**2
    return record
