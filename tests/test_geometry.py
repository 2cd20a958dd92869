"""Angles wrap, rotations form a group, frozen arrays stay as they are."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from vision_core.geometry import frozen, rotation, wrap_angle

ANGLES = st.floats(-1e4, 1e4)


@given(ANGLES)
def test_wrapped_angles_lie_in_one_turn_and_are_the_same(angle: float) -> None:
    wrapped = wrap_angle(angle)
    assert -math.pi <= wrapped < math.pi
    assert math.cos(wrapped) == pytest.approx(math.cos(angle), abs=1e-9)
    assert math.sin(wrapped) == pytest.approx(math.sin(angle), abs=1e-9)
    assert wrap_angle(wrapped) == pytest.approx(wrapped, abs=1e-12)


def test_half_a_turn_is_the_lower_end() -> None:
    assert wrap_angle(math.pi) == -math.pi
    assert wrap_angle(-math.pi) == -math.pi
    assert wrap_angle(0.0) == 0.0


@given(ANGLES, ANGLES)
def test_rotations_are_a_group(a: float, b: float) -> None:
    np.testing.assert_allclose(rotation(a) @ rotation(b), rotation(a + b), atol=1e-9)
    np.testing.assert_allclose(rotation(a) @ rotation(-a), np.eye(2), atol=1e-12)
    assert np.linalg.det(rotation(a)) == pytest.approx(1.0)


def test_rotations_are_anticlockwise() -> None:
    np.testing.assert_allclose(rotation(math.pi / 2) @ [1.0, 0.0], [0.0, 1.0], atol=1e-15)


def test_frozen_arrays_cannot_be_changed() -> None:
    array = frozen(np.zeros(3))
    with pytest.raises(ValueError, match="read-only"):
        array[0] = 1.0
