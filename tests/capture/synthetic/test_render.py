"""Things are drawn where the camera model says, smear as they move, and hide what is behind them."""

import math
from typing import Any

import numpy as np
import pytest

from tests.capture.synthetic.scenes import blob, plain_settings, render, scene
from vision_core.capture.synthetic.render import TIME_ORDER
from vision_core.capture.synthetic.truth import visible_share
from vision_core.geometry import Bytes, Floats
from vision_core.models.camera_setup import CameraSetup
from vision_core.settings.schema import Settings

pytestmark = pytest.mark.slow  # renders whole pictures

LENSES: dict[str, dict[str, Any]] = {
    "default": {},
    "large": {
        "camera__width_px": 1280,
        "camera__height_px": 1024,
        "camera__pinhole__focal_px": 1420.0,
        "camera__pinhole__center_px": [637.1, 514.6],
    },
    "tilted fisheye": {
        "camera__pinhole__focal_px": 560.0,
        "camera__pinhole__distortion": [-0.25, 0.05, 0.002, -0.003, 0.0],
        "camera__pinhole__position_m": [-0.3, 0.4, 3.0],
        "camera__pinhole__rotation_deg": [8.0, 5.0, -20.0],
    },
    "coarse": {
        "camera__width_px": 320,
        "camera__height_px": 240,
        "camera__pinhole__focal_px": 350.0,
        "camera__pinhole__center_px": [159.5, 119.5],
    },
}
PLACES = (
    (0.0, 0.0, 0.3),
    (1.2, 0.95, 1.0),
    (-1.2, 0.95, -2.0),
    (-1.2, -0.95, 2.9),
    (1.2, -0.95, 0.0),
    (0.6, -0.3, -1.0),
)
LOW_CAMERA = {
    "camera__pinhole__focal_px": 400.0,
    "camera__pinhole__position_m": [0.0, 0.7, 2.0],
    "camera__pinhole__rotation_deg": [0.0, 0.0, 0.0],
}
"""Hangs low, so that robots hide much; straight below the row of things, clear of lines: y is 0.7."""


def center_dot(settings: Settings, pixels: Bytes, place: tuple[float, ...]) -> tuple[Floats, Floats]:
    """Centroid and spread of a blue center dot: what is bluer than the plate round it, 36 mm around its true place."""
    camera = CameraSetup.from_settings(settings)
    expected = camera.model.pixel_from_field(np.array([place[:2]]), settings.robots.height_m)[0]
    v, u = np.mgrid[0 : settings.camera.height_px, 0 : settings.camera.width_px]
    radius = 0.040 * camera.model.pixels_per_metre(place[:2], settings.robots.height_m)
    blueness = pixels[..., 0].astype(np.float64) - pixels[..., 2]
    near = np.hypot(u - expected[0], v - expected[1]) < radius
    return blob(np.where(near, blueness - np.median(blueness[near & (blueness < 20)]), 0.0).clip(0.0))


@pytest.mark.parametrize("lens", LENSES)
def test_the_center_dot_is_where_the_camera_model_says(lens: str) -> None:
    settings = plain_settings(**LENSES[lens])
    camera = CameraSetup.from_settings(settings)
    for place, image in zip(PLACES, render(settings, *(scene(place) for place in PLACES)), strict=True):
        expected = camera.model.pixel_from_field(np.array([place[:2]]), settings.robots.height_m)[0]
        if (expected > 12).all() and (expected < np.array(image.shape[1::-1]) - 12).all():
            found, _ = center_dot(settings, image, place)
            assert np.abs(found - expected).max() < 0.1, f"{lens} at {place}"


def test_the_height_shifts_the_center_dot_by_several_pixels() -> None:
    settings = plain_settings()
    place = (1.2, 0.95, 1.0)
    (image,) = render(settings, scene(place))
    on_floor = CameraSetup.from_settings(settings).model.pixel_from_field(np.array([place[:2]]), 0.0)[0]
    assert np.abs(center_dot(settings, image, place)[0] - on_floor).max() > 5.0


