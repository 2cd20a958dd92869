"""The compiled cameras against the models they stand for."""

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.models.test_camera import GRID, cameras
from vision_core.geometry import Floats
from vision_core.models.camera import CameraModel, HomographyCamera, PinholeCamera
from vision_core.models.camera_kernels import (
    CameraMap,
    camera_map_from,
    field_and_scale,
    field_from_pixel,
    pixel_from_field,
)
from vision_core.models.camera_kernels import pixels_per_square_metre as compiled_scale

CORNERS = np.array([[-1.4, -1.15], [1.4, -1.15], [1.4, 1.15], [-1.4, 1.15]])
HEIGHTS = st.floats(0.0, 0.5)


def fields(camera: CameraMap, pixels: Floats, height_m: float) -> Floats:
    return np.array([field_from_pixel(camera, x, y, height_m) for x, y in pixels.tolist()])


def pixels_of(camera: CameraMap, points: Floats, height_m: float) -> Floats:
    return np.array([pixel_from_field(camera, x, y, height_m) for x, y in points.tolist()])


def check_same(camera: CameraModel, height_m: float) -> None:
    compiled = camera_map_from(camera)
    pixels = camera.pixel_from_field(GRID, height_m)
    np.testing.assert_allclose(pixels_of(compiled, GRID, height_m), pixels, atol=1e-9, rtol=1e-12)
    np.testing.assert_allclose(fields(compiled, pixels, height_m), camera.field_from_pixel(pixels, height_m), atol=1e-9)
    scales = [compiled_scale(compiled, x, y, height_m) for x, y in GRID.tolist()]
    np.testing.assert_allclose(scales, camera.pixels_per_square_metre(GRID, height_m), rtol=1e-7)
    local = [field_and_scale(compiled, x, y, height_m)[2] for x, y in pixels.tolist()]
    np.testing.assert_allclose(local, scales, rtol=2e-3)


@settings(deadline=None)  # the first call compiles
@given(cameras(), HEIGHTS)
def test_a_pinhole_is_the_same_compiled(camera: PinholeCamera, height_m: float) -> None:
    check_same(camera, height_m)


@settings(deadline=None)  # the first call compiles
@given(cameras(), HEIGHTS)
def test_a_homography_is_the_same_compiled(camera: PinholeCamera, height_m: float) -> None:
    check_same(HomographyCamera(camera.pixel_from_field(CORNERS), CORNERS, camera.position_m.tolist()), height_m)


@settings(deadline=None)  # the first call compiles
@given(cameras(), HEIGHTS)
def test_project_then_unproject_is_identity(camera: PinholeCamera, height_m: float) -> None:
    compiled = camera_map_from(camera)
    pixels = pixels_of(compiled, GRID, height_m)
    np.testing.assert_allclose(fields(compiled, pixels, height_m), GRID, atol=1e-9)


def test_what_no_ray_meets_and_what_lies_behind_has_no_place() -> None:
    camera = PinholeCamera(800.0, (320.0, 240.0), (0.0,) * 5, (0.0, 0.0, 4.0), (90.0, 0.0, 0.0))
    compiled = camera_map_from(camera)
    pixels, points = np.array([[320.0, 200.0], [320.0, 280.0]]), np.array([[0.0, 5.0], [0.0, -5.0]])
    np.testing.assert_allclose(fields(compiled, pixels, 0.0), camera.field_from_pixel(pixels), equal_nan=True)
    np.testing.assert_allclose(pixels_of(compiled, points, 0.0), camera.pixel_from_field(points), equal_nan=True)


def test_a_pixel_beyond_what_the_lens_can_show_has_no_place() -> None:
    camera = PinholeCamera(800.0, (320.0, 240.0), (-0.3, 0.0, 0.0, 0.0, 0.0), (0.0, 0.0, 4.0), (0.0, 0.0, 0.0))
    assert math.isnan(field_from_pixel(camera_map_from(camera), 5000.0, 240.0, 0.0)[0])


def test_one_signature_serves_both_models() -> None:
    lens = PinholeCamera(800.0, (320.0, 240.0), (0.0,) * 5, (0.0, 0.0, 4.0), (0.0, 0.0, 0.0))
    for camera in (lens, HomographyCamera(lens.pixel_from_field(CORNERS), CORNERS, (0.0, 0.0, 4.0))):
        check_same(camera, 0.1)
    functions: tuple[Any, ...] = field_from_pixel, pixel_from_field, compiled_scale
    assert [len(function.signatures) for function in functions] == [1, 1, 1]


def test_a_model_without_a_compiled_form_is_refused() -> None:
    class Other(CameraModel):
        def _floor_from_pixel(self, pixels: Floats) -> Floats:
            return pixels

        def _pixel_from_floor(self, points: Floats) -> Floats:
            return points

    with pytest.raises(TypeError, match="Other"):
        camera_map_from(Other((0.0, 0.0, 4.0)))
