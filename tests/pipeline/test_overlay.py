"""The overlay of a rendered demo frame: every layer says what the stages make of it, and its size is bounded."""

import cv2
import numpy as np
import pytest

from vision_core.capture.source import open_source
from vision_core.clock import Instant, ManualClock
from vision_core.geometry import Bytes
from vision_core.models.camera_setup import CameraSetup
from vision_core.native.opencv import draw_circle
from vision_core.pipeline.overlay import MAX_BLOBS, MAX_HYPOTHESES, OverlayMaker
from vision_core.pipeline.perception import Perception
from vision_core.regions.lines import line_check
from vision_core.rtdb import records
from vision_core.types.image import ImageFrame
from vision_core.types.overlay import Layer, Overlay
from vision_core.venues.loader import load_settings

pytestmark = pytest.mark.slow

SETTINGS = load_settings(options={"colors.light.adapt": False})  # noise has no light to be measured
CAMERA = CameraSetup.from_settings(SETTINGS)
BLUE_BGR = (200, 70, 20)


@pytest.fixture(scope="module")
def maker() -> OverlayMaker:
    return OverlayMaker(Perception(SETTINGS, CAMERA))


@pytest.fixture(scope="module")
def image() -> Bytes:
    pixels = CAMERA.black_image()
    source = open_source(SETTINGS, CAMERA, ManualClock(), paced=False)
    for _ in range(10):
        source.grab(pixels)
    source.close()
    return pixels


def made(maker: OverlayMaker, image: Bytes, *layers: Layer) -> Overlay:
    return maker.make(ImageFrame("main", 7, Instant(5), image), layers, ManualClock())


def test_only_the_layers_that_are_asked_for_are_made(maker: OverlayMaker, image: Bytes) -> None:
    overlay = made(maker, image, Layer.BLOBS)
    assert overlay.blobs is not None
    assert (overlay.classes, overlay.hypotheses, overlay.lines, overlay.boundary) == (None,) * 4
    assert (overlay.frame_number, overlay.grabbed) == (7, 5)


