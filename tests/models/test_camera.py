"""Maps between pixels and the field: round trips, and OpenCV as an independent reference."""

import math
from collections.abc import Sequence

import cv2
import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from vision_core.errors import SettingsError
from vision_core.geometry import Floats
from vision_core.models.camera import CameraModel, HomographyCamera, PinholeCamera, homography

GRID: Floats = np.array([(x, y) for x in np.linspace(-1.4, 1.4, 8) for y in np.linspace(-1.1, 1.1, 7)])
HIGHEST_M = 0.5
"""The planes that are looked at are at most so high."""


@st.composite
def cameras(draw: st.DrawFn) -> PinholeCamera:
    """Ceiling cameras as they are hung: tilted by up to 15 degrees, with a lens that bends lines visibly."""
    tilt = st.floats(-15.0, 15.0)
    small = st.floats(-0.002, 0.002)
    distortion = (draw(st.floats(-0.15, 0.05)), draw(st.floats(-0.02, 0.02)), draw(small), draw(small), 0.0)
    position_m = (draw(st.floats(-0.5, 0.5)), draw(st.floats(-0.5, 0.5)), draw(st.floats(3.0, 6.0)))
    rotation_deg = (draw(tilt), draw(tilt), draw(st.floats(-180.0, 180.0)))
    bare = PinholeCamera(1.0, (0.0, 0.0), (0.0,) * 5, position_m, rotation_deg)
    farthest = np.max(np.sum(bare.pixel_from_field(GRID, HIGHEST_M) ** 2, axis=1))
    assume(shows_each_place_once(distortion, float(farthest)))
    center_px = (draw(st.floats(250.0, 400.0)), draw(st.floats(180.0, 300.0)))
    return PinholeCamera(draw(st.floats(300.0, 2000.0)), center_px, distortion, position_m, rotation_deg)


def shows_each_place_once(distortion: Sequence[float], farthest: float) -> bool:
    """Does the radius in the picture grow with the radius in the plane of the lens? farthest: its largest square."""
    squares = np.linspace(0.0, farthest, 50)
    return bool(np.min(1.0 + 3.0 * distortion[0] * squares + 5.0 * distortion[1] * squares**2) > 0.1)


def straight_down(height_m: float = 4.0) -> PinholeCamera:
    return PinholeCamera(800.0, (320.0, 240.0), (0.0,) * 5, (0.0, 0.0, height_m), (0.0, 0.0, 0.0))


@given(cameras(), st.floats(0.0, 0.5))
def test_project_then_unproject_is_identity(camera: PinholeCamera, height_m: float) -> None:
    pixels = camera.pixel_from_field(GRID, height_m)
    np.testing.assert_allclose(camera.field_from_pixel(pixels, height_m), GRID, atol=1e-7)


@given(cameras(), st.lists(st.floats(0.0, 1.0), min_size=len(GRID), max_size=len(GRID)))
def test_opencv_projects_to_the_same_pixels(camera: PinholeCamera, heights: list[float]) -> None:
    matrix = np.array(
        [[camera.focal_px, 0.0, camera.center_px[0]], [0.0, camera.focal_px, camera.center_px[1]], [0, 0, 1]]
    )
    in_camera = (np.column_stack([GRID, heights]) - camera.position_m) @ camera.camera_from_field.T
    no_turn = no_shift = np.zeros(3)  # a camera that looks down is half a turn, where cv2.Rodrigues loses its digits
    expected, _ = cv2.projectPoints(in_camera, no_turn, no_shift, matrix, camera.distortion)
    found = camera.pixel_from_field(GRID, np.array(heights))
    np.testing.assert_allclose(found, np.asarray(expected).reshape(-1, 2), atol=1e-6)


def test_straight_down_image_x_is_field_x_and_image_y_is_minus_field_y() -> None:
    camera = straight_down()
    points = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]])
    np.testing.assert_allclose(camera.pixel_from_field(points), [[320.0, 240.0], [520.0, 240.0], [320.0, 40.0]])
    np.testing.assert_allclose(camera.ray_from_pixel(np.array([[320.0, 240.0]])), [[0.0, 0.0, -1.0]])


def test_a_high_marker_taken_for_the_floor_is_54_mm_too_far_out() -> None:
    # perception.md: 150 mm high, 1.4 m off axis, under a camera at 4 m
    camera = straight_down()
    pixel = camera.pixel_from_field(np.array([[1.4, 0.0]]), 0.15)
    mistaken = camera.field_from_pixel(pixel, 0.0)[0, 0] - 1.4
    assert mistaken == pytest.approx(0.0545, abs=1e-4)
    assert camera.field_from_pixel(pixel, 0.15)[0] == pytest.approx([1.4, 0.0])


