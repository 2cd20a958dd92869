"""Robots of every shipped pattern are drawn as their files say: colors in place, outlines round or square."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.capture.synthetic.scenes import plain_settings, render, scene
from vision_core.capture.synthetic.render import BODY_BGR, PLATE_BGR
from vision_core.capture.synthetic.sprites import meets_square, polygon_depth
from vision_core.capture.synthetic.truth import visible_share
from vision_core.geometry import rotation
from vision_core.models.camera_setup import CameraSetup
from vision_core.patterns.geometry import depth_mm, inner_points_mm
from vision_core.patterns.loader import load_pattern
from vision_core.patterns.paints import PAINTS_BGR
from vision_core.types.objects import Team
from vision_core.venues.loader import config_folder

SHIPPED = sorted(path.stem for path in (config_folder() / "patterns").glob("*.toml"))
CLOSE = {
    "camera__width_px": 320,
    "camera__height_px": 240,
    "camera__pinhole__focal_px": 1400.0,
    "camera__pinhole__center_px": [160.0, 120.0],
    "camera__pinhole__position_m": [0.2, 0.1, 2.0],
}
"""A robot in the picture's middle is seen with more than half a pixel per millimetre."""
LOW = {"camera__pinhole__position_m": [0.0, 0.0, 1.0], "camera__pinhole__focal_px": 250.0}
PLACE = (0.22, 0.09, 0.7)


@pytest.mark.slow
@pytest.mark.parametrize("name", SHIPPED)
def test_every_patch_has_its_color(name: str) -> None:
    pattern = load_pattern(name)
    settings = plain_settings(robots__pattern=name, **CLOSE)
    (pixels,) = render(settings, scene(PLACE))
    colors = pattern.colors_worn(Team.BLUE, 1)
    for patch, color in zip(pattern.patches, colors, strict=True):
        points = inner_points_mm(patch)
        points = points[depth_mm(patch, points) > 3.0] / 1e3
        places = points @ rotation(PLACE[2]).T + PLACE[:2]
        u, v = (
            np.rint(CameraSetup.from_settings(settings).model.pixel_from_field(places, pattern.robot.height_m))
            .astype(int)
            .T
        )
        assert np.abs(pixels[v, u].astype(int) - PAINTS_BGR[color]).max() <= 1, color


@pytest.mark.slow
def test_a_square_robot_is_square() -> None:
    settings = plain_settings(robots__pattern="vsss-diagonal", **CLOSE)
    (pixels,) = render(settings, scene(PLACE))
    side = 0.0375
    for x, y, inside in ((0.95, -0.95, True), (-0.95, 0.95, True), (1.15, -1.15, False), (-1.1, 0.0, False)):
        place = np.array([[x * side, y * side]]) @ rotation(PLACE[2]).T + PLACE[:2]
        u, v = np.rint(CameraSetup.from_settings(settings).model.pixel_from_field(place, 0.075)[0]).astype(int)
        near = min(np.abs(pixels[v, u].astype(int) - bgr).max() for bgr in (PLATE_BGR, BODY_BGR))
        assert bool(near <= 2) == inside, (x, y)


@pytest.mark.slow
def test_each_team_has_its_own_pattern() -> None:
    options = {"robots__blue__pattern": "vsss-diagonal", "robots__yellow__pattern": "mirosot-diagonal"}
    settings = plain_settings(**options, **CLOSE)
    (own,) = render(settings, scene(PLACE))
    (all_alike,) = render(plain_settings(robots__pattern="vsss-diagonal", **CLOSE), scene(PLACE))
    assert np.array_equal(own, all_alike)


def test_a_square_robot_hides_a_ball_behind_its_corner() -> None:
    settings = plain_settings(robots__pattern="vsss-diagonal", **LOW)
    camera = CameraSetup.from_settings(settings)
    half = settings.robots.radius_m
    behind = (1.0 + half + 0.5 * settings.ball.radius_m, 0.0)
    beside = (1.0, 2.0 * half)
    assert visible_share(scene((1.0, 0.0, 0.0), ball=behind), camera, settings) < 0.1
    assert visible_share(scene((1.0, 0.0, 0.0), ball=beside), camera, settings) == 1.0


POLYGONS = [load_pattern(name).patches[0] for name in ("t-plate", "vsss-corner-patch", "mirosot-diagonal")]


@given(st.integers(0, 2), st.floats(-80, 80), st.floats(-80, 80))
def test_depth_in_a_polygon_is_that_of_the_pattern(which: int, x: float, y: float) -> None:
    patch = POLYGONS[which]
    assert patch.polygon_mm is not None
    corners = np.array([(99.0, 99.0), *patch.polygon_mm])
    expected = depth_mm(patch, np.array([[x, y]]))[0]
    assert abs(polygon_depth(x, y, corners, 1, len(corners) - 1)) == pytest.approx(abs(expected), abs=1e-9)
    if abs(expected) > 1e-9:
        assert (polygon_depth(x, y, corners, 1, len(corners) - 1) > 0) == (expected > 0)


@given(*[st.floats(-3, 3)] * 4)
def test_a_line_meets_a_square_where_its_points_do(x1: float, y1: float, x2: float, y2: float) -> None:
    share = np.linspace(0.0, 1.0, 2001)
    largest = np.maximum(np.abs(x1 + share * (x2 - x1)), np.abs(y1 + share * (y2 - y1))).min()
    if abs(largest - 1.0) > 0.01:
        assert meets_square(x1, y1, x2, y2, 1.0) == (largest < 1.0)
