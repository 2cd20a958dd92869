"""Walls, ball, robots and the own body appear where geometry puts them."""

import math

import numpy as np
import pytest

from tests.onboard.scenes import Lab, lone_pair, orange, step_at
from vision_core.onboard.truth import ball_share, first_solids, seen_ball
from vision_core.settings.schema import Settings

pytestmark = pytest.mark.slow  # renders whole pictures
BARE = {"field__line_width_m": 0.0}


@pytest.fixture(scope="module")
def bare() -> Lab:
    """A field without lines, in the paper's size."""
    return Lab(lone_pair(**BARE))


@pytest.fixture(scope="module")
def large() -> Lab:
    return Lab(lone_pair(**BARE), (640, 480))


@pytest.mark.parametrize("distance_m", [0.3, 0.6, 1.0, 1.8])
def test_a_walls_foot_appears_at_the_radius_of_equation_1(bare: Lab, distance_m: float) -> None:
    picture = bare.picture((0.6, 1.15 - distance_m, 0.0))
    expected = bare.px_of(1000.0 * distance_m)
    radii = np.arange(expected - 4.0, expected + 2.6, 0.25)
    red = bare.along(picture, 90.0, radii)[:, 2]
    assert step_at(red, radii) == pytest.approx(expected, abs=0.2)


def test_a_walls_top_appears_where_the_line_of_sight_over_it_meets_the_floor(large: Lab) -> None:
    settings = large.camera.settings
    scene = large.scene((0.6, 0.65, 0.0))
    seen = first_solids(scene, np.array([90.0]))
    stretch = large.camera.shape.h_m / (large.camera.shape.h_m - settings.field.wall_height_m)
    assert seen.foot_mm[0] == pytest.approx(500.0)
    assert seen.face_end_mm[0] == pytest.approx(500.0 * stretch)
    assert seen.clear_mm[0] == pytest.approx(525.0 * stretch)
    expected = large.px_of(float(seen.clear_mm[0]))
    radii = np.arange(expected - 3.0, expected + 6.0, 0.25)
    blue = large.along(large.camera.exact_picture(scene), 90.0, radii)[:, 0]
    assert step_at(blue, radii) == pytest.approx(expected, abs=0.6)


@pytest.mark.parametrize(("x_m", "y_m"), [(0.35, 0.0), (0.0, 0.7)])
def test_the_balls_size_and_place(large: Lab, x_m: float, y_m: float) -> None:
    own = 0.0, 0.0, 0.0
    seen = orange(large.picture(own, ball=(x_m, y_m)))
    v, u = np.nonzero(seen)
    height, width = seen.shape
    forward, left = 0.5 * (height - 1) - v, 0.5 * (width - 1) - u
    radius_m, h_m, d_m = large.camera.settings.ball.radius_m, large.camera.shape.h_m, math.hypot(x_m, y_m)
    # the tangents of the sphere in the vertical plane through its center
    slant, half = math.atan2(d_m, h_m - radius_m), math.asin(radius_m / math.hypot(d_m, h_m - radius_m))
    nearest, farthest = (large.px_of(1000.0 * h_m * math.tan(slant + side * half)) for side in (-1, 1))
    radii = np.hypot(forward, left)
    assert radii.min() == pytest.approx(nearest, abs=1.5)
    assert radii.max() == pytest.approx(farthest, abs=1.5)
    # the azimuth that it spans, and its direction
    truth = seen_ball(large.scene(own, ball=(x_m, y_m)))
    assert truth.distance_mm == pytest.approx(1000.0 * d_m)
    assert truth.share == 1.0
    turned = np.arctan2(left, forward) - math.radians(truth.direction_deg)
    assert np.abs(turned).max() == pytest.approx(math.radians(0.5 * truth.size_deg), abs=1.5 / farthest)
    assert turned.mean() == pytest.approx(0.0, abs=0.5 / farthest)


def test_the_heading_points_up_and_left_is_left(bare: Lab) -> None:
    v, u = np.nonzero(orange(bare.picture((0.3, 0.2, 0.5 * math.pi), ball=(0.3, 0.6))))
    assert u.mean() == pytest.approx(159.5, abs=0.5)
    assert v.max() < 100
    _, u = np.nonzero(orange(bare.picture((0.3, 0.2, 0.5 * math.pi), ball=(-0.1, 0.2))))
    assert u.max() < 140


def with_height(height_m: float) -> Settings:
    return lone_pair(**BARE, robots__height_m=height_m)


def test_a_robot_as_high_as_the_viewpoint_hides_the_ball() -> None:
    lab = Lab(with_height(0.22))
    poses, ball = ((0.0, 0.0, 0.0), (0.5, 0.0, 0.0)), (0.9, 0.0)
    scene = lab.scene(*poses, ball=ball)
    assert np.isinf(first_solids(scene, np.zeros(1)).face_end_mm).all()
    assert ball_share(scene) == 0.0
    assert not orange(lab.picture(*poses, ball=ball)).any()
    assert ball_share(lab.scene(*poses, ball=(0.9, 0.5))) == 1.0


