"""The carpet's end is found by its color, whatever stands on it; a wrong venue shows in the distances."""

import math
from pathlib import Path

import msgspec
import numpy as np
import pytest

from vision_core.capture.source import open_source
from vision_core.clock import ManualClock
from vision_core.geometry import Bytes, Floats
from vision_core.models.camera import CameraModel, PinholeCamera
from vision_core.models.camera_setup import CameraSetup
from vision_core.models.field import accepted_half_extent
from vision_core.native.opencv import read_picture
from vision_core.regions.boundary import RAYS, BoundaryFinder
from vision_core.types.regions import FieldBoundary
from vision_core.venues.loader import load_settings

SETTINGS = load_settings()
FIELD = msgspec.structs.replace(SETTINGS.field, line_width_m=0.0)
SIZE = (320, 240)
GREEN, WOOD, BLACK = (40.0, 100.0, 35.0), (110.0, 140.0, 170.0), (25.0, 25.0, 25.0)


def camera_at(x_m: float = 0.0, height_m: float = 3.75) -> CameraModel:
    return PinholeCamera(350.0, (159.5, 119.5), (-0.09, 0.02, 0.0005, -0.0004, 0.0), (x_m, 0.0, height_m), (1, -1, 2))


def floor_points(camera: CameraModel) -> Floats:
    x, y = np.meshgrid(np.arange(SIZE[0]), np.arange(SIZE[1]))
    return camera.field_from_pixel(np.column_stack([x.ravel(), y.ravel()]).astype(np.float64))


def drawn(camera: CameraModel, *discs: tuple[float, float, float]) -> Floats:
    """A plain carpet on wood, shape (height, width, 3); discs: x, y and radius [m] of black things on it."""
    at = floor_points(camera)
    half_x, half_y = accepted_half_extent(FIELD)
    carpet = (np.abs(at[:, 0]) <= half_x) & (np.abs(at[:, 1]) <= half_y)
    colors = np.where(carpet[:, None], GREEN, WOOD)
    for x, y, radius in discs:
        colors[np.hypot(at[:, 0] - x, at[:, 1] - y) <= radius] = BLACK
    picture: Floats = colors.reshape(SIZE[1], SIZE[0], 3)
    return picture


def photographed(picture: Floats, noise: float = 3.0) -> Bytes:
    levels = picture + np.random.default_rng(1).normal(0.0, noise, picture.shape)
    return np.clip(levels.round(), 0.0, 255.0).astype(np.uint8)


def found_in(picture: Bytes, camera: CameraModel) -> FieldBoundary:
    return BoundaryFinder(FIELD, camera, SIZE).find(picture)


def off_px(boundary: FieldBoundary, camera: CameraModel) -> Floats:
    """How far each point of the rays that meet a wall lies from it [px]; nan where there is no point."""
    at = camera.field_from_pixel(np.array(boundary.points_px))
    angles = np.arange(RAYS) * (math.tau / RAYS)
    half_x, half_y = accepted_half_extent(FIELD)
    away = np.maximum(np.abs(at[:, 0]) - half_x, np.abs(at[:, 1]) - half_y) * camera.pixels_per_metre((0.0, 0.0))
    side = np.abs(np.tan(angles)) * half_x > FIELD.goal.width_m / 2.0
    walls: Floats = away[side]
    return walls


def test_the_boundary_is_where_the_carpet_ends() -> None:
    camera = camera_at()
    boundary = found_in(photographed(drawn(camera)), camera)
    assert len(boundary.points_px) == len(boundary.confidences) == RAYS
    assert boundary.found == 1.0
    assert np.abs(off_px(boundary, camera)).max() < 2.0
    assert boundary.error_px == pytest.approx(0.0, abs=0.5)
    assert boundary.off_px == pytest.approx(0.5, abs=0.5)
    assert min(boundary.confidences) > 0.9


def test_what_stands_on_the_carpet_is_bridged() -> None:
    camera = camera_at()
    rng = np.random.default_rng(2)
    discs = [(x, y, 0.09) for x, y in rng.uniform((-1.2, -0.95), (1.2, 0.95), (10, 2))]
    away = off_px(found_in(photographed(drawn(camera, *discs)), camera), camera)
    assert (np.abs(away) < 2.0).mean() > 0.85
    assert np.abs(np.median(away)) < 1.0


