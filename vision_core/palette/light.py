"""The light in which a venue's colors are kept: that of a picture, brightened so that colors are told apart well."""

import msgspec
import numpy as np

from vision_core.color.light import MIN_SIGNAL, field_samples, reference_of
from vision_core.geometry import Bytes, Floats, PixelPlaces
from vision_core.models.camera_setup import CameraSetup
from vision_core.native.opencv import median_filtered
from vision_core.settings.schema import FieldSettings, LightSettings, Settings

BRIGHT_LEVEL, BRIGHT_SHARE = 240.0, 0.998
"""The brightest channel of the field's colors, up to this share of them, gets this level: no paper may saturate, and
one robot's take 0.3 % of the smallest field."""
MAX_GAIN = 12.0
PATCH_PX = 9
"""The darkest square of so many pixels shows the most that the sensor can deliver in the dark."""
DARK_SHARE = 0.1
"""That is so much light at most: shadow on something black has less than a tenth of the level of white."""
CARPET, BRIGHTEST = (0.25, 0.75), (0.96, 0.99)
"""Bands of samples: the carpet; on a black field that tells nothing about the light, the lines and walls."""
CARPET_SIGNAL = 4.0 * MIN_SIGNAL
"""Levels over black that the carpet needs in every channel: a quarter of the light can be measured then, too."""
WALLS_M = 0.04
"""How far outside the field white walls are looked for: their tops."""


def light_from(pixels: Bytes, settings: Settings) -> LightSettings:
    """The light of a picture, shape (height, width, 3), as settings."""
    camera = CameraSetup.from_settings(settings)
    places = field_samples(camera.model, settings.field, camera.size_px, 0.0)
    floor = pixels[places[:, 1], places[:, 0]]
    bright = float(np.quantile(floor.max(axis=1), BRIGHT_SHARE))
    black = black_of(pixels, bright)
    signal, band, margin_m = _reference(pixels, places, settings.field, camera, black)
    brightest = max(bright - float(black.max()), float(np.nan_to_num(signal).max()), 1.0)
    gain = min(max(BRIGHT_LEVEL / brightest, 1.0), MAX_GAIN)
    blue, green, red = np.clip(signal * gain, 0.5, 255.0).tolist()
    return msgspec.structs.replace(
        settings.colors.light,
        black_bgr=(float(black[0]), float(black[1]), float(black[2])),
        band=band,
        reference_bgr=(blue, green, red),
        white_balance=True,
        margin_m=margin_m,
        gain_bgr=(gain, gain, gain),
    )


def black_of(pixels: Bytes, bright: float) -> Floats:
    """The sensor's level in the dark, blue, green, red, as far as a picture shows it; shape (3,).

    The darkest patch is at least as bright. It is taken for the sensor's black where it is too bright for a dark thing
    beside the brightest colors, ``bright``; otherwise nothing tells how much of it is light, and the level is 0.
    """
    dark: Floats = median_filtered(pixels, PATCH_PX).reshape(-1, 3).min(axis=0).astype(np.float64)
    return dark if dark.mean() > DARK_SHARE * bright else np.zeros(3)


def _reference(
    pixels: Bytes, places: PixelPlaces, field: FieldSettings, camera: CameraSetup, black: Floats
) -> tuple[Floats, tuple[float, float], float]:
    """What the light is measured on: its signal over black, shape (3,), the band of samples, and their margin [m]."""
    carpet = np.array(reference_of(pixels, places, CARPET)[0]) - black
    lines = np.array(reference_of(pixels, places, BRIGHTEST)[0]) - black
    if carpet.min() >= CARPET_SIGNAL:
        return carpet, CARPET, 0.0
    if field.walls:
        with_walls = field_samples(camera.model, field, camera.size_px, WALLS_M)
        walls = np.array(reference_of(pixels, with_walls, BRIGHTEST)[0]) - black
        if walls.min() > lines.min():
            return walls, BRIGHTEST, WALLS_M
    return lines, BRIGHTEST, 0.0
