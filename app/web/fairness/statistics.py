"""The tests of impartiality, computed from a record of fairness. Pure functions of its counts.

A random order makes every place equally likely in every frame, whoever else is served in it. So the expected counts are
exact for each number n of datagrams, and the statistics of different n add up.

* ``order_test``: is one team sent its views before the other? The sum of a team's places (Wilcoxon's rank sum), frame
  by frame; mean and variance are exact, also when robots come and go (van Elteren, 1960).
* ``team_places``: chi-square of the team's places. Its datagrams of one frame exclude each other's places, so the
  covariance is that of drawing without replacement (Anderson, 1959).
* ``robot_places``: chi-square of each robot's places; the probabilities are adjusted for their number (Holm, 1979).
* ``lag_test``: the difference of the teams' mean lags within a frame. Frames are independent draws of the order, so
  Student's statistic of the paired differences holds, with the normal distribution for so many.
"""

import math
from dataclasses import dataclass, replace

import numpy as np

from app.web.fairness.distributions import chi_square_p, two_sided_p
from vision_core.geometry import Floats
from vision_core.types.fairness import MAX_ROBOTS, places_of, robot_of
from vision_core.types.tables import MAX_NUMBERS, Table

LEAST_EXPECTED = 5.0
"""Cells with a smaller expected count, or variance, are left out of chi-square."""
SURE_Z = 3.29
"""Limits are so many standard errors away: one in a thousand lies beyond them."""


@dataclass(frozen=True, slots=True)
class OrderTest:
    """Of all pairs of one datagram for blue and one for yellow in the same frame."""

    pairs: int
    blue_first: float
    """Share in which blue's was sent first; 0.5 is fair."""
    limit: float
    """The share that a random order would settle at is at most so far away."""
    z: float
    p: float


@dataclass(frozen=True, slots=True)
class PlacesTest:
    """Chi-square of places in the order of sending."""

    who: str
    chi_square: float
    freedom: int
    p: float
    """Adjusted for the number of tests."""
    deviation: float
    """The largest relative difference of a place's count from the expected one, where most frames were sent."""


@dataclass(frozen=True, slots=True)
class LagTest:
    """Blue's mean lag minus yellow's, over the frames in which both were sent datagrams."""

    frames: int
    difference_us: float
    error_us: float
    """Its standard error."""
    spread_us: float
    """Standard deviation of the lags of a frame's datagrams."""
    p: float

    @property
    def share(self) -> float:
        """The difference as a share of the spread."""
        return self.difference_us / self.spread_us if self.spread_us else 0.0

    @property
    def limit(self) -> float:
        """The true share is at most so far away."""
        return SURE_Z * self.error_us / self.spread_us if self.spread_us else math.inf


def order_test(record: Table) -> OrderTest:
    """Is one team sent its views before the other? record: a row of FAIRNESS."""
    pairs = 0
    excess = variance = 0.0
    for count in range(2, MAX_ROBOTS + 1):
        blue, blue2 = int(record["blue"][count]), int(record["blue2"][count])
        places = places_of(record["robots"][:MAX_NUMBERS], count).sum(axis=0, dtype=np.int64)
        pairs += count * blue - blue2
        excess += float(places @ np.arange(count)) - blue * (count - 1) / 2.0
        variance += (count + 1) / 12.0 * (count * blue - blue2)
    if not pairs:
        return OrderTest(0, 0.5, math.inf, 0.0, 1.0)
    z = -excess / math.sqrt(variance)
    return OrderTest(pairs, 0.5 - excess / pairs, SURE_Z * math.sqrt(variance) / pairs, z, two_sided_p(z))


def team_places(record: Table) -> PlacesTest:
    """Does a team have every place as often as it should? One team's test is the other's. record: a row of FAIRNESS."""
    cells = _Cells("the teams")
    for count in range(2, MAX_ROBOTS + 1):
        blue, blue2 = int(record["blue"][count]), int(record["blue2"][count])
        places = places_of(record["robots"][:MAX_NUMBERS], count).sum(axis=0, dtype=np.float64)
        cells.add(places, blue / count, blue / count - blue2 / count**2)
    return cells.test()


def robot_places(record: Table) -> list[PlacesTest]:
    """Does each robot have every place as often as any other? The least likely first. record: a row of FAIRNESS."""
    tests = []
    for index, robot in enumerate(record["robots"]):
        if not robot["places"].any():
            continue
        team, number = robot_of(index)
        cells = _Cells(f"{team} {number}")
        for count in range(2, MAX_ROBOTS + 1):
            places = places_of(robot, count).astype(np.float64)
            expected = places.sum() / count
            cells.add(places, expected, expected * (1.0 - 1.0 / count))
        tests.append(cells.test())
    return _adjusted(tests)


def lag_test(record: Table) -> LagTest:
    """Does one team get its views later than the other? record: a row of FAIRNESS."""
    frames = int(record["compared"])
    if frames < 2:
        return LagTest(frames, 0.0, math.inf, 0.0, 1.0)
    total, squares = float(record["difference_us_sum"]), float(record["difference_us2_sum"])
    mean = total / frames
    error = math.sqrt(max(squares - total * mean, 0.0) / (frames - 1) / frames)
    spread = math.sqrt(max(float(record["spread_us2_sum"]), 0.0) / int(record["spread_freedom"]))
    p = two_sided_p(mean / error) if error else float(mean == 0.0)
    return LagTest(frames, mean, error, spread, p)


class _Cells:
    """Collects chi-square over the numbers of datagrams."""

    def __init__(self, who: str) -> None:
        self._who = who
        self._chi_square, self._freedom = 0.0, 0
        self._most, self._deviation = 0.0, 0.0

    def add(self, places: Floats, expected: float, variance: float) -> None:
        """places: counts of every place; expected, variance: of each of them."""
        if variance < LEAST_EXPECTED or expected < LEAST_EXPECTED:
            return
        count = len(places)
        self._chi_square += float((count - 1) / count * ((places - expected) ** 2).sum() / variance)
        self._freedom += count - 1
        if expected * count > self._most:
            self._most, self._deviation = expected * count, float(np.abs(places / expected - 1.0).max())

    def test(self) -> PlacesTest:
        p = chi_square_p(self._chi_square, self._freedom)
        return PlacesTest(self._who, self._chi_square, self._freedom, p, self._deviation)


def _adjusted(tests: list[PlacesTest]) -> list[PlacesTest]:
    """Probabilities such that the least of several tests may be judged as one (Holm)."""
    ordered = sorted(tests, key=lambda test: test.p)
    found: list[PlacesTest] = []
    for place, test in enumerate(ordered):
        p = min((len(ordered) - place) * test.p, 1.0)
        found.append(replace(test, p=max(p, found[-1].p) if found else p))
    return found
