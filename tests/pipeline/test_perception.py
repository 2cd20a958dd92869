"""The stages composed, on drawn pictures of the default camera's size."""

import itertools
import math

import msgspec
import numpy as np
import pytest

from tests.objects.drawing import CODES, PAINTS, SETTINGS, Picture, turn_between
from vision_core.capture.synthetic.camera import SyntheticCamera
from vision_core.clock import Instant, ManualClock
from vision_core.color.light import NEUTRAL_LIGHT
from vision_core.errors import SettingsError
from vision_core.geometry import Bytes
from vision_core.models.camera_setup import CameraSetup
from vision_core.native.opencv import draw_circle
from vision_core.pipeline.perception import Perception
from vision_core.tracks.tracker import Tracker
from vision_core.types.image import ImageFrame
from vision_core.types.tables import MAX_BALLS, MAX_ROBOTS

CAMERA = CameraSetup.from_settings(SETTINGS)
CORNER = (420, 40)
"""Where in the frame the drawn piece lies: off axis, where parallax and distortion count [px]."""


@pytest.fixture(scope="module")
def perception() -> Perception:
    perception = Perception(SETTINGS, CAMERA)
    perception.warm_up()
    perception.lighting.hold(NEUTRAL_LIGHT)  # what is drawn here is no field whose light could be measured
    return perception


class CutCamera:
    """The default camera, its picture's origin moved to the corner of a piece."""

    def __init__(self) -> None:
        self.whole = CAMERA.model

    def field_from_pixel(self, pixels: np.ndarray, height_m: float = 0.0) -> np.ndarray:
        return self.whole.field_from_pixel(pixels + CORNER, height_m)

    def pixel_from_field(self, points: np.ndarray, height_m: float = 0.0) -> np.ndarray:
        return self.whole.pixel_from_field(points, height_m) - CORNER


def frame_of(piece: Picture) -> ImageFrame:
    size = CAMERA.shape
    pixels: Bytes = np.full(size, PAINTS["carpet"], dtype=np.uint8)
    x, y = CORNER
    pixels[y : y + piece.height, x : x + piece.width] = piece.as_bytes()
    pixels.setflags(write=False)
    return ImageFrame("main", 7, Instant(123), pixels)


def test_a_frame_becomes_sightings(perception: Perception) -> None:
    piece = Picture(CutCamera(), 130, 90)  # type: ignore[arg-type]
    x, y = piece.camera.field_from_pixel(np.array([[45.0, 45.0]]), SETTINGS.robots.height_m)[0].tolist()
    piece.paint_robot("yellow", CODES[11], x, y, 2.2)
    piece.paint_ball(x + 0.2, y)
    seen = perception.perceive(frame_of(piece), ManualClock(Instant(456))).record()
    (robot,), (ball,) = seen.robots, seen.balls
    assert (robot.team, robot.id) == ("yellow", 11)
    assert turn_between(robot.heading_rad, 2.2) < math.radians(2.0)
    assert math.dist((robot.x_m, robot.y_m), (x, y)) < 0.002
    assert math.dist((robot.x_px, robot.y_px), (45 + CORNER[0], 45 + CORNER[1])) < 0.4
    assert math.dist((ball.x_m, ball.y_m), (x + 0.2, y)) < 0.002
    assert (seen.camera, seen.frame_number, seen.grabbed, seen.perceived) == ("main", 7, 123, 456)
    assert seen.complete


def test_an_empty_field_shows_nothing(perception: Perception) -> None:
    seen = perception.perceive(frame_of(Picture(CutCamera(), 20, 20)), ManualClock()).record()  # type: ignore[arg-type]
    assert (seen.robots, seen.balls) == ((), ())


def test_overflow_is_reported() -> None:
    blobs = msgspec.structs.replace(SETTINGS.blobs, max_runs=100)
    perception = Perception(msgspec.structs.replace(SETTINGS, blobs=blobs), CAMERA)
    perception.lighting.hold(NEUTRAL_LIGHT)
    size = CAMERA.shape
    flood = np.full(size, PAINTS["orange"], dtype=np.uint8)
    assert not perception.perceive(ImageFrame("main", 1, Instant(0), flood), ManualClock()).record().complete


def test_a_pattern_without_its_color_classes_is_refused() -> None:
    classes = {name: boxes for name, boxes in SETTINGS.colors.classes.items() if name != "pink"}
    colors = msgspec.structs.replace(SETTINGS.colors, classes=classes)
    with pytest.raises(SettingsError, match=r"colors; found: pink; accepted: .*green"):
        Perception(msgspec.structs.replace(SETTINGS, colors=colors), CAMERA)


@pytest.mark.slow
def test_a_simulated_match_is_read_without_a_miss(perception: Perception) -> None:
    clock = ManualClock()
    camera = SyntheticCamera(SETTINGS, CAMERA, clock, paced=False)
    pixels = np.empty(CAMERA.shape, dtype=np.uint8)
    for number in range(1, 41):
        seen = perception.perceive(ImageFrame("main", number, camera.grab(pixels), pixels), clock).record()
        truth = camera.truth
        robots = {(robot.team, robot.id): robot for robot in seen.robots}
        assert len(robots) == len(seen.robots)
        assert set(robots) == {(robot.team, robot.id) for robot in truth.robots}
        for robot in truth.robots:
            found = robots[robot.team, robot.id]
            assert math.dist((found.x_m, found.y_m), (robot.x_m, robot.y_m)) < 0.002
            assert turn_between(found.heading_rad, robot.heading_rad) < math.radians(2.0)
        if truth.ball.visible_share > 0.5:
            best = seen.balls[0]
            assert math.dist((best.x_m, best.y_m), (truth.ball.x_m, truth.ball.y_m)) < 0.01


def cloth(shift_px: int, dots: dict[str, tuple[int, int]], spacing_px: int) -> Bytes:
    """A picture full of dots of one or two paints, each color at its offset [px]."""
    height, width = SETTINGS.camera.height_px, SETTINGS.camera.width_px
    pixels: Bytes = np.full((height, width, 3), PAINTS["carpet"], dtype=np.uint8)
    for x, y in itertools.product(range(20, width - 20, spacing_px), range(20, height - 20, spacing_px)):
        for paint, (aside, below) in dots.items():
            draw_circle(pixels, (x + shift_px + aside, y + below), 4.6, PAINTS[paint], -1)
    return pixels


@pytest.mark.parametrize(
    ("dots", "spacing_px", "found"),
    [({"orange": (0, 0)}, 14, MAX_BALLS), ({"blue": (0, 0), "pink": (8, 9)}, 30, MAX_ROBOTS)],
    ids=["orange", "blue and pink"],
)
def test_a_cloth_of_dots_finds_room_in_the_database(
    perception: Perception, dots: dict[str, tuple[int, int]], spacing_px: int, found: int
) -> None:
    tracker = Tracker(SETTINGS.tracks, SETTINGS.robots)
    for number in range(1, 7):
        pixels = cloth(5 * (number // 2), dots, spacing_px)  # seen twice, then elsewhere: every track is predicted
        seen = perception.perceive(ImageFrame("main", number, Instant(number * 33_000_000), pixels), ManualClock())
        assert seen.counts.sum() == found
        assert tracker.update(seen).counts[0] <= MAX_ROBOTS
