"""The ball's gates, one by one, on small drawn pictures."""

import math

import msgspec
import numpy as np
import pytest

from tests.objects.drawing import SETTINGS, TABLE, Picture, overhead_camera
from vision_core.color.lookup_table import compile_color_table
from vision_core.objects.ball import find_balls
from vision_core.settings import BallSettings, ColorRange, FieldSettings
from vision_core.types.colors import ColorTable
from vision_core.types.objects import BallSighting, RobotSighting, Team

WIDTH, HEIGHT = 100, 80
RADIUS = SETTINGS.ball.radius_m


@pytest.fixture
def drawn() -> Picture:
    return Picture(overhead_camera(0.005, WIDTH, HEIGHT), WIDTH, HEIGHT)


@pytest.fixture
def place(drawn: Picture) -> tuple[float, float]:
    x, y = drawn.camera.field_from_pixel(np.array([[52.3, 37.8]]), RADIUS)[0].tolist()
    return x, y


def ball_settings(**changes: object) -> BallSettings:
    return msgspec.structs.replace(SETTINGS.ball, **changes)


def found(
    drawn: Picture,
    ball: BallSettings = SETTINGS.ball,
    robots: tuple[RobotSighting, ...] = (),
    field: FieldSettings = SETTINGS.field,
    table: ColorTable = TABLE,
) -> tuple[tuple[BallSighting, ...], tuple[str, ...]]:
    return find_balls(drawn.blobs(), table, drawn.as_bytes(), drawn.camera, robots, ball, field)


def robot_at(x_m: float, y_m: float) -> RobotSighting:
    return RobotSighting(Team.BLUE, 1, 0.0, 0.0, x_m, y_m, 0.0, 1.0, 0.001, 0.01)


def test_a_ball_is_found_at_its_point_on_the_floor(drawn: Picture, place: tuple[float, float]) -> None:
    drawn.paint_ball(*place)
    (ball,), reasons = found(drawn)
    assert reasons == ()
    assert math.dist((ball.x_m, ball.y_m), place) < 0.002
    assert math.dist((ball.x_px, ball.y_px), (52.3, 37.8)) < 0.3
    assert ball.confidence > 0.7


def test_no_blob_of_its_color_is_said(drawn: Picture) -> None:
    assert found(drawn) == ((), ("no ball: no orange blob",))


def test_too_small(drawn: Picture, place: tuple[float, float]) -> None:
    drawn.paint_ball(*place)
    balls, reasons = found(drawn, ball_settings(min_area=1.5))
    assert balls == ()
    assert reasons == ("no ball: 1 orange blobs: 1 too small (ball.min_area)",)


def test_too_large(drawn: Picture, place: tuple[float, float]) -> None:
    drawn.paint_disc("orange", *place, 0.05, RADIUS)
    balls, reasons = found(drawn)
    assert balls == ()
    assert "1 too large (ball.max_area)" in reasons[0]


def test_a_half_hidden_ball_passes(drawn: Picture, place: tuple[float, float]) -> None:
    drawn.paint_ball(*place)
    drawn.paint_disc("body", place[0] + 0.09, place[1], 0.09, RADIUS)
    assert len(found(drawn)[0]) == 1


def test_too_long(drawn: Picture, place: tuple[float, float]) -> None:
    for step in (-0.02, -0.01, 0.0, 0.01, 0.02):
        drawn.paint_disc("orange", place[0] + step * math.cos(0.35), place[1] + step * math.sin(0.35), 0.010, RADIUS)
    assert "too long (ball.max_elongation)" in found(drawn)[1][0]
    assert len(found(drawn, ball_settings(max_elongation=4.0, min_confidence=0.1))[0]) == 1


def test_too_ragged(drawn: Picture, place: tuple[float, float]) -> None:
    drawn.paint_ball(*place)
    drawn.paint_disc("carpet", place[0] + 0.012, place[1] + 0.012, 0.015, RADIUS)
    assert len(found(drawn, ball_settings(min_fill=0.2))[0]) == 1
    assert "too ragged (ball.min_fill)" in found(drawn, ball_settings(min_fill=0.75))[1][0]


