"""Gaps between views are attributed to faults."""

import numpy as np
from numpy.typing import NDArray

from bench.faults import longest_gap
from vision_core.clock import NS_PER_MS, NS_PER_S

PERIOD = 33 * NS_PER_MS


def arrivals(*missing: range) -> NDArray[np.int64]:
    left = {number for numbers in missing for number in numbers}
    return np.array([number * PERIOD for number in range(300) if number not in left], dtype=np.int64)


def test_without_a_fault_s_effect_the_longest_gap_is_one_period() -> None:
    gap_s, until_s = longest_gap(arrivals(), 100 * PERIOD + 1, 0.3)
    assert gap_s == PERIOD / NS_PER_S
    assert until_s < 0.9


def test_the_gap_after_the_fault_counts() -> None:
    gap_s, until_s = longest_gap(arrivals(range(101, 111), range(200, 290)), 100 * PERIOD + 1, 0.3)
    assert round(gap_s * NS_PER_S / PERIOD) == 11
    assert round(until_s * NS_PER_S / PERIOD) == 11


def test_the_gap_is_infinite_when_no_view_comes_after_the_fault() -> None:
    gap_s, _ = longest_gap(arrivals(range(101, 300)), 100 * PERIOD + 1, 0.3)
    assert gap_s == float("inf")
