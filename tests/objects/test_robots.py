"""Robots read from small drawn pictures: every id in random poses, conflicts, unreadable markers."""

import math
from dataclasses import replace

import msgspec
import numpy as np
import pytest

from tests.objects.drawing import CODES, MARKER, SETTINGS, TABLE, Picture, overhead_camera, turn_between
from vision_core.camera_model import CameraModel
from vision_core.objects.robots import find_robots
from vision_core.types.blobs import Blobs
from vision_core.types.objects import RobotSighting, Team

WIDTH, HEIGHT = 120, 80


def picture(metres_per_pixel: float = 0.005) -> Picture:
    return Picture(overhead_camera(metres_per_pixel, WIDTH, HEIGHT), WIDTH, HEIGHT)


def seen_in(drawn: Picture, blobs: Blobs | None = None) -> tuple[tuple[RobotSighting, ...], tuple[str, ...]]:
    return find_robots(blobs or drawn.blobs(), TABLE, drawn.camera, MARKER, SETTINGS.robots)


def middle(camera: CameraModel) -> tuple[float, float]:
    x, y = camera.field_from_pixel(np.array([[WIDTH / 2, HEIGHT / 2]]), SETTINGS.robots.height_m)[0].tolist()
    return x, y


@pytest.mark.parametrize("number", range(16))
@pytest.mark.parametrize(
    ("metres_per_pixel", "teams"),
    [(0.005, {"blue": -0.11, "yellow": 0.11}), (0.0025, {"blue": 0.0}), (0.0025, {"yellow": 0.0})],
    ids=["dots of 8 px", "blue, dots of 16 px", "yellow, dots of 16 px"],
)
def test_every_id_in_random_poses(number: int, metres_per_pixel: float, teams: dict[str, float]) -> None:
    rng = np.random.default_rng(number)
    drawn = picture(metres_per_pixel)
    x, y = middle(drawn.camera)
    truth = []
    turn = math.radians(20.0)
    for team, offset in teams.items():
        u, v = rng.uniform(-0.01, 0.01, 2)
        heading = rng.uniform(-math.pi, math.pi)
        place = (x + offset * math.cos(turn) + u, y + offset * math.sin(turn) + v)
        drawn.paint_robot(team, CODES[number], *place, heading)
        truth.append((Team(team), place, heading))
    robots, reasons = seen_in(drawn)
    assert reasons == ()
    assert [(robot.team, robot.id) for robot in robots] == [(team, number) for team, _, _ in truth]
    for robot, (_, place, heading) in zip(robots, truth, strict=True):
        assert math.dist((robot.x_m, robot.y_m), place) < 0.002
        assert turn_between(robot.heading_rad, heading) < math.radians(2.0)
        pixel = drawn.camera.pixel_from_field(np.array([place]), SETTINGS.robots.height_m)[0]
        assert math.dist((robot.x_px, robot.y_px), pixel) < 0.4
        assert robot.confidence > 0.7


def test_id_and_heading_survive_a_rotation_by_any_angle() -> None:
    for degrees in range(-180, 180, 24):
        drawn = picture()
        drawn.paint_robot("blue", CODES[3], *middle(drawn.camera), math.radians(degrees))
        (robot,), _ = seen_in(drawn)
        assert robot.id == 3
        assert turn_between(robot.heading_rad, math.radians(degrees)) < math.radians(2.0)


@pytest.mark.parametrize("code", ["-GPP", "P-PP", "PG-P", "PGP-"])
def test_three_dots_tell_the_heading_but_no_id(code: str) -> None:
    drawn = picture()
    drawn.paint_robot("yellow", code, *middle(drawn.camera), 0.7)
    (robot,), _ = seen_in(drawn)
    assert (robot.team, robot.id) == (Team.YELLOW, None)
    assert turn_between(robot.heading_rad, 0.7) < math.radians(4.0)


@pytest.mark.parametrize("code", ["PG--", "P---", "-G-P"])
def test_fewer_dots_tell_neither_and_less_surely(code: str) -> None:
    whole, torn = picture(), picture()
    whole.paint_robot("blue", "PGPP", *middle(whole.camera), 0.7)
    torn.paint_robot("blue", code, *middle(torn.camera), 0.7)
    (sure,), _ = seen_in(whole)
    (robot,), _ = seen_in(torn)
    assert robot.id is None
    assert robot.heading_rad is None
    assert robot.confidence < 0.7 * sure.confidence
    assert math.dist((robot.x_m, robot.y_m), middle(torn.camera)) < 0.008


def test_a_center_without_dots_is_clutter() -> None:
    drawn = picture()
    drawn.paint_robot("blue", "----", *middle(drawn.camera), 0.0)
    robots, reasons = seen_in(drawn)
    assert robots == ()
    assert "no dot" in reasons[0]


def test_no_team_color_is_said() -> None:
    robots, reasons = seen_in(picture())
    assert robots == ()
    assert "no blob of a team's color" in reasons[0]


