"""Robots of every shipped marker: id and pose at random places, unread codes, conflicts, clutter."""

import math

import msgspec
import numpy as np
import pytest

from tests.objects.drawing import PAINT_TABLE, Picture, turn_between
from tests.objects.finding import SHIPPED, empty_picture, finder_of, middle, scene_of, seen_in, settings_of
from vision_core.models.camera_kernels import camera_map_from
from vision_core.models.from_settings import robots_of
from vision_core.objects.observation import Observation
from vision_core.objects.robots.finder import find_robots, robot_finder
from vision_core.patterns.loader import load_pattern
from vision_core.patterns.pattern import CODE
from vision_core.types.objects import Team
from vision_core.types.tables import BLOB, MAX_ROBOTS, NO_ID, ROBOT, Table

BLUE, YELLOW = range(2)
SSL = load_pattern("ssl-standard")
CODES = SSL.code_by_id
FINDER = finder_of("ssl-standard")


def ssl_picture(robots: float = 1.5) -> tuple[Picture, float, float]:
    drawn = empty_picture(SSL, robots, 36.0)
    return drawn, *middle(drawn, SSL.robot.height_m)


def ids(robots: Table) -> list[tuple[int, int]]:
    return [(int(robot["team"]), int(robot["id"])) for robot in robots]


@pytest.mark.parametrize("name", SHIPPED)
def test_every_shipped_pattern_at_random_poses(name: str) -> None:
    pattern, finder = load_pattern(name), finder_of(name)
    codes = list(pattern.code_by_id.items())
    rng = np.random.default_rng(1)
    for number in range(max(6, len(codes))):
        drawn = empty_picture(pattern, 1.6, rng.uniform(32.0, 48.0))
        marker, code = codes[number % len(codes)]
        place = np.array(middle(drawn, pattern.robot.height_m)) + rng.uniform(-0.1, 0.1, 2) * pattern.robot.radius_m
        heading = rng.uniform(-math.pi, math.pi)
        drawn.paint_pattern(pattern, ("blue", "yellow")[number % 2], code, (*place.tolist(), heading))
        (robot,) = seen_in(drawn, finder, seed=number)
        assert (robot["team"], robot["id"]) == (number % 2, marker)
        assert math.dist((robot["x_m"], robot["y_m"]), place) < 0.02 * pattern.robot.radius_m
        assert turn_between(robot["heading_rad"], heading) < math.radians(3.0)
        pixel = drawn.camera.pixel_from_field(place, pattern.robot.height_m)[0]
        assert math.dist((robot["x_px"], robot["y_px"]), pixel) < 0.4
        assert 0.7 < robot["confidence"] <= 1.0


@pytest.mark.parametrize("name", SHIPPED)
def test_errors_are_as_large_as_the_deviations_say(name: str) -> None:
    pattern, finder = load_pattern(name), finder_of(name)
    code = next(iter(pattern.code_by_id.values()))
    rng = np.random.default_rng(2)
    squares = []
    for number in range(8):
        drawn = empty_picture(pattern, 1.5, 44.0)
        place = np.array(middle(drawn, pattern.robot.height_m)) + rng.uniform(-0.1, 0.1, 2) * pattern.robot.radius_m
        heading = rng.uniform(-math.pi, math.pi)
        drawn.paint_pattern(pattern, "blue", code, (*place.tolist(), heading))
        (robot,) = seen_in(drawn, finder, seed=number)
        off = math.dist((robot["x_m"], robot["y_m"]), place) / robot["position_sd_m"]
        turn = turn_between(robot["heading_rad"], heading) / robot["heading_sd_rad"]
        squares.append((0.5 * off * off, turn * turn))
    assert (np.mean(squares, axis=0) < 4.0).all()


@pytest.mark.parametrize("name", ["vsss-three-patch", "vsss-corner-patch", "vsss-diagonal", "mirosot-diagonal"])
def test_an_unread_code_leaves_a_robot_of_its_team_where_it_is(name: str) -> None:
    pattern, finder = load_pattern(name), finder_of(name)
    blank = "-" * sum(patch.color == CODE for patch in pattern.patches)
    rng = np.random.default_rng(3)
    for number in range(4):
        drawn = empty_picture(pattern)
        place, heading = middle(drawn, pattern.robot.height_m), rng.uniform(-math.pi, math.pi)
        drawn.paint_pattern(pattern, "yellow", blank, (*place, heading))
        (robot,) = seen_in(drawn, finder, seed=number)
        assert (robot["team"], robot["id"]) == (YELLOW, NO_ID)
        assert math.dist((robot["x_m"], robot["y_m"]), place) < 3.0 * robot["position_sd_m"]
        assert math.isnan(robot["heading_rad"]) or turn_between(robot["heading_rad"], heading) < math.radians(8.0)


