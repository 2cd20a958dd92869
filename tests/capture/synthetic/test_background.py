"""The empty venue: lines and walls where the field model and the camera model put them, light as set."""

import numpy as np
import pytest

from tests.capture.synthetic.scenes import plain_settings, render, scene
from vision_core.capture.synthetic.background import make_background
from vision_core.geometry import Bytes, Floats
from vision_core.models.camera_setup import CameraSetup
from vision_core.settings.schema import Settings

pytestmark = pytest.mark.slow  # renders whole pictures


def picture_at(settings: Settings, image: Bytes, points: Floats, height_m: float = 0.0) -> Floats:
    """Mean grey at points of the field, shape (n, 2) [m]."""
    pixels = CameraSetup.from_settings(settings).model.pixel_from_field(points, height_m).round().astype(int)
    return np.asarray(image[pixels[:, 1], pixels[:, 0]].mean(axis=1))


def test_interpolated_floor_points_agree_with_the_camera_model() -> None:
    settings = plain_settings()
    camera = CameraSetup.from_settings(settings)
    floor = make_background(settings, camera).floor
    pixels = np.array([[0, 0], [1, 2], [318, 241], [637, 478], [639, 479], [101, 333]])
    expected = camera.model.field_from_pixel(pixels.astype(np.float64))
    found = floor[pixels[:, 1] + 1, pixels[:, 0] + 1]
    assert np.abs(found - expected).max() < 1e-5


def test_a_line_lies_where_the_field_model_puts_it() -> None:
    settings = plain_settings()
    (image,) = render(settings, scene((30.0, 30.0)))
    camera = CameraSetup.from_settings(settings)
    for y in (-0.9, -0.5, 0.5, 0.9):
        u, v = camera.model.pixel_from_field(np.array([[0.0, y]]))[0]
        row = image[round(v), round(u) - 8 : round(u) + 9, 2].astype(np.float64)
        weights = (row - np.median(row)).clip(8.0) - 8.0
        center = round(u) - 8 + float(weights @ np.arange(17.0)) / weights.sum()
        at_row = camera.model.pixel_from_field(np.array([[0.0, y], [0.0, y + 0.01]]))
        slope = (at_row[1, 0] - at_row[0, 0]) / (at_row[1, 1] - at_row[0, 1])
        assert center == pytest.approx(u + slope * (round(v) - v), abs=0.15)


def test_walls_stand_outside_the_carpet_and_their_tops_lean_outwards() -> None:
    settings = plain_settings()
    (image,) = render(settings, scene((30.0, 30.0)))
    along = np.column_stack([np.linspace(-1.0, -0.3, 20), np.full(20, 1.15)])
    inside, top = along + np.array([0.0, -0.03]), along + np.array([0.0, 0.012])
    assert picture_at(settings, image, inside).max() < 100
    assert picture_at(settings, image, top, settings.field.wall_height_m).min() > 170


def test_a_field_without_walls_has_carpet_beyond_its_lines() -> None:
    settings = plain_settings(
        field_preset="ssl-division-b", camera__pinhole__position_m=[3.5, 2.0, 4.0], camera__pinhole__focal_px=400.0
    )
    (image,) = render(settings, scene((30.0, 30.0)))
    beyond = np.column_stack([np.linspace(2.0, 4.6, 20), np.full(20, 3.2)])
    on_line = np.column_stack([np.linspace(2.0, 4.4, 20), np.full(20, 2.995)])
    assert picture_at(settings, image, beyond).max() < 100
    assert picture_at(settings, image, on_line).min() > 110


def test_light_falls_to_the_corners_as_set() -> None:
    settings = plain_settings(synthetic__vignetting=0.4)
    light = make_background(settings, CameraSetup.from_settings(settings)).light
    assert light[240, 320] == pytest.approx(1.0, abs=0.01)
    assert light[0, 0] == pytest.approx(0.6, abs=0.01)


def test_clutter_lies_beside_the_field_only() -> None:
    bare, cluttered = plain_settings(), plain_settings(synthetic__clutter=True)
    one = make_background(bare, CameraSetup.from_settings(bare))
    other = make_background(cluttered, CameraSetup.from_settings(cluttered))
    differs = (one.pixels != other.pixels).any(axis=2)
    place = np.abs(one.floor[1:-1, 1:-1][differs])
    assert differs.sum() > 500
    assert ((place[:, 0] > 1.4) | (place[:, 1] > 1.15)).all()