def test_dribbled_passes_and_on_top_of_a_robot_not(drawn: Picture, place: tuple[float, float]) -> None:
    drawn.paint_ball(*place)
    for distance in (0.085, 0.090, 0.095):
        for turn in np.linspace(0.0, math.tau, 7):
            robot = robot_at(place[0] + distance * math.cos(turn), place[1] + distance * math.sin(turn))
            assert len(found(drawn, robots=(robot_at(9.0, 9.0), robot))[0]) == 1
    balls, reasons = found(drawn, robots=(robot_at(place[0] + 0.05, place[1]),))
    assert balls == ()
    assert "1 on a robot (ball.inside_robot_m)" in reasons[0]


def test_off_the_field(drawn: Picture, place: tuple[float, float]) -> None:
    drawn.paint_ball(*place)
    goal = msgspec.structs.replace(SETTINGS.field.goal, depth_m=0.0)
    edge = 2.0 * abs(place[0])
    tight = msgspec.structs.replace(SETTINGS.field, length_m=edge - 1.5 * RADIUS, goal=goal)
    assert len(found(drawn, field=tight)[0]) == 1, "a ball may touch the wall"
    small = msgspec.structs.replace(SETTINGS.field, length_m=edge - 2.5 * RADIUS, goal=goal)
    assert "1 off the field" in found(drawn, field=small)[1][0]


def test_surroundings(drawn: Picture, place: tuple[float, float]) -> None:
    drawn.paint_ball(*place)
    carpet = (ColorRange(hue_deg=(90.0, 150.0), saturation=(0.3, 0.7), value=(0.2, 0.5)),)
    colors = msgspec.structs.replace(SETTINGS.colors, classes={**SETTINGS.colors.classes, "carpet": carpet})
    table = compile_color_table(colors)
    wanted = ball_settings(surrounding=("carpet",), min_surrounding=0.9)
    assert len(found(drawn, wanted, table=table)[0]) == 1
    bare = Picture(drawn.camera, WIDTH, HEIGHT)
    bare.paint_disc("body", *place, 0.06, RADIUS)
    bare.paint_ball(*place)
    assert "in the wrong surroundings (ball.surrounding)" in found(bare, wanted, table=table)[1][0]
    half = Picture(drawn.camera, WIDTH, HEIGHT)
    half.paint_disc("body", place[0] + 0.2, place[1], 0.2, RADIUS)
    half.paint_ball(*place)
    assert len(found(half, ball_settings(surrounding=("carpet",), min_surrounding=0.3), table=table)[0]) == 1


def test_too_little_confidence(drawn: Picture, place: tuple[float, float]) -> None:
    drawn.paint_ball(*place)
    assert "below ball.min_confidence" in found(drawn, ball_settings(min_confidence=1.0))[1][0]


def test_best_first_and_rejected_ones_are_counted(drawn: Picture, place: tuple[float, float]) -> None:
    drawn.paint_ball(*place)
    drawn.paint_disc("orange", place[0] - 0.1, place[1], 0.014, RADIUS)
    drawn.paint_disc("orange", place[0] + 0.1, place[1], 0.05, RADIUS)
    balls, reasons = found(drawn)
    assert reasons == ()
    assert len(balls) == 2
    assert balls[0].confidence > balls[1].confidence
    assert math.dist((balls[0].x_m, balls[0].y_m), place) < 0.002
    balls, reasons = found(drawn, ball_settings(min_area=1.4))
    assert reasons == ("no ball: 3 orange blobs: 2 too small (ball.min_area), 1 too large (ball.max_area)",)


def test_between_the_lines_comes_before_a_better_one_outside(drawn: Picture, place: tuple[float, float]) -> None:
    drawn.paint_ball(*place)
    drawn.paint_disc("orange", place[0] - 0.1, place[1], 0.014, RADIUS)
    short = msgspec.structs.replace(SETTINGS.field, length_m=2.0 * (place[0] - 0.05), margin_m=1.0)
    first, second = found(drawn, field=short)[0]
    assert first.x_m < place[0] - 0.05 < second.x_m
    assert first.confidence < second.confidence
