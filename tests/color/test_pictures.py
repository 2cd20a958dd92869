"""Whole pictures in the color spaces are what the spaces say of each pixel."""

import numpy as np
import pytest

from vision_core.color.pictures import axis_pictures, ec_picture, ymp_picture
from vision_core.color.spaces import ec_from_bgr, hsv_from_bgr, ymp_from_bgr
from vision_core.geometry import Bytes


@pytest.fixture(scope="module")
def pixels() -> Bytes:
    return np.random.default_rng(4).integers(0, 256, (40, 50, 3), dtype=np.uint8)


def _turned(byte: Bytes, degrees: np.ndarray) -> np.ndarray:
    difference: np.ndarray = np.abs((byte.ravel() * (360.0 / 256.0) - degrees + 180.0) % 360.0 - 180.0)
    return difference


def test_ymp_and_ec_pictures_agree_with_the_spaces(pixels: Bytes) -> None:
    luma, module, phase = ymp_from_bgr(pixels).T
    strong = module > 30.0
    ymp, ec = ymp_picture(pixels), ec_picture(pixels)
    assert np.abs(ymp[..., 0].ravel() - luma).max() <= 1.0
    assert np.abs(ymp[..., 1].ravel() - module).max() <= 2.0
    assert _turned(ymp[..., 2], phase)[strong].max() < 3.0
    assert (ec[..., 1] == ymp[..., 2]).all()
    assert np.abs(ec[..., 2].ravel() / 255.0 - ec_from_bgr(pixels)[:, 2]).max() < 0.1


def test_no_saturation_wraps() -> None:
    """A module of 130 over a luma of 20 is 6.5: one byte would show it as a half."""
    dark_and_pure = np.array([[[255, 0, 0], [40, 0, 0], [0, 0, 60], [0, 0, 0]]], dtype=np.uint8)
    assert ec_picture(dark_and_pure)[0, :, 2].tolist() == [255, 255, 255, 0]


@pytest.mark.parametrize(("space", "names"), [("hsv", ["hue", "saturation"]), ("ymp", ["phase", "module"])])
def test_hues_are_shown_as_colors_that_have_them(pixels: Bytes, space: str, names: list[str]) -> None:
    shown = axis_pictures(pixels, space)
    assert list(shown) == names
    convert, axis, strength = (hsv_from_bgr, 0, 1) if space == "hsv" else (ymp_from_bgr, 2, 1)
    before, after = convert(pixels), convert(shown[names[0]])
    colored = before[:, strength] > (0.3 if space == "hsv" else 30.0)
    assert np.abs((after[:, axis] - before[:, axis] + 180.0) % 360.0 - 180.0)[colored].max() < 8.0


def test_greys_have_no_hue_to_show() -> None:
    greys = np.repeat(np.arange(0, 250, 10, dtype=np.uint8)[None, :, None], 3, axis=2)
    for space in ("hsv", "ymp", "ec"):
        hue, strength = axis_pictures(greys, space).values()
        assert (hue == 40).all()
        assert (strength == 0).all()
