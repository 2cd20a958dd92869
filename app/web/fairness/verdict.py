"""The verdict on a record of fairness, in words, with the limits by which it was reached."""

from collections.abc import Iterable
from dataclasses import dataclass
from enum import StrEnum

from app.web.fairness.statistics import LagTest, OrderTest, PlacesTest

RARE = 0.001
"""A bias has to be less likely than this in a random order."""
ORDER_NOTICED, ORDER_PROVEN = 0.005, 0.02
"""Distance of the share of pairs in which blue is first from one half: a bias if it is more, fair if surely less."""
LAG_NOTICED, LAG_PROVEN = 0.01, 0.05
"""The same for the difference of the mean lags, as a share of the spread."""
PLACES_NOTICED = 0.05
"""How far the count of a place is from the expected one."""


class Judgment(StrEnum):
    """What a record shows."""

    IMPARTIAL = "impartial"
    NOT_PROVEN = "not_proven"
    """Too few frames, or only one team was served."""
    BIASED = "biased"


@dataclass(frozen=True, slots=True)
class Verdict:
    """The judgment with its reasons."""

    judgment: Judgment
    reasons: tuple[str, ...]
    """In words."""


def verdict_of(order: OrderTest, teams: PlacesTest, robots: list[PlacesTest], lag: LagTest) -> Verdict:
    """Judge the tests: biased if one of them shows it, impartial if the order and the lags surely are alike."""
    biases = (*_order_bias(order), *_lag_bias(lag), *_places_bias((teams, *robots[:1])))
    if biases:
        return Verdict(Judgment.BIASED, biases)
    if not order.pairs:
        return Verdict(Judgment.NOT_PROVEN, ("no frame was sent to both teams, so there is nothing to compare",))
    said = (_order_words(order), _lag_words(lag))
    is_proven = abs(order.blue_first - 0.5) + order.limit < ORDER_PROVEN and abs(lag.share) + lag.limit < LAG_PROVEN
    if is_proven:
        return Verdict(Judgment.IMPARTIAL, said)
    few = (
        f"too few frames: the share must surely lie within {_percent(ORDER_PROVEN, 0)} of one half, and the difference"
        f" of the lags within {_percent(LAG_PROVEN, 0)} of the spread"
    )
    return Verdict(Judgment.NOT_PROVEN, (few, *said))


def _order_bias(order: OrderTest) -> list[str]:
    if order.p < RARE and abs(order.blue_first - 0.5) > ORDER_NOTICED:
        return [f"the order of sending: {_order_words(order)}"]
    return []


def _lag_bias(lag: LagTest) -> list[str]:
    if lag.p < RARE and abs(lag.share) > LAG_NOTICED:
        return [f"the lag: {_lag_words(lag)}"]
    return []


def _places_bias(tests: Iterable[PlacesTest]) -> list[str]:
    return [
        f"{places.who}: a place in the order of sending comes {_percent(places.deviation, 0)} more or less often than"
        f" it should (chi-square {places.chi_square:.1f}, {places.freedom} degrees of freedom, p = {places.p:.2g})"
        for places in tests
        if places.p < RARE and places.deviation > PLACES_NOTICED
    ]


def _order_words(order: OrderTest) -> str:
    return (
        f"blue was sent its view before yellow in {_percent(order.blue_first, 2)} of {order.pairs} pairs; an order that"
        f" is drawn by lot gives 50 %, and {_percent(order.limit, 2)} more or less at most"
    )


def _lag_words(lag: LagTest) -> str:
    later = "blue" if lag.difference_us > 0.0 else "yellow"
    return (
        f"{later} was sent its views {abs(lag.difference_us):.3f} us later in the mean of {lag.frames} frames,"
        f" {_percent(abs(lag.share), 2)} of the spread of {lag.spread_us:.1f} us; the true share is at most"
        f" {_percent(lag.limit, 2)} off"
    )


def _percent(share: float, digits: int) -> str:
    return f"{100.0 * share:.{digits}f} %"
