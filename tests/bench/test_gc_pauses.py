"""Pauses of frames beyond the median of their picture, and the part that stalls of the machine explain."""

import numpy as np
import pytest

from bench.gc_pauses import pauses_of
from vision_core.geometry import Floats

PICTURES, ROUNDS = 4, 25
BEGAN: Floats = np.arange(PICTURES * ROUNDS, dtype=np.float64) * 0.002
WORK = np.tile([0.0004, 0.0006, 0.0005, 0.0009], ROUNDS)


def test_a_picture_that_always_takes_longer_is_no_pause() -> None:
    pauses, remaining = pauses_of(BEGAN, BEGAN + WORK, PICTURES, [])
    assert np.abs(pauses).max() == pytest.approx(0.0, abs=1e-12)
    assert np.array_equal(pauses, remaining)


def test_a_single_slow_frame_is_a_pause() -> None:
    done = BEGAN + WORK
    done[41] += 0.0007
    pauses, remaining = pauses_of(BEGAN, done, PICTURES, [])
    assert pauses.argmax() == remaining.argmax() == 41
    assert remaining[41] == pytest.approx(0.0007)


def test_a_stall_during_the_frame_is_subtracted() -> None:
    done = BEGAN + WORK
    done[41] += 0.0007
    woke = done[41] - 0.0001
    _, remaining = pauses_of(BEGAN, done, PICTURES, [[woke, 0.0005], [woke + 1.0, 0.5]])
    assert remaining[41] == pytest.approx(0.0002)


def test_only_the_part_of_a_stall_within_the_frame_is_subtracted() -> None:
    done = BEGAN + WORK
    done[41] += 0.0007
    _, remaining = pauses_of(BEGAN, done, PICTURES, [[BEGAN[41] + 0.0002, 0.0006]])  # the stall began before the frame
    assert remaining[41] == pytest.approx(0.0005)
