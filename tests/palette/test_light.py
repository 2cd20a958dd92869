"""The light of a set-up, measured in pictures: what is black, what is carpet, and how much brighter it may get."""

import msgspec
import numpy as np
import pytest

from vision_core.color.light import field_samples
from vision_core.geometry import Bytes
from vision_core.models.camera_setup import CameraSetup
from vision_core.palette.light import BRIGHTEST, CARPET, light_from
from vision_core.settings.schema import Settings
from vision_core.venues.loader import load_settings

WHITE_SHARE = 0.05
"""Of the field that is white: lines."""


@pytest.fixture
def settings() -> Settings:
    return load_settings("demo-vsss")


def pictured(settings: Settings, carpet: float, gain: float = 1.0, black: float = 0.0) -> Bytes:
    """A field with a carpet of some level, rows of white on it, and a dark corner beside it, as a sensor shows it."""
    camera = CameraSetup.from_settings(settings)
    light = np.full(camera.black_image().shape, carpet)
    places = field_samples(camera.model, settings.field, camera.size_px, 0.0)
    for x, y in places[: round(WHITE_SHARE * len(places))]:
        light[y - 1 : y + 2, x - 1 : x + 2] = 200.0
    light[:20, :20] = 8.0
    noise = np.random.default_rng(1).normal(0.0, 1.0, light.shape)
    return np.clip(light * gain + black + noise, 0.0, 255.0).astype(np.uint8)


@pytest.mark.parametrize(("carpet", "gain"), [(40.0, 1.0), (40.0, 0.5), (90.0, 1.0)])
def test_a_black_floor_is_not_the_sensor_s_black(settings: Settings, carpet: float, gain: float) -> None:
    light = light_from(pictured(settings, carpet, gain), settings)
    assert light.black_bgr == (0.0, 0.0, 0.0)
    assert light.band == CARPET


@pytest.mark.parametrize("carpet", [9.0, 40.0])
def test_a_sensor_s_black_is_found_on_a_black_floor(settings: Settings, carpet: float) -> None:
    light = light_from(pictured(settings, carpet, 0.5, black=33.0), settings)
    np.testing.assert_allclose(light.black_bgr, 36.0, atol=3.0)


def test_a_floor_that_reflects_nothing_is_no_reference(settings: Settings) -> None:
    light = light_from(pictured(settings, 9.0), settings)
    assert light.band == BRIGHTEST
    assert light.reference_bgr is not None
    assert min(light.reference_bgr) > 100.0


def test_white_walls_are_looked_for_beside_a_black_floor(settings: Settings) -> None:
    walls = msgspec.structs.replace(settings.field, walls=True)
    walled = msgspec.structs.replace(settings, field=walls)
    shown = pictured(walled, 9.0)
    camera = CameraSetup.from_settings(walled)
    inside = field_samples(camera.model, walls, camera.size_px, 0.0)
    low, high = inside.min(axis=0), inside.max(axis=0)
    framed = np.full_like(shown, 180)
    framed[low[1] : high[1], low[0] : high[0]] = np.where(shown > 100, 12, shown)[low[1] : high[1], low[0] : high[0]]
    framed[:20, :20] = 5
    light = light_from(framed, walled)
    assert light.margin_m > 0.0
    assert light.reference_bgr is not None
    assert min(light.reference_bgr) > 100.0


def test_no_paper_saturates_when_the_picture_is_brightened(settings: Settings) -> None:
    shown = pictured(settings, 20.0, 0.25)
    camera = CameraSetup.from_settings(settings)
    places = field_samples(camera.model, settings.field, camera.size_px, 0.0)
    few = places[len(places) // 2 :][: round(0.004 * len(places))]
    shown[few[:, 1], few[:, 0]] = (20, 150, 150)
    light = light_from(shown, settings)
    assert 1.0 < light.gain_bgr[0] * 150 <= 245
