"""The picture of a fake service: robots, obstacles and ball painted where the camera would see them."""

import numpy as np

from vision_core.geometry import Bytes, Floats, rotation
from vision_core.models.camera_setup import CameraSetup
from vision_core.models.from_settings import robots_of
from vision_core.settings.schema import Settings
from vision_core.types.objects import Team

COLORS = {Team.BLUE: (220, 90, 30), Team.YELLOW: (40, 200, 240)}
Color = tuple[int, int, int]
Pose = tuple[Team, int, float, float, float]
"""Team, number, x, y [m], heading [rad]."""


class FakePicture:
    """Paints the field's things, pixel by pixel by where each pixel looks."""

    def __init__(self, settings: Settings, things: list[tuple[float, float, float]]) -> None:
        """things: x, y and radius of what stands there all the time [m]."""
        self._settings = settings
        self._camera = CameraSetup.from_settings(settings).model
        self._places: dict[float, Floats] = {}
        """By height [m]: what every pixel sees in that plane."""
        shape = (settings.camera.height_px, settings.camera.width_px, 3)
        noise = np.random.default_rng(1).integers(0, 12, shape, dtype=np.uint8)
        self._carpet: Bytes = np.full(shape, (45, 90, 50), dtype=np.uint8) + noise
        for x, y, radius in things:
            self._paint(self._carpet, 0.0, (x, y), radius, (130, 130, 140))

    def drawn(self, poses: list[Pose], ball: tuple[float, float]) -> Bytes:
        """One picture, shape (height, width, 3), blue green red."""
        image = self._carpet.copy()
        for team, _number, x, y, heading in poses:
            body = robots_of(self._settings.robots, team)
            turned = heading if body.outline == "square" else None
            self._paint(image, body.height_m, (x, y), body.radius_m, (30, 30, 30), turned)
            self._paint(image, body.height_m, (x, y), 0.3 * body.radius_m, COLORS[team])
        self._paint(image, 0.0, ball, self._settings.ball.radius_m, (20, 120, 240))
        return image

    def _places_at(self, height_m: float) -> Floats:
        """What every pixel sees in a plane [m], shape (height, width, 2)."""
        camera = self._settings.camera
        rows, columns = np.indices((camera.height_px, camera.width_px), dtype=np.float64)
        pixels = np.column_stack([columns.ravel(), rows.ravel()])
        return self._camera.field_from_pixel(pixels, height_m).reshape(*rows.shape, 2)

    def _paint(
        self,
        image: Bytes,
        height_m: float,
        at: tuple[float, float],
        radius_m: float,
        color: Color,
        turned_rad: float | None = None,
    ) -> None:
        """Color a disc in a plane over the floor, or a square that is turned."""
        if height_m not in self._places:
            self._places[height_m] = self._places_at(height_m)
        x, y = self._camera.pixel_from_field(np.array([at]), height_m)[0].astype(int).tolist()
        reach = 2 + int(1.5 * radius_m * self._camera.pixels_per_metre(at, height_m))
        window = slice(max(y - reach, 0), y + reach + 1), slice(max(x - reach, 0), x + reach + 1)
        away = self._places[height_m][window] - at
        if turned_rad is None:
            inside = np.hypot(away[..., 0], away[..., 1]) <= radius_m
        else:
            inside = np.abs(away @ rotation(turned_rad)).max(axis=-1) <= radius_m
        image[window][inside] = color