def test_one_of_two_codes_and_the_shape_of_the_teams_patch_tell_the_heading() -> None:
    pattern, finder = load_pattern("vsss-three-patch"), finder_of("vsss-three-patch")
    for code in ("R-", "-C"):
        drawn = empty_picture(pattern)
        drawn.paint_pattern(pattern, "blue", code, (*middle(drawn, pattern.robot.height_m), 0.7))
        (robot,) = seen_in(drawn, finder)
        assert (robot["team"], robot["id"]) == (BLUE, NO_ID)
        assert turn_between(robot["heading_rad"], 0.7) < math.radians(6.0)


def test_a_t_turned_by_any_angle_tells_its_heading() -> None:
    pattern, finder = load_pattern("t-plate"), finder_of("t-plate")
    for degrees in range(-180, 180, 40):
        drawn = empty_picture(pattern)
        drawn.paint_pattern(pattern, "blue", "", (*middle(drawn, pattern.robot.height_m), math.radians(degrees)))
        (robot,) = seen_in(drawn, finder)
        assert turn_between(robot["heading_rad"], math.radians(degrees)) < math.radians(2.0)
        assert robot["id"] == 1


@pytest.mark.parametrize("code", ["-GPP", "P-PP", "PG-P", "PGP-"])
def test_three_dots_tell_the_heading_but_no_id(code: str) -> None:
    drawn, x, y = ssl_picture()
    drawn.paint_robot("yellow", code, x, y, 0.7)
    (robot,) = seen_in(drawn, FINDER)
    assert (robot["team"], robot["id"]) == (YELLOW, NO_ID)
    assert turn_between(robot["heading_rad"], 0.7) < math.radians(1.0)


@pytest.mark.parametrize("code", ["PG--", "P---", "-G-P"])
def test_fewer_dots_tell_neither_and_less_surely(code: str) -> None:
    drawn, x, y = ssl_picture()
    drawn.paint_robot("blue", code, x, y, 0.7)
    (robot,) = seen_in(drawn, FINDER)
    assert robot["id"] == NO_ID
    assert math.isnan(robot["heading_rad"])
    assert math.isnan(robot["heading_sd_rad"])
    assert robot["confidence"] < 0.7
    assert math.dist((robot["x_m"], robot["y_m"]), (x, y)) < 0.001


def test_a_center_dot_alone_is_clutter() -> None:
    drawn, x, y = ssl_picture()
    drawn.paint_robot("blue", "----", x, y, 0.0)
    assert len(seen_in(drawn, FINDER)) == 0


def test_the_same_id_twice_is_taken_from_both_but_not_across_teams() -> None:
    drawn, x, y = ssl_picture(3.6)
    drawn.paint_robot("blue", CODES[3], x - 0.2, y, 0.0)
    drawn.paint_robot("blue", CODES[3], x, y + 0.1, 2.0)
    drawn.paint_robot("blue", CODES[4], x + 0.2, y + 0.1, 2.0)
    drawn.paint_robot("yellow", CODES[3], x + 0.1, y - 0.15, 1.0)
    robots = seen_in(drawn, FINDER)
    assert ids(robots) == [(BLUE, 4), (BLUE, NO_ID), (BLUE, NO_ID), (YELLOW, 3)]
    assert robots["x_m"][1] < robots["x_m"][2]
    assert not np.isnan(robots["heading_rad"]).any()


def test_robots_that_touch_keep_their_own_dots() -> None:
    drawn, x, y = ssl_picture(2.4)
    drawn.paint_robot("blue", "GGPP", x - 0.091, y, 0.6)
    drawn.paint_robot("blue", "PPGG", x + 0.091, y, -1.9)
    assert ids(seen_in(drawn, FINDER)) == [(BLUE, 1), (BLUE, 7)]


def test_a_robot_does_not_stand_in_another() -> None:
    drawn, x, y = ssl_picture()
    drawn.paint_robot("blue", CODES[0], x, y, 0.0)
    drawn.paint_disc("yellow", x + 0.07, y, 0.02, SSL.robot.height_m)
    assert ids(seen_in(drawn, FINDER)) == [(BLUE, 0)]


def test_clutter_among_the_dots_does_not_change_the_id() -> None:
    drawn, x, y = ssl_picture()
    drawn.paint_robot("blue", CODES[0], x, y, 0.0)
    drawn.paint_disc("green", x + 0.065, y, 0.014, SSL.robot.height_m)
    assert ids(seen_in(drawn, FINDER)) == [(BLUE, 0)]


