"""The ball's gates, one by one, on small drawn pictures, and its center and deviation against the truth."""

import math
from typing import Any

import msgspec
import numpy as np
import pytest

from bench.segmenters import ReferenceSegmenter
from tests.objects.drawing import SETTINGS, TABLE, Picture, overhead_camera
from vision_core.capture.source import open_source
from vision_core.capture.synthetic.camera import SyntheticCamera
from vision_core.clock import ManualClock
from vision_core.color.lookup_table import compile_color_table
from vision_core.geometry import Bytes
from vision_core.models.camera import CameraModel
from vision_core.models.camera_kernels import camera_map_from
from vision_core.models.camera_setup import CameraSetup
from vision_core.native.kernels import read_only
from vision_core.objects.ball.finder import BallFinder, ball_finder, find_balls
from vision_core.objects.ball.reasons import explain_balls
from vision_core.objects.observation import Observation
from vision_core.settings.schema import BallSettings, ColorRange, FieldSettings, Settings
from vision_core.types.colors import ColorTable
from vision_core.types.tables import BALL, MAX_BALLS, ROBOT, Table
from vision_core.venues.loader import load_settings

WIDTH, HEIGHT = 100, 80
RADIUS = SETTINGS.ball.radius_m

Place = tuple[float, float]


@pytest.fixture
def drawn() -> Picture:
    return Picture(overhead_camera(0.005, WIDTH, HEIGHT), WIDTH, HEIGHT)


@pytest.fixture
def place(drawn: Picture) -> Place:
    x, y = drawn.camera.field_from_pixel(np.array([[52.3, 37.8]]), RADIUS)[0].tolist()
    return x, y


def ball_settings(**changes: object) -> BallSettings:
    return msgspec.structs.replace(SETTINGS.ball, **changes)


def search(
    blobs: Table, pixels: Bytes, camera: CameraModel, robots: Table, finder: BallFinder, table: ColorTable,
    room: int = MAX_BALLS,
) -> tuple[Table, tuple[str, ...]]:  # fmt: skip
    """The balls that are found, as a table, and the reasons when there is none."""
    balls = np.zeros(room, dtype=BALL)
    seen = Observation(blobs, len(blobs), pixels, table.classes, camera_map_from(camera))
    count = find_balls(seen, robots, len(robots), finder, balls)
    reasons = explain_balls(seen, robots, len(robots), finder, "orange")
    return balls[:count], tuple(reason.text for reason in reasons)


def found(
    drawn: Picture,
    ball: BallSettings = SETTINGS.ball,
    robots: tuple[Place, ...] = (),
    field: FieldSettings = SETTINGS.field,
    table: ColorTable = TABLE,
    room: int = MAX_BALLS,
) -> tuple[Table, tuple[str, ...]]:
    rows = np.zeros(len(robots), dtype=ROBOT)
    for row, (x_m, y_m) in zip(rows, robots, strict=True):
        row["x_m"], row["y_m"] = x_m, y_m
    finder = ball_finder(msgspec.structs.replace(SETTINGS, ball=ball, field=field), table)
    return search(drawn.blobs(), drawn.as_bytes(), drawn.camera, rows, finder, table, room)


def test_a_ball_is_found_at_its_point_on_the_floor(drawn: Picture, place: Place) -> None:
    drawn.paint_ball(*place)
    (ball,), reasons = found(drawn)
    assert reasons == ()
    assert math.dist((ball["x_m"], ball["y_m"]), place) < 0.001
    assert math.dist((ball["x_px"], ball["y_px"]), (52.3, 37.8)) < 0.1
    assert 0.0001 < ball["position_sd_m"] < 0.001
    assert ball["confidence"] > 0.7


def test_no_blob_of_its_color_is_said(drawn: Picture) -> None:
    balls, reasons = found(drawn)
    assert len(balls) == 0
    assert reasons == ("no ball: no orange blob",)


