"""Pictures of the simulated camera, with the places of everything colored in them, as a new venue's."""

from dataclasses import dataclass
from functools import cache

import numpy as np

from vision_core.capture.synthetic.camera import SyntheticCamera
from vision_core.capture.synthetic.truth import Truth
from vision_core.clock import ManualClock
from vision_core.geometry import Bytes, rotation
from vision_core.models.camera_setup import CameraSetup
from vision_core.patterns.loader import load_pattern
from vision_core.settings.schema import Settings
from vision_core.types.objects import Team
from vision_core.venues.loader import load_settings

APART_FRAMES = 45
"""Between two pictures: robots have moved on."""
MARGIN_PX = 12.0


@dataclass(frozen=True)
class DemoPicture:
    """A picture with its truth."""

    pixels: Bytes
    truth: Truth
    settings: Settings

    def papers(self) -> dict[str, list[tuple[int, int]]]:
        """Pixels in the middle of the papers by their colors, the ball's too."""
        settings, camera = self.settings, CameraSetup.from_settings(self.settings).model
        pattern, body = load_pattern(settings.robots.patterns[0]), settings.robots
        found: dict[str, list[tuple[int, int]]] = {}
        for robot in self.truth.robots:
            colors = pattern.colors_worn(robot.team, robot.id)
            for patch, color in zip(pattern.patches, colors, strict=True):
                assert patch.circle_mm is not None
                offset = rotation(robot.heading_rad) @ (np.array(patch.circle_mm[:2]) * 1e-3)
                self._add(
                    found, color, camera.pixel_from_field(np.array([robot.x_m, robot.y_m]) + offset, body.height_m)
                )
        ball = np.array([self.truth.ball.x_m, self.truth.ball.y_m])
        if self.truth.ball.visible_share == 1.0:
            self._add(found, settings.ball.color, camera.pixel_from_field(ball, settings.ball.radius_m))
        return found

    def ids(self) -> set[tuple[Team, int]]:
        """Teams and marker ids of the robots that are in the picture."""
        return {(robot.team, robot.id) for robot in self.truth.robots if robot.in_picture}

    def _add(self, found: dict[str, list[tuple[int, int]]], color: str, pixel: np.ndarray) -> None:
        x, y = pixel[0].tolist()
        height, width, _ = self.pixels.shape
        if MARGIN_PX < x < width - MARGIN_PX and MARGIN_PX < y < height - MARGIN_PX:
            found.setdefault(color, []).append((round(x), round(y)))


@cache
def demo_pictures(count: int = 1) -> tuple[DemoPicture, ...]:
    """Pictures of the simulated match, apart in time; the same on every call."""
    settings = load_settings()
    setup = CameraSetup.from_settings(settings)
    clock = ManualClock()
    source = SyntheticCamera(settings, setup, clock, paced=False)
    pictures = []
    for _ in range(count):
        pixels = setup.black_image()
        for _ in range(APART_FRAMES):
            source.grab(pixels)
        pictures.append(DemoPicture(pixels, source.truth, settings))
    return tuple(pictures)
