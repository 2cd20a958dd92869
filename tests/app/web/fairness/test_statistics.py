"""The tests of impartiality: known probabilities, false alarms as often as they claim, biases found and named."""

import math
from collections.abc import Sequence

import numpy as np
import pytest

from app.web.fairness.distributions import chi_square_p, mean_place, place_shares, two_sided_p
from app.web.fairness.statistics import lag_test, order_test, robot_places, team_places
from app.web.fairness.verdict import Judgment, Verdict, verdict_of
from tests.app.web.fairness.simulated import ALL, BLUE, GAP_US, YELLOW, by_lot, record_of
from vision_core.types.tables import MAX_NUMBERS, Table


def verdict(record: Table) -> Verdict:
    return verdict_of(order_test(record), team_places(record), robot_places(record), lag_test(record))


@pytest.mark.parametrize(
    ("chi_square", "freedom", "p"),
    [
        (3.841459, 1, 0.05),
        (6.634897, 1, 0.01),
        (9.210340, 2, 0.01),
        (16.918978, 9, 0.05),
        (29.588298, 10, 0.001),
        (124.342113, 100, 0.05),
        (0.0, 5, 1.0),
        (4.0, 0, 1.0),
        (2000.0, 9, 0.0),
    ],
)
def test_probabilities_of_chi_square_are_those_of_the_tables(chi_square: float, freedom: int, p: float) -> None:
    assert chi_square_p(chi_square, freedom) == pytest.approx(p, rel=1e-5, abs=1e-12)


def test_probabilities_of_the_normal_distribution() -> None:
    assert two_sided_p(1.959964) == pytest.approx(0.05, rel=1e-5)
    assert two_sided_p(-3.290527) == pytest.approx(0.001, rel=1e-5)


def some_each_frame(frame: int) -> Sequence[int]:
    """Robots come and go: three to ten of them, and not alike of both teams."""
    random = np.random.default_rng(frame % 50)
    return [robot for robot in ALL if random.random() < (0.9 if robot in BLUE else 0.5)] or [0]


@pytest.mark.parametrize("robots", [lambda _: ALL, some_each_frame])
def test_a_fair_order_alarms_as_rarely_as_it_should(robots: object) -> None:
    """Two hundred matches: each probability is uniform, so its mean is one half and few are small."""
    found: list[tuple[float, float, float]] = []
    for seed in range(200):
        record = record_of(120, robots=robots, seed=seed)  # type: ignore[arg-type]
        found.append((order_test(record).p, team_places(record).p, lag_test(record).p))
    means, rare = np.mean(found, axis=0), np.mean(np.array(found) < 0.05, axis=0)
    assert np.abs(means - 0.5).max() < 4.0 * math.sqrt(1.0 / 12.0 / 200.0)
    assert rare.max() < 0.05 + 4.0 * math.sqrt(0.05 * 0.95 / 200.0)


def test_a_fair_match_is_impartial_and_a_short_one_is_not_proven() -> None:
    long, short = verdict(record_of(6000)), verdict(record_of(300))
    assert long.judgment is Judgment.IMPARTIAL
    assert short.judgment is Judgment.NOT_PROVEN
    assert "too few frames" in short.reasons[0]


def test_one_team_alone_proves_nothing() -> None:
    found = verdict(record_of(3000, robots=lambda _: BLUE))
    assert found.judgment is Judgment.NOT_PROVEN
    assert found.reasons == ("no frame was sent to both teams, so there is nothing to compare",)


def test_a_team_that_is_often_first_is_found() -> None:
    def favor(random: np.random.Generator, robots: list[int]) -> Sequence[int]:
        """In one frame of ten blue goes first."""
        order = by_lot(random, robots)
        return sorted(order, key=lambda robot: robot >= MAX_NUMBERS) if random.random() < 0.1 else order

    record = record_of(3000, favor)
    order = order_test(record)
    assert order.blue_first == pytest.approx(0.55, abs=0.015)
    assert lag_test(record).difference_us == pytest.approx(-0.1 * 5 * GAP_US, abs=0.5)
    found = verdict(record)
    assert found.judgment is Judgment.BIASED
    assert found.reasons[0].startswith("the order of sending: blue was sent its view before yellow in 5")
    assert found.reasons[1].startswith("the lag: yellow was sent its views ")


def test_a_robot_with_a_place_of_its_own_is_found_though_the_teams_are_alike() -> None:
    def middle(random: np.random.Generator, robots: list[int]) -> Sequence[int]:
        """Blue 3 is never first or last; its place has the right mean."""
        while (order := by_lot(random, robots))[0] == 2 or order[-1] == 2:
            pass
        return order

    record = record_of(4000, middle)
    assert order_test(record).p > 0.001
    assert robot_places(record)[0].who == "blue 3"
    found = verdict(record)
    assert found.judgment is Judgment.BIASED
    assert any(
        reason.startswith("blue 3: a place in the order of sending comes 100 % more or less")
        for reason in found.reasons
    )


def test_a_lag_that_does_not_come_from_the_order_is_found() -> None:
    record = record_of(3000, late_us=lambda robot: 2.0 if robot in YELLOW else 0.0)
    assert order_test(record).p > 0.001
    assert lag_test(record).difference_us == pytest.approx(-2.0, abs=0.3)
    assert [reason.partition(":")[0] for reason in verdict(record).reasons] == ["the lag"]


def test_shares_of_the_order_are_even_for_even_places_whatever_their_number() -> None:
    record = record_of(0)
    for count in (1, 3, 7, 10, 32):
        first = count * (count - 1) // 2
        record["robots"]["places"][4, first : first + count] = 11
    robots = record["robots"][4:5]
    assert place_shares(robots) == pytest.approx([0.1] * 10)
    assert mean_place(robots) == pytest.approx(0.5)
    record["robots"]["places"][4, 3] += 1000  # first of three
    assert place_shares(robots)[:3].min() > 0.2
    assert mean_place(robots) < 0.25
    assert place_shares(record["robots"][5:6]).sum() == 0.0
