"""On-board pictures of scenes made by hand: no noise, even light, a short exposure."""

from typing import Any

import numpy as np

from tests.capture.synthetic.scenes import plain_settings
from vision_core.geometry import Bytes, Floats, Mask
from vision_core.onboard.camera import SIZE_PX, OnboardCamera
from vision_core.onboard.scene import Scene, snapshot_of
from vision_core.settings.schema import Settings
from vision_core.types.objects import Team

FAR_BALL = (-1.3, -1.1)
OUTSIDE = (-1.3, 1.0, 0.0)
"""Where a robot that a test does not need stands."""


def lone_pair(**options: Any) -> Settings:
    """Settings with one robot per team; options with __ for the dot."""
    return plain_settings(synthetic__robots_per_team=1, synthetic__walking_people=0, **options)


class Lab:
    """The camera of blue 1, and pictures of robots (x, y, heading) and ball (x, y) around it."""

    def __init__(self, settings: Settings, size_px: tuple[int, int] = SIZE_PX) -> None:
        self.camera = OnboardCamera(settings, (Team.BLUE, 1), size_px=size_px)
        self.mirror = self.camera.mirror

    def scene(self, *robots: tuple[float, float, float], ball: tuple[float, float] = FAR_BALL) -> Scene:
        """The first robot carries the camera; those that are left out stand outside."""
        missing = len(self.camera.worn) - len(robots)
        return self.camera.scene(snapshot_of(np.array([*robots, *[OUTSIDE] * missing]), ball))

    def picture(self, *robots: tuple[float, float, float], ball: tuple[float, float] = FAR_BALL) -> Bytes:
        """Blue green red, without noise."""
        return self.camera.exact_picture(self.scene(*robots, ball=ball))

    def px_of(self, floor_mm: float) -> float:
        """Radius of a distance on the floor, in pixels of the picture."""
        return self.mirror.px_from_mm(floor_mm) * self.camera.scale

    def along(self, picture: Bytes, direction_deg: float, radii_px: Floats) -> Floats:
        """Colors at radii [px of the picture] in a direction, by bilinear interpolation; shape (n, 3)."""
        angle = np.radians(direction_deg)
        at = np.asarray(radii_px) / self.camera.scale
        places = self.camera.pixel_from_px(at * np.cos(angle), at * np.sin(angle))
        first = np.floor(places).astype(int)
        share = places - first
        colors = np.zeros((len(places), 3))
        for du in (0, 1):
            for dv in (0, 1):
                weight = np.abs(1 - du - share[:, 0]) * np.abs(1 - dv - share[:, 1])
                colors += weight[:, None] * picture[first[:, 1] + dv, first[:, 0] + du]
        return colors


def orange(picture: Bytes) -> Mask:
    """Where the ball is seen, shape (height, width)."""
    blue, green, red = np.moveaxis(picture.astype(np.int64), 2, 0)
    return np.asarray((red > 110) & (red > 2 * blue) & (red > 1.3 * green) & (green > 40))


def step_at(levels: Floats, at: Floats) -> float:
    """Where levels pass the middle between the first and the last for the first time, by interpolation."""
    middle = 0.5 * (levels[0] + levels[-1])
    passed = (levels - middle) * (levels[-1] - levels[0]) > 0.0
    k = int(passed.argmax())
    return float(at[k - 1] + (at[k] - at[k - 1]) * (middle - levels[k - 1]) / (levels[k] - levels[k - 1]))
