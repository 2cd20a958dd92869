"""Obstacles are found where they stand, and nothing else is."""

import msgspec
import numpy as np
import pytest

from vision_core.errors import SettingsError
from vision_core.geometry import Bytes
from vision_core.models.camera_setup import CameraSetup
from vision_core.objects.obstacles import ObstacleFinder
from vision_core.types.objects import BallSighting, RobotSighting, Team
from vision_core.venues.loader import load_settings

SETTINGS = load_settings()
CAMERA = CameraSetup.from_settings(SETTINGS).model
WIDTH, HEIGHT = SETTINGS.camera.width_px, SETTINGS.camera.height_px
CARPET = (60.0, 110.0, 50.0)
GRID_PX = np.stack(np.meshgrid(np.arange(WIDTH), np.arange(HEIGHT)), axis=-1)
FLOOR_M = CAMERA.field_from_pixel(GRID_PX.reshape(-1, 2).astype(np.float64))


def finder() -> ObstacleFinder:
    field, robots, radius = SETTINGS.field, SETTINGS.robots, SETTINGS.ball.radius_m
    return ObstacleFinder(field, robots, radius, CAMERA, (WIDTH, HEIGHT), SETTINGS.obstacles)


def picture(*discs: tuple[float, float, float, tuple[float, float, float]], light: float = 1.0) -> Bytes:
    """A carpet with noise on which flat discs lie: x, y, radius [m], color."""
    image = np.tile(np.array(CARPET), (len(FLOOR_M), 1))
    for x, y, radius, color in discs:
        image[np.hypot(FLOOR_M[:, 0] - x, FLOOR_M[:, 1] - y) <= radius] = color
    noise = np.random.default_rng(1).normal(0.0, 3.0, image.shape)
    return np.clip(image * light + noise, 0.0, 255.0).astype(np.uint8).reshape(HEIGHT, WIDTH, 3)


def robot(x_m: float, y_m: float) -> RobotSighting:
    return RobotSighting(Team.BLUE, 1, 0.0, 0.0, x_m, y_m, 0.0, 1.0, 0.001, 0.01)


BAG = (0.5, -0.4, 0.1, (30.0, 30.0, 160.0))


def test_an_empty_field_shows_nothing() -> None:
    assert finder().find(picture(), (), ()) == ()


def test_a_thing_is_found_where_it_lies() -> None:
    (thing,) = finder().find(picture(BAG), (), ())
    assert (thing.x_m, thing.y_m) == pytest.approx(BAG[:2], abs=0.03)
    assert thing.radius_m == pytest.approx(BAG[2], abs=0.02)


def test_it_stays_an_obstacle() -> None:
    one = finder()
    assert all(len(one.find(picture(BAG), (), ())) == 1 for _ in range(100))


def test_what_is_known_is_no_obstacle() -> None:
    ball = BallSighting(0.0, 0.0, -0.5, 0.3, 1.0, 0.001)
    image = picture((0.5, -0.4, 0.09, (20.0, 20.0, 20.0)), (-0.5, 0.3, 0.06, (0.0, 120.0, 250.0)))
    assert finder().find(image, (robot(0.5, -0.4),), (ball,)) == ()
    assert len(finder().find(image, (), ())) == 2


def test_a_robot_that_stood_on_a_line_leaves_no_obstacle_behind() -> None:
    one = finder()
    one.find(picture((0.0, 0.5, 0.09, (20.0, 20.0, 20.0))), (robot(0.0, 0.5),), ())
    assert one.find(picture(), (), ()) == ()


def test_a_shadow_is_no_obstacle_and_neither_is_dirt() -> None:
    shade = (CARPET[0] * 0.6, CARPET[1] * 0.6, CARPET[2] * 0.6)
    assert finder().find(picture((0.5, -0.4, 0.12, shade), (-0.5, 0.3, 0.02, (0.0, 0.0, 255.0))), (), ()) == ()


def test_light_that_changes_is_learned() -> None:
    one = finder()
    for light in np.linspace(1.0, 0.6, 60):
        assert one.find(picture(light=float(light)), (), ()) == ()
    one.find(picture(light=2.0), (), ())  # all lamps on at once: learned anew
    one.find(picture(light=2.0), (), ())
    assert len(one.find(picture(BAG, light=2.0), (), ())) == 1


def test_a_grid_that_would_fill_the_memory_is_refused() -> None:
    field = msgspec.structs.replace(SETTINGS.field, length_m=30.0, width_m=20.0)
    tiny = msgspec.structs.replace(SETTINGS.robots, radius_m=0.006)
    with pytest.raises(SettingsError, match=r"15\d{3} x 10\d{3} cells; accepted: at most 1000000 cells"):
        ObstacleFinder(field, tiny, SETTINGS.ball.radius_m, CAMERA, (WIDTH, HEIGHT), SETTINGS.obstacles)
