"""A run is repeated from the state before it, and nobody sees a trace."""

import numpy as np
import pytest

from vision_core.native.rewind import Rewind


def test_arrays_are_as_before_the_last_run_and_then_as_after_it() -> None:
    counter, other = np.array([1]), np.array([[1.0, 2.0]])
    rewind = Rewind([counter, other])
    for _ in range(2):
        rewind.keep()
        counter += 1
        other *= 2.0
    with rewind.rewound() as was_run:
        assert was_run
        assert counter.tolist() == [2]
        assert other.tolist() == [[2.0, 4.0]]
        counter += 1
        assert counter.tolist() == [3], "the same run again gives the same"
        other[:] = 99.0
    assert counter.tolist() == [3]
    assert other.tolist() == [[4.0, 8.0]]


def test_without_a_run_there_is_nothing_to_repeat() -> None:
    counter = np.array([7])
    with Rewind([counter]).rewound() as was_run:
        assert not was_run
    assert counter.tolist() == [7]


def test_the_state_comes_back_also_after_an_error() -> None:
    counter = np.array([1])
    rewind = Rewind([counter])
    rewind.keep()
    counter += 1
    with pytest.raises(ZeroDivisionError), rewind.rewound():
        counter[:] = 1 // 0
    assert counter.tolist() == [2]
