"""Robots whose colors a reflection hides: read by their shape, where the search or the last frame says they are."""

import math

import numpy as np
import pytest

from tests.objects.drawing import PAINTS, SETTINGS, turn_between
from vision_core.capture.synthetic.camera import SyntheticCamera
from vision_core.clock import Instant, ManualClock
from vision_core.geometry import Bytes, Floats
from vision_core.models.camera_setup import CameraSetup
from vision_core.pipeline.perception import Perception
from vision_core.types.image import ImageFrame
from vision_core.types.tables import NO_ID, Table

CAMERA = CameraSetup.from_settings(SETTINGS)


@pytest.fixture(scope="module")
def perception() -> Perception:
    perception = Perception(SETTINGS, CAMERA)
    perception.warm_up()
    return perception


class Film:
    """A simulated match in which one robot can be changed."""

    def __init__(self) -> None:
        self.clock = ManualClock()
        self._camera = SyntheticCamera(SETTINGS, CAMERA, self.clock, paced=False)
        self._pixels = np.empty(CAMERA.shape, dtype=np.uint8)
        self._number = 0
        y, x = np.mgrid[0 : CAMERA.shape[0], 0 : CAMERA.shape[1]]
        self._all = np.column_stack([x.ravel(), y.ravel()]).astype(np.float64)
        self._places: Floats = CAMERA.model.field_from_pixel(self._all, SETTINGS.robots.height_m)

    def next(self) -> None:
        self._number += 1
        self.grabbed = self._camera.grab(self._pixels)
        robots = [robot for robot in self._camera.truth.robots if robot.team == "blue"]
        self.robot = robots[0]

    def frame(self, white: float = 0.0, *, lifted: bool = False) -> ImageFrame:
        """The picture with so much white on the robot, or without it."""
        pixels: Bytes = self._pixels.copy()
        on_robot = np.hypot(*(self._places - (self.robot.x_m, self.robot.y_m)).T) < 0.085
        flat = pixels.reshape(-1, 3)
        flat[on_robot] = ((1.0 - white) * flat[on_robot] + white * 235.0).astype(np.uint8)
        if lifted:
            flat[on_robot] = PAINTS["carpet"]
        return ImageFrame("main", self._number, self.grabbed, pixels)

    def read(self, robots: Table) -> Table:
        """The rows of the robot that may be changed."""
        rows: Table = robots[(robots["team"] == 0) & (robots["id"] == self.robot.id)]
        return rows

    def is_right(self, robot: Table) -> bool:
        near = math.dist((robot["x_m"], robot["y_m"]), (self.robot.x_m, self.robot.y_m)) < 0.006
        return near and turn_between(float(robot["heading_rad"]), self.robot.heading_rad) < math.radians(6.0)


VEIL = 0.62


@pytest.mark.slow
def test_a_robot_that_drives_into_glare_is_held(perception: Perception) -> None:
    film, alone = Film(), Perception(SETTINGS, CAMERA)
    by_blobs = 0
    for number in range(20):
        film.next()
        frame = film.frame(VEIL if number >= 5 else 0.0)
        perception.perceive(frame, film.clock)
        (robot,) = film.read(perception.robots)
        assert film.is_right(robot)
        alone.perceive(ImageFrame("main", 1, Instant(0), frame.pixels), film.clock)
        by_blobs += len(film.read(alone.robots))
    assert by_blobs < 8


@pytest.mark.slow
def test_a_robot_that_is_lifted_is_not_held(perception: Perception) -> None:
    film = Film()
    for number in range(8):
        film.next()
        perception.perceive(film.frame(lifted=number >= 5), film.clock)
        assert len(film.read(perception.robots)) == (number < 5)


@pytest.mark.slow
def test_the_search_finds_a_robot_that_stands_in_glare(perception: Perception) -> None:
    film = Film()
    film.next()
    frame = film.frame(VEIL)
    perception.perceive(frame, film.clock)
    assert not len(film.read(perception.robots))
    others = len(perception.robots)
    perception.perceive_still(frame, film.clock)
    (robot,) = film.read(perception.robots)
    assert film.is_right(robot)
    assert len(perception.robots) == others + 1
    perception.perceive(frame, film.clock)
    assert not len(film.read(perception.robots))
    found = perception.unseen_robots(frame, film.clock)
    assert len(found.poses) == 1
    perception.suggest(found)
    perception.perceive(frame, film.clock)
    assert len(film.read(perception.robots)) == 1


def test_an_empty_field_suggests_nothing(perception: Perception) -> None:
    pixels = np.full(CAMERA.shape, PAINTS["carpet"], dtype=np.uint8)
    frame = ImageFrame("main", 1, Instant(0), pixels)
    perception.perceive(frame, ManualClock())
    found = perception.unseen_robots(frame, ManualClock())
    assert not len(found.poses)
    assert not (perception.robots["id"] != NO_ID).any()