def test_a_low_robot_is_looked_over() -> None:
    lab = Lab(with_height(0.08))
    poses = (0.0, 0.0, 0.0), (0.4, 0.0, 0.0)
    seen = first_solids(lab.scene(*poses), np.zeros(1))
    front, back = 0.31, 0.455  # it looks the other way: its flat front is turned from us
    stretch = lab.camera.shape.h_m / (lab.camera.shape.h_m - 0.08)
    assert seen.foot_mm[0] == pytest.approx(1000.0 * front)
    assert seen.clear_mm[0] == pytest.approx(1000.0 * back * stretch)
    for x_m, visible in ((0.48, False), (0.9, True)):
        scene = lab.scene(*poses, ball=(x_m, 0.0))
        assert (ball_share(scene) == 1.0) == visible
        assert orange(lab.camera.exact_picture(scene)).any() == visible


def test_robots_cover_the_picture_from_the_foot_that_truth_names_on(bare: Lab) -> None:
    own, other = (0.2, -0.1, 0.3), (-0.1, -0.45, 2.0)
    empty, full = bare.picture(own), bare.picture(own, other)
    seen = first_solids(bare.scene(own, other), np.arange(360.0))
    changed = np.abs(full.astype(int) - empty).max(axis=2) > 30
    v, u = np.nonzero(changed)
    forward, left = 119.5 - v, 159.5 - u
    sector = np.round(np.degrees(np.arctan2(left, forward))).astype(int) % 360
    robot = np.flatnonzero(seen.kinds >= 16)
    assert len(robot) == 20
    for direction in robot[3:-3]:  # at its very sides the foot's radius changes within a pixel
        radii = np.hypot(forward, left)[np.abs(sector - direction) <= 1]
        nearest_mm = float(seen.foot_mm[direction - 1 : direction + 2].min())
        assert radii.min() == pytest.approx(bare.px_of(nearest_mm), abs=1.0)


def test_the_band_shows_the_team_and_the_top_the_marker() -> None:
    lab = Lab(lone_pair(**BARE), (640, 480))
    picture = lab.picture((0.0, 0.0, 0.0), (0.4, 0.0, math.pi))
    h_mm, height_mm = 1000.0 * lab.camera.shape.h_m, 1000.0 * lab.camera.settings.robots.height_m
    band_mm = (400.0 - 55.0) * h_mm / (h_mm - 0.6 * height_mm)
    marker_mm = 400.0 * h_mm / (h_mm - height_mm)
    blue, green, red = lab.along(picture, 0.0, np.array([lab.px_of(band_mm)]))[0]
    assert red > 2.0 * blue
    assert green > 2.0 * blue
    blue, green, red = lab.along(picture, 0.0, np.array([lab.px_of(marker_mm)]))[0]
    assert red > 150.0
    assert green > 150.0


def test_the_own_chassis_hides_the_nearest_floor_only(large: Lab) -> None:
    picture = large.picture((0.0, 0.0, 0.0))
    edge = large.px_of(1000.0 * large.camera.nearest_floor_m)
    assert large.camera.nearest_floor_m == pytest.approx(0.11)
    radii = np.arange(edge - 6.0, edge + 6.0, 0.25)
    green = large.along(picture, 180.0, radii)
    colored = green[:, 1] - green[:, 2]
    assert step_at(colored, radii) == pytest.approx(edge, abs=0.6)


def test_outside_of_the_mirror_it_is_dark(bare: Lab) -> None:
    picture = bare.picture((0.0, 0.0, 0.0))
    radii = np.array([bare.camera.rim_px - 2.0, bare.camera.rim_px + 2.0])
    inside, outside = bare.along(picture, 200.0, radii).mean(axis=1)
    assert inside > 80.0
    assert outside == pytest.approx(18.0)


def test_a_virtual_limit_is_a_line_that_begins_at_the_limit() -> None:
    lab = Lab(lone_pair(field_preset="ssl-division-b"), (640, 480))
    picture = lab.picture((0.0, 2.9, 0.0))
    line = 0.5 * (lab.px_of(580.0) + lab.px_of(590.0))
    radii = np.arange(line - 4.0, line + 4.1, 0.25)
    red = lab.along(picture, 90.0, radii)[:, 2]
    assert red.max() > red.min() + 60.0
    assert radii[int(red.argmax())] == pytest.approx(line, abs=0.75)


def test_larger_pictures_show_the_same(bare: Lab, large: Lab) -> None:
    poses = (0.1, 0.2, 0.7), (0.6, 0.1, 2.0)
    small = bare.picture(*poses).astype(np.float64)
    halved = large.picture(*poses).reshape(240, 2, 320, 2, 3).mean(axis=(1, 3))
    assert np.abs(small - halved).mean() < 1.5