def test_heading_turns_the_dots_anticlockwise() -> None:
    """Id 1 wears green, green, pink, pink from the front left on: turned by 180 degrees the greens are on the right."""
    settings = plain_settings()
    ahead, turned = render(settings, scene((0.0, 0.0, 0.0)), scene((0.0, 0.0, math.pi)))
    camera = CameraSetup.from_settings(settings)
    for image, side in ((ahead, 1.0), (turned, -1.0)):
        for x, y in ((0.035, 0.054772), (-0.054772, 0.035)):
            u, v = camera.model.pixel_from_field(np.array([[side * x, side * y]]), settings.robots.height_m)[0].round()
            blue, green, red = image[int(v), int(u)]
            assert green > 150 > blue
            assert red < 120


def test_motion_blur_has_the_direction_of_motion_and_keeps_the_centroid() -> None:
    speed, exposure_s = 2.0, 0.020
    settings = plain_settings(synthetic__exposure_ms=exposure_s * 1e3)
    place = (0.1, 0.2, 0.5)
    still, moving = render(settings, scene(place), scene((*place, speed, 0.0, 0.0)))
    still_center, still_spread = center_dot(settings, still, place)
    center, spread = center_dot(settings, moving, place)
    smear_px = (
        speed
        * exposure_s
        * CameraSetup.from_settings(settings).model.pixels_per_metre(place[:2], settings.robots.height_m)
    )
    assert spread[0] - still_spread[0] == pytest.approx(smear_px**2 / 12.0, rel=0.2)
    assert spread[1] == pytest.approx(still_spread[1], rel=0.1)
    assert np.abs(center - still_center).max() < 0.1


def test_rows_and_columns_of_samples_have_the_same_mean_time() -> None:
    assert (TIME_ORDER.sum(axis=0) == 34).all()
    assert (TIME_ORDER.sum(axis=1) == 34).all()
    assert sorted(TIME_ORDER.ravel().tolist()) == list(range(1, 17))


def test_a_robot_hides_the_ball_behind_it_but_not_in_front_of_it() -> None:
    settings = plain_settings(**LOW_CAMERA)
    robot, behind, before = (1.0, 0.7, math.pi), (1.111, 0.7), (0.86, 0.7)
    elsewhere = (-1.0, 0.0)
    alone, hiding, showing, empty, ball_alone = render(
        settings, scene(robot), scene(robot, ball=behind), scene(robot, ball=before),
        scene(elsewhere), scene(elsewhere, ball=before),
    )  # fmt: skip
    assert np.array_equal(alone, hiding)
    assert changed(showing, alone) == pytest.approx(changed(ball_alone, empty), rel=0.05)
    camera = CameraSetup.from_settings(settings)
    assert visible_share(scene(robot, ball=behind), camera, settings) == 0.0
    assert visible_share(scene(robot, ball=before), camera, settings) == 1.0


def test_the_true_visible_share_is_the_share_of_its_pixels() -> None:
    settings = plain_settings(**LOW_CAMERA)
    robot = (1.0, 0.7, math.pi)
    balls = [(1.111 + 0.012 * step, 0.7) for step in range(10)]
    alone, *shown = render(settings, scene(robot), *(scene(robot, ball=ball) for ball in balls))
    empty, *free = render(settings, scene((-1.0, 0.0)), *(scene((-1.0, 0.0), ball=ball) for ball in balls))
    shares = [visible_share(scene(robot, ball=ball), CameraSetup.from_settings(settings), settings) for ball in balls]
    assert shares[0] == 0.0
    assert shares[-1] == 1.0
    for share, image, whole in zip(shares, shown, free, strict=True):
        assert changed(image, alone) / changed(whole, empty) == pytest.approx(share, abs=0.1)


def changed(image: Bytes, without: Bytes) -> float:
    """How much redder a ball makes an image."""
    return float((image[..., 2].astype(np.float64) - without[..., 2]).clip(0.0).sum())


def test_shadows_darken_the_carpet_and_nothing_else_changes_far_away() -> None:
    without = plain_settings()
    (bright,) = render(without, scene((0.0, 0.0, 0.0)))
    (dark,) = render(plain_settings(synthetic__shadows=0.5), scene((0.0, 0.0, 0.0)))
    change = bright[150:330, 220:420].astype(int) - dark[150:330, 220:420]
    assert change.min() >= 0
    assert change.max() > 20
    assert (change[:20] == 0).all()


def test_bodies_partly_outside_the_image_are_clipped() -> None:
    settings = plain_settings()
    empty, partly = render(settings, scene((30.0, 30.0, 0.0)), scene((1.62, 0.0, 0.0), ball=(-1.62, 1.2)))
    assert empty.shape == partly.shape
    assert not np.array_equal(empty, partly)
