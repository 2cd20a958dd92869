"""Overlays: robots have their pattern's outline, and labels stay in the picture."""

import msgspec
import numpy as np
import pytest

from vision_core.clock import Instant
from vision_core.evaluation.overlay import TEAM_COLORS, draw_sightings
from vision_core.geometry import Bytes
from vision_core.models.camera_setup import CameraSetup
from vision_core.types.objects import BallSighting, RobotSighting, Sightings, Team
from vision_core.venues.loader import load_settings

SETTINGS = load_settings()
CAMERA = CameraSetup.from_settings(SETTINGS).model
HEIGHT_M = SETTINGS.robots.height_m
RADIUS_M = SETTINGS.robots.radius_m
BARE = np.full((480, 640, 3), (50, 100, 50), dtype=np.uint8)


def seen(*robots: RobotSighting, balls: tuple[BallSighting, ...] = ()) -> Sightings:
    return Sightings("main", 1, Instant(0), Instant(0), robots, balls, True)


def robot(x_m: float, y_m: float, heading_rad: float | None, team: Team = Team.YELLOW) -> RobotSighting:
    x_px, y_px = CAMERA.pixel_from_field(np.array([[x_m, y_m]]), HEIGHT_M)[0].tolist()
    return RobotSighting(team, 3, x_px, y_px, x_m, y_m, heading_rad, 0.9, 0.001, None)


def drawn(sightings: Sightings, outline: str) -> Bytes:
    robots = msgspec.structs.replace(SETTINGS.robots, outline=outline)
    return draw_sightings(BARE, sightings, CAMERA, msgspec.structs.replace(SETTINGS, robots=robots))


def is_marked(picture: Bytes, x_m: float, y_m: float) -> bool:
    """Is the team's color within 2 px of a point at marker height?"""
    x, y = CAMERA.pixel_from_field(np.array([[x_m, y_m]]), HEIGHT_M)[0].round().astype(int).tolist()
    near = picture[y - 2 : y + 3, x - 2 : x + 3].astype(int)
    return bool((np.abs(near - np.array(TEAM_COLORS[Team.YELLOW])).max(axis=-1) < 110).any())


@pytest.mark.parametrize("heading_rad", [0.0, 0.4, -2.5])
def test_a_square_robot_is_a_square_turned_by_its_heading(heading_rad: float) -> None:
    picture = drawn(seen(robot(0.5, 0.4, heading_rad)), "square")
    for corner in range(4):
        angle = heading_rad + np.pi / 4 + corner * np.pi / 2
        reach = RADIUS_M * np.sqrt(2.0)
        assert is_marked(picture, 0.5 + reach * np.cos(angle), 0.4 + reach * np.sin(angle))


@pytest.mark.parametrize(("outline", "heading_rad"), [("circle", 1.0), ("square", None)])
def test_a_round_robot_or_an_unknown_heading_is_a_circle(outline: str, heading_rad: float | None) -> None:
    picture = drawn(seen(robot(-0.5, 0.4, heading_rad)), outline)
    for angle in np.arange(8) * np.pi / 4:
        assert is_marked(picture, -0.5 + RADIUS_M * np.cos(angle), 0.4 + RADIUS_M * np.sin(angle))


def test_a_label_at_the_right_edge_is_written_to_the_left() -> None:
    x_m = float(CAMERA.field_from_pixel(np.array([[615.0, 240.0]]), HEIGHT_M)[0, 0])
    picture = drawn(seen(robot(x_m, 0.0, 0.5)), "circle")
    changed = (picture != drawn(seen(), "circle")).any(axis=-1)
    assert changed[:, 480:580].any()
    assert not changed[:, 639].any()


def test_robots_far_outside_are_left_out_and_the_picture_is_a_copy() -> None:
    before = BARE.copy()
    ball = BallSighting(700.0, 500.0, 2.0, -2.0, 0.9, 0.001)
    picture = drawn(seen(robot(30.0, 30.0, 0.0), balls=(ball,)), "circle")
    assert (before == BARE).all()
    assert picture.shape == BARE.shape