@given(cameras())
def test_points_of_one_pixel_at_several_heights_lie_on_one_ray(camera: PinholeCamera) -> None:
    pixels = camera.pixel_from_field(GRID)
    low, middle, high = (camera.field_from_pixel(pixels, h) for h in (0.0, 0.1, 0.2))
    np.testing.assert_allclose(middle, (low + high) / 2.0, atol=1e-9)


def test_rays_above_the_horizon_meet_no_floor() -> None:
    camera = PinholeCamera(800.0, (320.0, 240.0), (0.0,) * 5, (0.0, 0.0, 4.0), (90.0, 0.0, 0.0))
    rays = camera.ray_from_pixel(np.array([[320.0, 200.0], [320.0, 280.0]]))
    assert sorted(np.sign(rays[:, 2]).tolist()) == [-1.0, 1.0]
    places = camera.field_from_pixel(np.array([[320.0, 200.0], [320.0, 280.0]]))
    assert np.isnan(places).any(axis=1).tolist() == (rays[:, 2] > 0.0).tolist()


def test_points_behind_the_camera_have_no_pixel() -> None:
    camera = PinholeCamera(800.0, (320.0, 240.0), (0.0,) * 5, (0.0, 0.0, 4.0), (90.0, 0.0, 0.0))
    pixels = camera.pixel_from_field(np.array([[0.0, 5.0], [0.0, -5.0]]))
    ahead = (camera.camera_from_field @ [0.0, 5.0, -4.0])[2] > 0.0
    assert np.isnan(pixels).any(axis=1).tolist() == [not ahead, ahead]


@given(cameras())
def test_scale_is_the_distance_between_neighboring_pixels_on_the_floor(camera: PinholeCamera) -> None:
    scale = camera.pixels_per_metre((0.3, 0.2), 0.1)
    square = np.array([[0.295, 0.195], [0.305, 0.195], [0.305, 0.205], [0.295, 0.205]])
    corners = camera.pixel_from_field(square, 0.1)
    x, y = corners.T
    area = abs(np.dot(x, np.roll(y, -1)) - np.dot(y, np.roll(x, -1))) / 2.0
    assert scale == pytest.approx(math.sqrt(area) / 0.01, rel=1e-2)


def test_scale_straight_down_is_focal_length_over_distance() -> None:
    assert straight_down().pixels_per_metre((1.0, 0.5)) == pytest.approx(200.0)
    assert straight_down().pixels_per_metre((1.0, 0.5), 0.8) == pytest.approx(250.0)


def test_a_homography_of_four_floor_points_is_the_pinhole_they_came_from() -> None:
    lens = PinholeCamera(700.0, (318.0, 241.0), (0.0,) * 5, (0.1, -0.2, 3.5), (3.0, -2.0, 20.0))
    corners = np.array([[-1.4, -1.15], [1.4, -1.15], [1.4, 1.15], [-1.4, 1.15]])
    flat = HomographyCamera(lens.pixel_from_field(corners), corners, (0.1, -0.2, 3.5))
    models: list[CameraModel] = [lens, flat]
    for height in (0.0, 0.14):
        first, second = (model.pixel_from_field(GRID, height) for model in models)
        np.testing.assert_allclose(first, second, atol=1e-6)
        np.testing.assert_allclose(flat.field_from_pixel(first, height), GRID, atol=1e-8)


def test_a_homography_from_more_points_averages_their_errors() -> None:
    lens = straight_down()
    rng = np.random.default_rng(5)
    noisy = lens.pixel_from_field(GRID) + rng.normal(0.0, 0.5, GRID.shape)
    matrix = homography(noisy, GRID)
    found = HomographyCamera(noisy, GRID, (0.0, 0.0, 4.0)).field_from_pixel(lens.pixel_from_field(GRID))
    assert matrix[2, 2] == 1.0
    assert np.sqrt(((found - GRID) ** 2).mean()) < 0.5 / 200.0 / 2.0  # half of one click's error


@pytest.mark.parametrize(
    "points",
    [
        [[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [0.0, 1.0]],
        [[0.0, 0.0], [1.0, 0.0], [1.0, 0.0], [0.0, 1.0]],
    ],
    ids=["three on a line", "two coincide"],
)
def test_points_that_do_not_span_the_field_are_refused(points: list[list[float]]) -> None:
    with pytest.raises(SettingsError, match="span the field"):
        HomographyCamera(np.array(points) * 100.0, np.array(points), (0.0, 0.0, 4.0))


def test_arrays_of_a_camera_are_read_only() -> None:
    camera = straight_down()
    for array in (camera.position_m, camera.center_px, camera.distortion, camera.camera_from_field):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 1.0