def test_classes_are_a_picture_of_numbers(maker: OverlayMaker, image: Bytes) -> None:
    classes = made(maker, image, Layer.CLASSES).classes
    assert classes is not None
    numbers = cv2.imdecode(np.frombuffer(classes.png, dtype=np.uint8), cv2.IMREAD_UNCHANGED)
    assert numbers is not None
    assert numbers.shape == tuple(-(-side // classes.step_px) for side in image.shape[:2])
    assert numbers.shape[1] <= 480
    names = [color.name for color in classes.colors]
    assert {"blue", "yellow", "orange"} <= {names[number - 1] for number in np.unique(numbers) if number}


def test_everything_in_a_demo_frame_is_accepted(maker: OverlayMaker, image: Bytes) -> None:
    found = made(maker, image, Layer.HYPOTHESES).hypotheses
    assert found is not None
    accepted = [shown for shown in found.shown if shown.is_accepted]
    per_team = SETTINGS.synthetic.robots_per_team
    assert sorted(shown.what for shown in accepted) == [
        "ball",
        *["blue robot"] * per_team,
        *["yellow robot"] * per_team,
    ]
    assert all(shown.id is not None for shown in accepted if shown.what != "ball")


def test_a_marker_of_the_wrong_size_is_rejected_with_the_sizes(maker: OverlayMaker, image: Bytes) -> None:
    tampered = image.copy()
    place = empty_place(tampered)
    draw_circle(tampered, place, 20.0, BLUE_BGR, -1)
    found = made(maker, tampered, Layer.HYPOTHESES).hypotheses
    assert found is not None
    (blob,) = [shown for shown in found.shown if np.hypot(shown.x_px - place[0], shown.y_px - place[1]) < 3.0]
    assert not blob.is_accepted
    assert blob.gate == "of the wrong size (robots.min_area, robots.max_area)"
    assert blob.found.startswith("circle 4")
    low, high = (float(word) for word in blob.accepted.removesuffix(" px").split(" to "))
    assert low < high < 40.0


def empty_place(image: Bytes) -> tuple[float, float]:
    """A pixel of the field without anything of a color near it."""
    perception = Perception(SETTINGS, CAMERA)
    classes = perception.table.classes_of(image)
    height, width = classes.shape
    for y in range(height // 3, 2 * height // 3, 10):
        for x in range(width // 3, 2 * width // 3, 10):
            if not classes[y - 30 : y + 30, x - 30 : x + 30].any():
                return float(x), float(y)
    raise AssertionError("the field is full")


def test_lines_and_boundary_of_a_demo_frame_are_found(maker: OverlayMaker, image: Bytes) -> None:
    overlay = made(maker, image, Layer.LINES, Layer.BOUNDARY)
    assert overlay.lines
    found = [line for line in overlay.lines if line.is_found]
    assert len(found) == line_check(image, SETTINGS.field, CAMERA.model).found >= 8
    assert all(abs(line.offset_px or 0.0) < 0.5 for line in found)
    assert overlay.boundary is not None
    assert overlay.boundary.found > 0.8


def test_a_line_without_paint_says_so(maker: OverlayMaker, image: Bytes) -> None:
    lines = made(maker, np.full_like(image, 90), Layer.LINES).lines
    assert lines
    assert {(line.is_found, line.found) for line in lines} == {(False, "paint on 0% of its length")}


def test_noise_fits_into_the_record(maker: OverlayMaker) -> None:
    noise = np.random.default_rng(1).integers(0, 255, CAMERA.shape, dtype=np.uint8)
    overlay = made(maker, noise, *Layer)
    assert overlay.blobs is not None
    assert overlay.blobs.count > len(overlay.blobs.shown) == MAX_BLOBS
    assert overlay.hypotheses is not None
    assert overlay.hypotheses.count > len(overlay.hypotheses.shown) == MAX_HYPOTHESES
    assert len(records.overlay("main").encode(overlay)) <= records.MAX_OVERLAY


def test_a_masked_robot_is_not_seen_and_has_no_colors(maker: OverlayMaker, image: Bytes) -> None:
    found = made(maker, image, Layer.HYPOTHESES).hypotheses
    assert found is not None
    robot = next(shown for shown in found.shown if shown.is_accepted and shown.what != "ball")
    reach = robot.radius_px + 4.0
    sides = robot.x_px - reach, robot.y_px - reach, robot.x_px + reach, robot.y_px + reach
    left, top, right, bottom = sides
    corners = [[left, top], [right, top], [right, bottom], [left, bottom]]
    settings = load_settings(options={"camera.masks": [{"name": "scoreboard", "points_px": corners}]})
    camera = CameraSetup.from_settings(settings)
    perception = Perception(settings, camera)
    before = Perception(SETTINGS, CAMERA).perceive(ImageFrame("main", 1, Instant(0), image), ManualClock()).record()
    for number in range(1, 4):
        frame = ImageFrame("main", number, Instant(number), image)
        seen = perception.perceive(frame, ManualClock()).record()
        assert len(seen.robots) == len(before.robots) - 1
        assert all(np.hypot(one.x_px - robot.x_px, one.y_px - robot.y_px) > 5.0 for one in seen.robots)
    overlay = OverlayMaker(perception).make(frame, (Layer.CLASSES, Layer.HYPOTHESES), ManualClock())
    assert overlay.hypotheses is not None
    assert not [one for one in overlay.hypotheses.shown if left < one.x_px < right and top < one.y_px < bottom]
    assert overlay.classes is not None
    numbers = cv2.imdecode(np.frombuffer(overlay.classes.png, dtype=np.uint8), cv2.IMREAD_UNCHANGED)
    assert numbers is not None
    x, y = round(robot.x_px / overlay.classes.step_px), round(robot.y_px / overlay.classes.step_px)
    assert not numbers[y - 3 : y + 4, x - 3 : x + 4].any()