def test_a_too_small_blob_is_rejected(drawn: Picture, place: Place) -> None:
    drawn.paint_ball(*place)
    balls, reasons = found(drawn, ball_settings(min_area=1.5))
    assert len(balls) == 0
    assert reasons[0] == "no ball: 1 orange blob: 1 too small (ball.min_area)"
    assert "the best candidate for the ball, at (52, 38) px, has" in reasons[1]
    assert "times the area expected from camera height and ball radius" in reasons[1]


def test_a_too_large_blob_is_rejected(drawn: Picture, place: Place) -> None:
    drawn.paint_disc("orange", *place, 0.05, RADIUS)
    balls, reasons = found(drawn)
    assert len(balls) == 0
    assert "1 too large (ball.max_area)" in reasons[0]


def test_a_half_hidden_ball_passes_and_is_known_worse(drawn: Picture, place: Place) -> None:
    drawn.paint_ball(*place)
    (whole,), _ = found(drawn)
    drawn.paint_disc("body", place[0] + 0.09, place[1], 0.09, RADIUS)
    (half,), _ = found(drawn)
    assert half["position_sd_m"] > 3.0 * whole["position_sd_m"]
    assert math.dist((half["x_m"], half["y_m"]), place) < 3.0 * half["position_sd_m"]


def test_an_elongated_blob_is_rejected(drawn: Picture, place: Place) -> None:
    for step in (-0.02, -0.01, 0.0, 0.01, 0.02):
        drawn.paint_disc("orange", place[0] + step * math.cos(0.35), place[1] + step * math.sin(0.35), 0.010, RADIUS)
    reasons = found(drawn)[1]
    assert "too long (ball.max_elongation)" in reasons[0]
    assert "times as long as wide" in reasons[1]
    assert len(found(drawn, ball_settings(max_elongation=4.0, min_confidence=0.1))[0]) == 1


def test_a_ragged_blob_is_rejected(drawn: Picture, place: Place) -> None:
    drawn.paint_ball(*place)
    drawn.paint_disc("carpet", place[0] + 0.012, place[1] + 0.012, 0.015, RADIUS)
    assert len(found(drawn, ball_settings(min_fill=0.2))[0]) == 1
    assert "too ragged (ball.min_fill)" in found(drawn, ball_settings(min_fill=0.75))[1][0]


def test_dribbled_passes_and_on_top_of_a_robot_not(drawn: Picture, place: Place) -> None:
    drawn.paint_ball(*place)
    for distance in (0.085, 0.090, 0.095):
        for turn in np.linspace(0.0, math.tau, 7):
            robot = place[0] + distance * math.cos(turn), place[1] + distance * math.sin(turn)
            assert len(found(drawn, robots=((9.0, 9.0), robot))[0]) == 1
    balls, reasons = found(drawn, robots=((place[0] + 0.05, place[1]),))
    assert len(balls) == 0
    assert "1 on a robot (ball.inside_robot_m)" in reasons[0]
    assert "50 mm from a robot's center; accepted: 75 or more" in reasons[1]


def test_a_ball_off_the_field_is_rejected(drawn: Picture, place: Place) -> None:
    drawn.paint_ball(*place)
    goal = msgspec.structs.replace(SETTINGS.field.goal, depth_m=0.0)
    edge = 2.0 * abs(place[0])
    tight = msgspec.structs.replace(SETTINGS.field, length_m=edge - 1.5 * RADIUS, goal=goal)
    assert len(found(drawn, field=tight)[0]) == 1, "a ball may touch the wall"
    small = msgspec.structs.replace(SETTINGS.field, length_m=edge - 2.5 * RADIUS, goal=goal)
    assert "1 off the field" in found(drawn, field=small)[1][0]


def test_surroundings_of_the_wrong_color_are_rejected(drawn: Picture, place: Place) -> None:
    drawn.paint_ball(*place)
    carpet = (ColorRange(hue_deg=(90.0, 150.0), saturation=(0.3, 0.7), value=(0.2, 0.5)),)
    classes = {**SETTINGS.colors.classes, "carpet": carpet}
    table = compile_color_table(msgspec.structs.replace(SETTINGS.colors, classes=classes))
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


