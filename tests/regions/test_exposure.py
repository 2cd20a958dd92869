"""What is wrong with a picture's light is said; a good picture is not blamed."""

import numpy as np
import pytest

from vision_core.models.camera_setup import CameraSetup
from vision_core.regions.exposure import exposure_check, exposure_reasons, field_pixels
from vision_core.venues.loader import load_settings

SETTINGS = load_settings()
SIZE = (SETTINGS.camera.width_px, SETTINGS.camera.height_px)
POINTS = field_pixels(SETTINGS.field, CameraSetup.from_settings(SETTINGS).model, SIZE)


def picture(carpet: float, paint: float, painted: float = 0.02) -> np.ndarray:
    random = np.random.default_rng(3)
    grey = np.where(random.random((SIZE[1], SIZE[0])) < painted, paint, carpet) + random.normal(0.0, 3.0, SIZE[::-1])
    return np.repeat(np.clip(grey, 0.0, 255.0).astype(np.uint8)[..., None], 3, axis=2)


def test_good_light_gives_no_problem() -> None:
    for carpet, paint in ((80.0, 200.0), (20.0, 140.0), (120.0, 255.0)):
        assert exposure_reasons(picture(carpet, paint), POINTS) == ()


@pytest.mark.parametrize(
    ("pixels", "said"),
    [
        (picture(5.0, 12.0), "black"),
        (picture(30.0, 70.0), "too dark"),
        (picture(200.0, 255.0, 0.3), "over-exposed: 27%"),
        (np.full((SIZE[1], SIZE[0], 3), 128, dtype=np.uint8), "same color"),
    ],
)
def test_bad_light_is_named(pixels: np.ndarray, said: str) -> None:
    (reason,) = exposure_reasons(pixels, POINTS)
    assert said in reason.text


def test_a_camera_that_looks_elsewhere_is_named() -> None:
    (reason,) = exposure_reasons(picture(80.0, 200.0), np.empty((0, 2)))
    assert "no part of the field" in reason.text


def test_numbers_follow_the_light() -> None:
    dim, bright = (exposure_check(picture(carpet, 200.0), POINTS) for carpet in (40.0, 80.0))
    assert dim.reasons == bright.reasons == ()
    assert dim.median_luma == pytest.approx(40.0, abs=1.0)
    assert bright.median_luma == pytest.approx(80.0, abs=1.0)
    assert dim.brightest == pytest.approx(205.0, abs=5.0)
    assert dim.white == 0.0
    white = exposure_check(picture(120.0, 255.0, 0.1), POINTS).white
    assert white == pytest.approx(0.1, abs=0.02)


def test_a_picture_without_the_field_has_no_figures() -> None:
    check = exposure_check(picture(80.0, 200.0), np.empty((0, 2)))
    assert check.brightest is check.median_luma is check.white is None
    assert check.reasons == exposure_reasons(picture(80.0, 200.0), np.empty((0, 2)))
