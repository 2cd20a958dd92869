"""Focal length, height and bend are one-to-one with A, B, C."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from vision_core.errors import SettingsError
from vision_core.models.hyperboloid import Hyperboloid
from vision_core.models.mirror import PAPER_MIRROR


def test_the_shape_of_the_papers_mirror() -> None:
    shape = Hyperboloid.of(PAPER_MIRROR)
    assert (shape.focal_px, shape.height_mm, shape.bend) == pytest.approx((300.0, 219.0, 1.739), rel=1e-3)


@given(st.floats(50.0, 2000.0), st.floats(50.0, 3000.0), st.floats(21.0, 253.0))
def test_there_and_back(focal_px: float, height_mm: float, horizon_px: float) -> None:
    bend = math.asinh(focal_px / horizon_px)
    mirror = Hyperboloid(focal_px, height_mm, bend).mirror()
    assert mirror.horizon_px == pytest.approx(horizon_px)
    back = Hyperboloid.of(mirror)
    assert (back.focal_px, back.height_mm, back.bend) == pytest.approx((focal_px, height_mm, bend), rel=1e-6)
    assert mirror.d == pytest.approx((focal_px / height_mm) ** 2, rel=1e-6)


def test_a_shape_that_is_no_allowed_mirror_says_why() -> None:
    assert Hyperboloid(300.0, 219.0, 0.5).constants[0] == pytest.approx(300.0 * math.cosh(0.5) / 219.0)
    with pytest.raises(SettingsError, match="20..254 px"):
        Hyperboloid(300.0, 219.0, 0.5).mirror()
