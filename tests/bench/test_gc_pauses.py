"""What a pause is, and what the machine is to blame for."""

import numpy as np
import pytest

from bench.gc_pauses import pauses_of
from vision_core.geometry import Floats

PICTURES, ROUNDS = 4, 25
BEGAN: Floats = np.arange(PICTURES * ROUNDS, dtype=np.float64) * 0.002
WORK = np.tile([0.0004, 0.0006, 0.0005, 0.0009], ROUNDS)


def test_pictures_that_take_longer_are_no_pauses() -> None:
    beyond, left = pauses_of(BEGAN, BEGAN + WORK, PICTURES, [])
    assert np.abs(beyond).max() == pytest.approx(0.0, abs=1e-12)
    assert np.array_equal(beyond, left)


def test_a_pause_stands_out() -> None:
    done = BEGAN + WORK
    done[41] += 0.0007
    beyond, left = pauses_of(BEGAN, done, PICTURES, [])
    assert beyond.argmax() == left.argmax() == 41
    assert left[41] == pytest.approx(0.0007)


def test_what_the_sleeper_overslept_meanwhile_is_taken_off() -> None:
    done = BEGAN + WORK
    done[41] += 0.0007
    woke = done[41] - 0.0001
    _, left = pauses_of(BEGAN, done, PICTURES, [[woke, 0.0005], [woke + 1.0, 0.5]])
    assert left[41] == pytest.approx(0.0002)


def test_only_the_part_within_the_frame_is_taken_off() -> None:
    done = BEGAN + WORK
    done[41] += 0.0007
    _, left = pauses_of(BEGAN, done, PICTURES, [[BEGAN[41] + 0.0002, 0.0006]])  # began before the frame
    assert left[41] == pytest.approx(0.0005)