def test_teams_may_wear_different_markers() -> None:
    square, finder = load_pattern("vsss-three-patch"), finder_of("ssl-standard", "vsss-three-patch")
    drawn, x, y = ssl_picture(2.6)
    drawn.paint_robot("blue", CODES[6], x - 0.1, y, 1.0)
    drawn.paint_pattern(square, "yellow", square.code_by_id[5], (x + 0.1, y, -2.0))
    robots = seen_in(drawn, finder)
    assert ids(robots) == [(BLUE, 6), (YELLOW, 5)]
    assert turn_between(robots["heading_rad"][1], -2.0) < math.radians(6.0)


def test_order_of_blobs_does_not_matter() -> None:
    drawn, x, y = ssl_picture(2.6)
    drawn.paint_robot("blue", CODES[5], x - 0.1, y, 1.0)
    drawn.paint_robot("yellow", CODES[9], x + 0.1, y, -2.0)
    scene = scene_of(drawn)
    before = scene.robots(FINDER)
    scene.blobs[:] = scene.blobs[np.random.default_rng(4).permutation(len(scene.blobs))]
    after = scene.robots(FINDER)
    assert ids(before) == ids(after) == [(BLUE, 5), (YELLOW, 9)]
    for column in ("x_m", "y_m", "heading_rad"):
        assert after[column] == pytest.approx(before[column], abs=1e-9)


def test_a_marker_that_is_higher_is_nearer_to_the_camera() -> None:
    """Parallax: the same picture, taken as twice as high, shows a robot nearer to the camera's foot."""
    drawn, x, y = ssl_picture()
    drawn.paint_robot("blue", CODES[0], x, y, 0.0)
    settings = settings_of("ssl-standard")
    blue = msgspec.structs.replace(robots_of(settings.robots, Team.BLUE), height_m=2.0 * SSL.robot.height_m)
    robots = msgspec.structs.replace(settings.robots, blue=blue)
    (high,) = seen_in(drawn, robot_finder(msgspec.structs.replace(settings, robots=robots), PAINT_TABLE))
    foot = drawn.camera.position_m[:2]
    assert math.dist((high["x_m"], high["y_m"]), foot) < math.dist((x, y), foot) - 0.001


def cloth_of_dots(count: int, seed: int) -> Table:
    """Blobs of all colors and of all sizes up to a center dot's, anywhere in a picture of 640x480."""
    rng = np.random.default_rng(seed)
    blobs = np.zeros(count, dtype=BLOB)
    blobs["color"] = rng.integers(1, 5, count)
    blobs["area_px"] = rng.integers(4, 100, count)
    blobs["x_px"], blobs["y_px"] = rng.uniform(0.0, 639.0, count), rng.uniform(0.0, 479.0, count)
    blobs["left"] = blobs["right"] = blobs["x_px"]
    blobs["top"] = blobs["bottom"] = blobs["y_px"]
    return blobs


def test_a_cloth_of_dots_gives_no_more_robots_than_there_is_room_for() -> None:
    camera = camera_map_from(empty_picture(SSL, 1.0, 20.0).camera)
    pixels = np.zeros((480, 640, 3), dtype=np.uint8)
    out = np.zeros(MAX_ROBOTS, dtype=ROBOT)
    for seed in range(3):
        blobs = cloth_of_dots(2000, seed)
        count = find_robots(Observation(blobs, len(blobs), pixels, PAINT_TABLE.classes, camera), FINDER, 0, out)
        assert 0 < count <= MAX_ROBOTS
        robots = out[:count]
        keys = [(robot["team"], np.inf if robot["id"] == NO_ID else robot["id"], robot["x_m"]) for robot in robots]
        assert keys == sorted(keys)
        apart = np.hypot(*(robots[axis][:, None] - robots[axis] for axis in ("x_m", "y_m")))
        assert apart[~np.eye(count, dtype=bool)].min() > 0.12
    assert find_robots(Observation(blobs, 0, pixels, PAINT_TABLE.classes, camera), FINDER, 0, out) == 0


def test_one_signature_serves_all_patterns() -> None:
    drawn, _, _ = ssl_picture()
    seen_in(drawn, finder_of(SHIPPED[0]))
    compiled = len(find_robots.signatures)  # type: ignore[attr-defined]
    for name in SHIPPED[1:3]:
        seen_in(drawn, finder_of(name))
    assert len(find_robots.signatures) == compiled  # type: ignore[attr-defined]
