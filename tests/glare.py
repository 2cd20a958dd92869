"""A simulated match in which a reflection hides the colors of one robot."""

import math

import numpy as np

from tests.objects.drawing import PAINTS, SETTINGS, turn_between
from vision_core.capture.synthetic.camera import SyntheticCamera
from vision_core.clock import ManualClock
from vision_core.geometry import Bytes, Floats, rotation
from vision_core.models.camera_setup import CameraSetup
from vision_core.types.image import ImageFrame
from vision_core.types.tables import Table

CAMERA = CameraSetup.from_settings(SETTINGS)
TOP, DOT = (0.0, 0.0, 0.085), (0.035, 0.055, 0.024)
"""Of a robot, and of its front left dot: middle, forward and left of the robot's, and radius [m]."""
VEIL = 0.62
"""So much white on the robot hides it from the blobs in most frames."""


class Film:
    """A simulated match in which one robot can be changed."""

    def __init__(self) -> None:
        self.clock = ManualClock()
        self._camera = SyntheticCamera(SETTINGS, CAMERA, self.clock, paced=False)
        self._pixels = np.empty(CAMERA.shape, dtype=np.uint8)
        self.number = 0
        y, x = np.mgrid[0 : CAMERA.shape[0], 0 : CAMERA.shape[1]]
        self._all = np.column_stack([x.ravel(), y.ravel()]).astype(np.float64)
        self._places: Floats = CAMERA.model.field_from_pixel(self._all, SETTINGS.robots.height_m)

    def next(self) -> None:
        self.number += 1
        self.grabbed = self._camera.grab(self._pixels)
        robots = [robot for robot in self._camera.truth.robots if robot.team == "blue"]
        self.robot = robots[0]

    def frame(
        self, white: float = 0.0, *, on: tuple[float, float, float] = TOP, lifted: bool = False
    ) -> ImageFrame:  # fmt: skip
        """The picture with so much white on the robot, or without it. on: where it is white, ``TOP`` or ``DOT``."""
        pixels: Bytes = self._pixels.copy()
        middle = np.array([self.robot.x_m, self.robot.y_m]) + rotation(self.robot.heading_rad) @ on[:2]
        on_robot = np.hypot(*(self._places - middle).T) < on[2]
        flat = pixels.reshape(-1, 3)
        flat[on_robot] = ((1.0 - white) * flat[on_robot] + white * 235.0).astype(np.uint8)
        if lifted:
            flat[on_robot] = PAINTS["carpet"]
        return ImageFrame("main", self.number, self.grabbed, pixels)

    def read(self, robots: Table) -> Table:
        """The rows of the robot that may be changed."""
        rows: Table = robots[(robots["team"] == 0) & (robots["id"] == self.robot.id)]
        return rows

    def is_right(self, robot: Table) -> bool:
        near = math.dist((robot["x_m"], robot["y_m"]), (self.robot.x_m, self.robot.y_m)) < 0.006
        return near and turn_between(float(robot["heading_rad"]), self.robot.heading_rad) < math.radians(6.0)