def test_too_little_confidence_is_rejected(drawn: Picture, place: Place) -> None:
    drawn.paint_ball(*place)
    assert "below ball.min_confidence" in found(drawn, ball_settings(min_confidence=1.0))[1][0]


def test_best_first_and_rejected_ones_are_counted(drawn: Picture, place: Place) -> None:
    drawn.paint_ball(*place)
    drawn.paint_disc("orange", place[0] - 0.1, place[1], 0.014, RADIUS)
    drawn.paint_disc("orange", place[0] + 0.1, place[1], 0.05, RADIUS)
    balls, reasons = found(drawn)
    assert reasons == ()
    assert len(balls) == 2
    assert balls[0]["confidence"] > balls[1]["confidence"]
    assert math.dist((balls[0]["x_m"], balls[0]["y_m"]), place) < 0.002
    (best,), _ = found(drawn, room=1)
    assert best == balls[0], "a full table keeps the best"
    balls, reasons = found(drawn, ball_settings(min_area=1.4))
    assert reasons[0] == "no ball: 3 orange blobs: 2 too small (ball.min_area), 1 too large (ball.max_area)"


def test_between_the_lines_comes_before_a_better_one_outside(drawn: Picture, place: Place) -> None:
    drawn.paint_ball(*place)
    drawn.paint_disc("orange", place[0] - 0.1, place[1], 0.014, RADIUS)
    short = msgspec.structs.replace(SETTINGS.field, length_m=2.0 * (place[0] - 0.05), margin_m=1.0)
    first, second = found(drawn, field=short)[0]
    assert first["x_m"] < place[0] - 0.05 < second["x_m"]
    assert first["confidence"] < second["confidence"]


def test_one_signature_is_compiled(drawn: Picture, place: Place) -> None:
    drawn.paint_ball(*place)
    kernel: Any = find_balls
    found(drawn)
    compiled = len(kernel.signatures)  # others too, where this process compiled a caller of it
    found(drawn, robots=(place,))
    assert len(kernel.signatures) == compiled


def rendered(settings: Settings, frames: int) -> list[tuple[float, float, float]]:
    """Errors x, y [m] and deviation [m] of wholly visible balls, one frame after the other."""
    source = open_source(settings, CameraSetup.from_settings(settings), ManualClock(), paced=False)
    assert isinstance(source, SyntheticCamera)
    camera, table = camera_map_from(CameraSetup.from_settings(settings).model), compile_color_table(settings.colors)
    finder = ball_finder(settings, table)
    pixels = CameraSetup.from_settings(settings).black_image()
    segmenter = ReferenceSegmenter(pixels.shape[1], pixels.shape[0], settings.blobs)
    no_robots = np.zeros(0, dtype=ROBOT)
    balls, errors = np.zeros(MAX_BALLS, dtype=BALL), []
    for _ in range(frames):
        source.grab(pixels)
        ball = source.truth.ball
        seen = read_only(pixels)
        blobs, _ = segmenter.segment(seen, table)
        observation = Observation(segmenter.blobs, blobs, seen, table.classes, camera)
        count = find_balls(observation, no_robots, 0, finder, balls)
        near = [one for one in balls[:count] if math.hypot(one["x_m"] - ball.x_m, one["y_m"] - ball.y_m) < 0.02]
        if near and ball.visible_share == 1.0:
            errors.append((near[0]["x_m"] - ball.x_m, near[0]["y_m"] - ball.y_m, float(near[0]["position_sd_m"])))
    source.close()
    return errors


@pytest.mark.slow
def test_the_deviation_is_that_of_the_errors() -> None:
    options = {"synthetic.exposure_ms": 0.0, "camera.rate_hz": 5.0}
    x, y, sd = np.array(rendered(load_settings(options=options), 80)).T
    assert len(x) > 50
    assert 0.7 <= float(((x**2 + y**2) / 2.0 / sd**2).mean()) <= 1.4
    assert math.sqrt(float((x**2 + y**2).mean() / 2.0)) < 0.0003  # half of what the centroid has at 5 mm per pixel
