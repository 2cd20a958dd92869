"""The light in which a venue's colors are kept: that of a picture, brightened so that colors are told apart well."""

import msgspec
import numpy as np

from vision_core.color.light import field_samples, reference_of
from vision_core.geometry import Bytes
from vision_core.models.camera_setup import CameraSetup
from vision_core.settings.schema import LightSettings, Settings
from vision_core.types.colors import LUMA_BGR

BRIGHT_LUMA, BRIGHT_SHARE = 200.0, 0.99
"""The field's brightest colors, up to this share of it, get this luma."""
MAX_GAIN = 12.0
BLACK_SHARE, MAX_BLACK = 0.005, 45.0
"""The darkest share of a picture shows what the sensor delivers in the dark; at most so many levels."""
BANDS = (0.25, 0.75), (0.96, 0.99)
"""The carpet; on a black field, which tells nothing about the light, the lines and walls."""
MIN_SIGNAL = 8.0
"""Levels over black that the carpet needs in every channel."""


def light_from(pixels: Bytes, settings: Settings) -> LightSettings:
    """The light of a picture, shape (height, width, 3), as settings."""
    camera = CameraSetup.from_settings(settings)
    places = field_samples(camera.model, settings.field, camera.size_px, 0.0)
    black = np.minimum(np.quantile(pixels.reshape(-1, 3)[::7], BLACK_SHARE, axis=0), MAX_BLACK)
    floor = (pixels[places[:, 1], places[:, 0]] - black) @ LUMA_BGR
    gain = min(max(BRIGHT_LUMA / max(float(np.quantile(floor, BRIGHT_SHARE)), 1.0), 1.0), MAX_GAIN)
    signals = [np.array(reference_of(pixels, places, band)[0]) - black for band in BANDS]
    number = 0 if signals[0].min() >= MIN_SIGNAL else 1
    blue, green, red = np.clip(signals[number] * gain, 0.5, 255.0).tolist()
    return msgspec.structs.replace(
        settings.colors.light,
        black_bgr=(float(black[0]), float(black[1]), float(black[2])),
        band=BANDS[number],
        reference_bgr=(blue, green, red),
        white_balance=True,
        margin_m=0.0,
        gain_bgr=(gain, gain, gain),
    )
