"""Boxed arguments: kernels read and write the very arrays, which live as long as the box, and count no references."""

import gc
import weakref
from typing import NamedTuple

import numpy as np

from vision_core.geometry import Floats
from vision_core.native.kernels import Boxed, box, kernel


class Inner(NamedTuple):
    """A tuple within the tuple."""

    floats: Floats
    number: int


class Outer(NamedTuple):
    """What is boxed: arrays, tuples of them, what is no array, and another box."""

    inner: Inner
    masked: Floats | None
    details: Boxed


@kernel
def fill(boxed: Boxed, value: float) -> float:
    """Write into all arrays; returns what was in one of them."""
    outer: Outer = boxed.value
    before: float = outer.details.value[0][0]
    for array in (outer.inner.floats, outer.details.value[0]):
        array[:] = value + outer.inner.number
    return before


def boxed_arrays() -> tuple[Boxed, list[Floats]]:
    arrays = [np.zeros(1000), np.ones(500)]
    return box(Outer(Inner(arrays[0], 2), None, box((arrays[1],)))), arrays


def test_kernels_see_and_change_the_very_arrays() -> None:
    boxed, arrays = boxed_arrays()
    assert fill(boxed, 5.0) == 1.0
    assert all((array == 7.0).all() for array in arrays)
    assert fill(boxed, 6.0) == 7.0


def test_arrays_live_as_long_as_their_box() -> None:
    boxed, arrays = boxed_arrays()
    alive = [weakref.ref(array) for array in arrays]
    del arrays
    gc.collect()
    for value in range(100):
        fill(boxed, float(value))
    assert all(array() is not None for array in alive)
    del boxed
    gc.collect()
    assert all(array() is None for array in alive), "a box or a call of a kernel keeps them for ever"