def test_uneven_light_and_a_shadow_are_no_end() -> None:
    camera = camera_at()
    picture = drawn(camera)
    at = floor_points(camera).reshape(SIZE[1], SIZE[0], 2)
    light = np.clip(1.2 - 0.25 * np.hypot(at[..., 0], at[..., 1]) + 0.1 * at[..., 0], 0.1, None)
    light[np.abs(at[..., 0] - 0.7) < 0.3] *= 0.65
    boundary = found_in(photographed(picture * light[..., None]), camera)
    assert boundary.found > 0.95
    assert (np.abs(off_px(boundary, camera)) < 2.5).mean() > 0.95


def test_a_field_that_is_larger_or_elsewhere_shows_in_the_distances() -> None:
    truly = camera_at()
    picture = photographed(drawn(truly))
    lower = found_in(picture, camera_at(height_m=3.55))
    assert lower.error_px is not None
    assert lower.error_px < -4.0
    shifted = found_in(picture, camera_at(x_m=0.1))
    assert shifted.off_px is not None
    straight = found_in(picture, truly)
    assert straight.off_px is not None
    assert shifted.off_px > straight.off_px + 1.0


def test_where_the_picture_ends_first_there_is_no_point() -> None:
    camera = camera_at(x_m=-0.5)  # the end at positive x is out of sight
    boundary = found_in(photographed(drawn(camera)), camera)
    points = np.array(boundary.points_px)
    seen = np.isfinite(points[:, 0])
    assert 0 < seen.sum() < RAYS
    assert not seen[0]
    assert seen[RAYS // 2]
    assert [confidence > 0.0 for confidence in boundary.confidences] == seen.tolist()


@pytest.mark.parametrize("picture", [np.full((SIZE[1], SIZE[0], 3), 90.0), np.zeros((SIZE[1], SIZE[0], 3))])
def test_a_picture_of_one_color_has_no_boundary(picture: Floats) -> None:
    boundary = found_in(photographed(picture), camera_at())
    assert boundary.found < 0.05
    assert boundary.error_px is boundary.off_px is None


def test_a_camera_that_sees_nothing_of_the_field_finds_nothing() -> None:
    camera = PinholeCamera(350.0, (159.5, 119.5), (0.0,) * 5, (30.0, 0.0, 3.75), (0, 0, 0))
    boundary = found_in(photographed(np.full((SIZE[1], SIZE[0], 3), 90.0)), camera)
    assert (boundary.found, boundary.error_px) == (0.0, None)


def test_another_picture_is_refused() -> None:
    finder = BoundaryFinder(FIELD, camera_at(), SIZE)
    with pytest.raises(ValueError, match="240, 320, 3"):
        finder.find(np.zeros((480, 640, 3), dtype=np.uint8))


@pytest.mark.slow
def test_the_synthetic_match() -> None:
    pixels = np.empty((SETTINGS.camera.height_px, SETTINGS.camera.width_px, 3), dtype=np.uint8)
    source = open_source(SETTINGS, CameraSetup.from_settings(SETTINGS), ManualClock(), paced=False)
    finder = BoundaryFinder(SETTINGS.field, CameraSetup.from_settings(SETTINGS).model, (640, 480))
    for _ in range(3):
        source.grab(pixels)
        boundary = finder.find(pixels)
        assert boundary.found > 0.9
        assert boundary.error_px == pytest.approx(0.0, abs=1.0)
        assert boundary.off_px is not None
        assert boundary.off_px < 2.5
    source.close()


@pytest.mark.slow
@pytest.mark.parametrize(("venue", "most_px"), [("ssl-rosenheim", 2.0), ("mirosot-agh-b", 2.0), ("sdp-2016", 5.0)])
def test_real_pictures(venue: str, most_px: float, real_pictures: Path) -> None:
    settings = load_settings(venue)
    size = (settings.camera.width_px, settings.camera.height_px)
    finder = BoundaryFinder(settings.field, CameraSetup.from_settings(settings).model, size)
    files = [file for file in (real_pictures / venue).iterdir() if file.suffix in {".png", ".jpg"}]
    assert files
    for file in files:
        boundary = finder.find(read_picture(file))
        assert boundary.found > 0.9, file
        assert boundary.error_px is not None
        assert abs(boundary.error_px) < most_px, file