def test_wrong_size_is_said_with_what_is_accepted() -> None:
    drawn = picture()
    drawn.paint_disc("blue", *middle(drawn.camera), 0.08, SETTINGS.robots.height_m)
    robots, reasons = seen_in(drawn)
    assert robots == ()
    assert "none of a center dot's size" in reasons[0]
    assert "30% to 200%" in reasons[0]


def test_too_little_confidence_is_said() -> None:
    drawn = picture()
    drawn.paint_robot("blue", "P---", *middle(drawn.camera), 0.0)
    strict = msgspec.structs.replace(SETTINGS.robots, min_confidence=0.9)
    robots, reasons = find_robots(drawn.blobs(), TABLE, drawn.camera, MARKER, strict)
    assert robots == ()
    assert "with 1 dots" in reasons[0]
    assert "robots.min_confidence 0.9" in reasons[0]


def test_the_same_id_twice_is_taken_from_both_and_said() -> None:
    drawn = picture()
    x, y = middle(drawn.camera)
    drawn.paint_robot("blue", CODES[3], x - 0.1, y - 0.04, 0.0)
    drawn.paint_robot("blue", CODES[3], x + 0.1, y + 0.04, 2.0)
    robots, reasons = seen_in(drawn)
    assert [(robot.team, robot.id) for robot in robots] == [(Team.BLUE, None)] * 2
    assert all(robot.heading_rad is not None for robot in robots)
    assert reasons == ("two robots wear blue 3",)


def test_the_same_id_in_both_teams_is_no_conflict() -> None:
    drawn = picture()
    x, y = middle(drawn.camera)
    drawn.paint_robot("blue", CODES[3], x - 0.1, y - 0.04, 0.0)
    drawn.paint_robot("yellow", CODES[3], x + 0.1, y + 0.04, 2.0)
    robots, reasons = seen_in(drawn)
    assert [(robot.team, robot.id) for robot in robots] == [(Team.BLUE, 3), (Team.YELLOW, 3)]
    assert reasons == ()


def test_robots_that_touch_keep_their_own_dots() -> None:
    drawn = picture()
    x, y = middle(drawn.camera)
    turn = math.radians(20.0)
    side = (0.091 * math.cos(turn), 0.091 * math.sin(turn))
    drawn.paint_robot("blue", "GGPP", x - side[0], y - side[1], turn + 0.6)
    drawn.paint_robot("blue", "PPGG", x + side[0], y + side[1], turn - 1.9)
    robots, _ = seen_in(drawn)
    assert [robot.id for robot in robots] == [1, 7]


def test_a_robot_does_not_stand_in_another() -> None:
    """A second center dot among a marker's own dots borrows them, and loses."""
    drawn = picture()
    x, y = middle(drawn.camera)
    drawn.paint_robot("blue", CODES[0], x, y, 0.0)
    drawn.paint_disc("yellow", x + 0.07, y, 0.02, SETTINGS.robots.height_m)
    robots, _ = seen_in(drawn)
    assert [(robot.team, robot.id) for robot in robots] == [(Team.BLUE, 0)]


def test_clutter_among_the_dots_does_not_change_the_id() -> None:
    drawn = picture()
    x, y = middle(drawn.camera)
    drawn.paint_robot("blue", CODES[0], x, y, 0.0)
    drawn.paint_disc("green", x + 0.065, y, 0.014, SETTINGS.robots.height_m)
    (robot,), _ = seen_in(drawn)
    assert robot.id == 0


def test_order_of_blobs_does_not_matter() -> None:
    drawn = picture()
    x, y = middle(drawn.camera)
    drawn.paint_robot("blue", CODES[5], x - 0.1, y, 1.0)
    drawn.paint_robot("yellow", CODES[9], x + 0.1, y, -2.0)
    blobs = drawn.blobs()
    mixed = np.random.default_rng(4).permutation(len(blobs))
    shuffled = replace(
        blobs,
        color=blobs.color[mixed],
        area_px=blobs.area_px[mixed],
        center_px=blobs.center_px[mixed],
        box_px=blobs.box_px[mixed],
    )
    for one, other in zip(seen_in(drawn)[0], seen_in(drawn, shuffled)[0], strict=True):
        assert (one.team, one.id) == (other.team, other.id)
        assert (one.x_m, one.y_m, one.heading_rad) == pytest.approx((other.x_m, other.y_m, other.heading_rad))


def test_a_marker_of_other_height_is_pulled_towards_the_camera() -> None:
    """Parallax: the same picture, taken as twice as high, shows a robot nearer to the camera's foot."""
    drawn = picture()
    drawn.paint_robot("blue", CODES[0], *middle(drawn.camera), 0.0)
    (low,), _ = seen_in(drawn)
    higher = msgspec.structs.replace(SETTINGS.robots, height_m=0.28)
    (high,), _ = find_robots(drawn.blobs(), TABLE, drawn.camera, MARKER, higher)
    foot = drawn.camera.position_m[:2]
    assert math.dist((high.x_m, high.y_m), foot) < math.dist((low.x_m, low.y_m), foot)
