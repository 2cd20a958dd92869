"""The color spaces, against an independent implementation and their own definitions."""

import colorsys
import math

import numpy as np
import pytest

from vision_core.color.spaces import CHROMA, bgr_from_ycc, ec_from_bgr, hsv_from_bgr, polar, ycc_from_bgr, ymp_from_bgr
from vision_core.geometry import Floats


@pytest.fixture(scope="module")
def bgr() -> Floats:
    """Random colors, all corners of the cube and some greys."""
    rng = np.random.default_rng(3)
    corners = [[b, g, r] for b in (0, 255) for g in (0, 255) for r in (0, 255)]
    greys = [[v, v, v] for v in (1, 100, 254)]
    return np.vstack([rng.integers(0, 256, (500, 3)), corners, greys]).astype(np.float64)


def test_hsv_agrees_with_the_standard_library(bgr: Floats) -> None:
    for row, (hue, saturation, value) in zip(bgr, hsv_from_bgr(bgr), strict=True):
        expected = colorsys.rgb_to_hsv(*(row[::-1] / 255.0))
        assert (hue / 360.0, saturation, value) == pytest.approx(expected, abs=1e-12)


def test_ymp_is_the_polar_form_of_bt601(bgr: Floats) -> None:
    for (blue, green, red), (luma, module, phase) in zip(bgr, ymp_from_bgr(bgr), strict=True):
        cb = -0.168736 * red - 0.331264 * green + 0.5 * blue
        cr = 0.5 * red - 0.418688 * green - 0.081312 * blue
        assert luma == pytest.approx(0.299 * red + 0.587 * green + 0.114 * blue)
        assert module * math.cos(math.radians(phase)) == pytest.approx(cb, abs=1e-3)
        assert module * math.sin(math.radians(phase)) == pytest.approx(cr, abs=1e-3)


def test_angles_are_in_one_turn_and_greys_have_none(bgr: Floats) -> None:
    hue, phase = hsv_from_bgr(bgr)[:, 0], ymp_from_bgr(bgr)[:, 2]
    assert ((hue >= 0.0) & (hue < 360.0)).all()
    assert ((phase >= 0.0) & (phase < 360.0)).all()
    assert hsv_from_bgr([[90, 90, 90]])[0, :2].tolist() == [0.0, 0.0]
    assert ymp_from_bgr([[90, 90, 90]])[0, 1] == pytest.approx(0.0, abs=1e-9)


def test_darkening_changes_neither_hue_nor_phase() -> None:
    bright = np.array([[40.0, 120.0, 240.0]])
    assert hsv_from_bgr(bright / 3)[0, 0] == pytest.approx(hsv_from_bgr(bright)[0, 0])
    assert ymp_from_bgr(bright / 3)[0, 2] == pytest.approx(ymp_from_bgr(bright)[0, 2])


def test_ec_is_the_hue_of_ymp_and_its_module_over_luma(bgr: Floats) -> None:
    for (luma, module, phase), (y, hue, saturation) in zip(ymp_from_bgr(bgr), ec_from_bgr(bgr), strict=True):
        assert y == luma
        assert math.isnan(hue) if module < 6.0 else hue == phase
        assert saturation == pytest.approx(min(module / max(luma, 16.0), 1.0))


def test_ec_of_black_is_finite_and_of_no_color() -> None:
    assert ec_from_bgr([[0, 0, 0]])[0, [0, 2]].tolist() == [0.0, 0.0]
    assert math.isnan(ec_from_bgr([[2, 0, 1]])[0, 1])


def test_the_chroma_table_is_the_polar_form_in_bytes() -> None:
    cb, cr = np.meshgrid(np.arange(-128.0, 128.0), np.arange(-128.0, 128.0), indexing="ij")
    module, phase = polar(cb, cr)
    assert np.abs(CHROMA[..., 0] - module).max() <= 0.5
    turned = (CHROMA[..., 1] * (360.0 / 256.0) - phase + 180.0) % 360.0 - 180.0
    assert np.abs(turned).max() <= 180.0 / 256.0 + 1e-9
    assert CHROMA[128, 128].tolist() == [0, 0]


def test_ycc_and_back(bgr: Floats) -> None:
    assert bgr_from_ycc(ycc_from_bgr(bgr)) == pytest.approx(bgr, abs=1e-9)
