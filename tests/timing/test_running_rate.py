"""A rate over the last seconds, from readings of a count."""

import pytest

from vision_core.clock import NS_PER_S, Instant
from vision_core.timing.running_rate import WINDOW_S, RunningRate


def at(seconds: float) -> Instant:
    return Instant(round(seconds * NS_PER_S))


def test_two_readings_make_a_rate() -> None:
    rate = RunningRate()
    assert rate.of(at(1.0), 100) == 0.0
    assert rate.of(at(1.5), 115) == pytest.approx(30.0)


@pytest.mark.parametrize("rate_hz", [1.25, 2.5, 29.97])
def test_readings_twice_a_second_measure_slow_rates(rate_hz: float) -> None:
    rate = RunningRate()
    rates = [rate.of(at(0.5 * k), int(0.5 * k * rate_hz)) for k in range(100)]
    assert all(abs(value - rate_hz) <= 1.0 / WINDOW_S for value in rates[20:])


def test_what_is_longer_ago_does_not_count() -> None:
    rate = RunningRate()
    for k in range(20):
        rate.of(at(0.5 * k), 1000 * min(k, 4))
    assert rate.of(at(10.0), 4000) == 0.0


def test_a_count_that_restarts_drops_earlier_readings() -> None:
    rate = RunningRate()
    rate.of(at(1.0), 1000)
    assert rate.of(at(2.0), 3) == 0.0
    assert rate.of(at(3.0), 33) == pytest.approx(30.0)
