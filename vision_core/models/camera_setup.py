"""One camera of a venue: its name, picture and rate, and the geometry that follows from its settings.

Everything that depends on a camera takes a ``CameraSetup`` that was built once per process and handed on. Only
the rules of ``venues``, which check it, read ``settings.camera`` as well. A second camera is then a second setup.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from vision_core.geometry import Bytes, Floats, Mask
from vision_core.models.camera import CameraModel, HomographyCamera, PinholeCamera
from vision_core.models.masks import masked_pixels
from vision_core.settings.schema import CameraSettings, Settings


@dataclass(frozen=True)
class CameraSetup:
    """One camera as the settings describe it. Its geometry is computed when it is first asked for, and kept."""

    settings: CameraSettings

    @classmethod
    def from_settings(cls, settings: Settings) -> "CameraSetup":
        """The venue's camera."""
        return cls(settings.camera)

    @property
    def name(self) -> str:
        """Names the camera's records, ``frames/<name>``."""
        return self.settings.name

    @property
    def rate_hz(self) -> float:
        """Images per second that the camera is asked to deliver."""
        return self.settings.rate_hz

    @property
    def shutter_delay_ms(self) -> float:
        """From a change of the light to the grab of the image that shows it."""
        return self.settings.shutter_delay_ms

    @property
    def size_px(self) -> tuple[int, int]:
        """Width and height of an image [px]."""
        return self.settings.width_px, self.settings.height_px

    @property
    def shape(self) -> tuple[int, int, int]:
        """Shape of an image's array: (height, width, 3), channels blue, green, red."""
        return self.settings.height_px, self.settings.width_px, 3

    def black_image(self) -> Bytes:
        """A new image without light, uint8, shape ``shape``."""
        return np.zeros(self.shape, dtype=np.uint8)

    @cached_property
    def model(self) -> CameraModel:
        """Maps between pixels and field: a pinhole with a lens, or a homography."""
        camera = self.settings
        if camera.model == "pinhole":
            lens = camera.pinhole
            return PinholeCamera(lens.focal_px, lens.center_px, lens.distortion, lens.position_m, lens.rotation_deg)
        assert camera.homography is not None  # venues.rules
        pixels = np.array([point.pixel_px for point in camera.homography.points])
        places = np.array([point.field_m for point in camera.homography.points])
        return HomographyCamera(pixels, places, camera.homography.position_m)

    @cached_property
    def masked(self) -> Mask | None:
        """The pixels in which nothing is looked for, shape (height, width); None where everything is."""
        return masked_pixels(self.settings.masks, self.size_px)

    def seen_floor_m(self, steps: int) -> Floats:
        """Border of the part of the floor that the picture shows [m], shape (n, 2), n <= 4 * steps.

        steps: points along each side of the picture, the first in its corner, since lenses bend straight sides. Points
        at which the camera sees no floor are left out.
        """
        width, height = self.size_px
        corners = np.array([[0.0, 0.0], [width, 0.0], [width, height], [0.0, height]])
        shares = np.arange(steps)[:, None] / steps
        sides = [a + shares * (b - a) for a, b in zip(corners, np.roll(corners, -1, axis=0), strict=True)]
        floor = self.model.field_from_pixel(np.concatenate(sides))
        seen: Floats = floor[np.isfinite(floor).all(axis=1)]
        return seen
