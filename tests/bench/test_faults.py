"""Silences are told from when views came."""

import numpy as np
from numpy.typing import NDArray

from bench.faults import silence_after
from vision_core.clock import NS_PER_MS, NS_PER_S

PERIOD = 33 * NS_PER_MS


def arrivals(*missing: range) -> NDArray[np.int64]:
    left = {number for numbers in missing for number in numbers}
    return np.array([number * PERIOD for number in range(300) if number not in left], dtype=np.int64)


def test_without_a_gap_the_silence_is_one_period() -> None:
    silence_s, until_s = silence_after(arrivals(), 100 * PERIOD + 1, 0.3)
    assert silence_s == PERIOD / NS_PER_S
    assert until_s < 0.9


def test_the_gap_after_the_fault_counts() -> None:
    silence_s, until_s = silence_after(arrivals(range(101, 111), range(200, 290)), 100 * PERIOD + 1, 0.3)
    assert round(silence_s * NS_PER_S / PERIOD) == 11
    assert round(until_s * NS_PER_S / PERIOD) == 11


def test_clients_that_never_hear_again_are_silent_for_ever() -> None:
    silence_s, _ = silence_after(arrivals(range(101, 300)), 100 * PERIOD + 1, 0.3)
    assert silence_s == float("inf")
