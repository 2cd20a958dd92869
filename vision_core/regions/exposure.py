"""Is there enough light on the field, and not too much?"""

import numpy as np

from vision_core.geometry import Bytes, Floats
from vision_core.models.camera import CameraModel
from vision_core.models.field import accepted_half_extent
from vision_core.settings.schema import FieldSettings
from vision_core.types.regions import ExposureCheck

POINTS = 60
"""Along either side of the field."""
ALIKE = 2.5
"""Grey levels by which the pixels of a picture that shows nothing differ (standard deviation)."""
DARK, BLACK = 100.0, 30.0
"""Grey levels that something on a field reaches: a line, a marker, a ball."""
WHITE = 250
MAX_WHITE, MAX_AT_END = 0.15, 0.4
"""Share of the field in which two channels may be at the sensor's end, and one."""
LUMA = np.array([0.114, 0.587, 0.299])
NOTHING = "the picture shows nothing of the field: camera position or field measures are wrong"


def field_pixels(field: FieldSettings, camera: CameraModel, size_px: tuple[int, int]) -> Floats:
    """Pixels spread over the field as far as the picture shows it, shape (n, 2); size_px: width and height."""
    half_x, half_y = accepted_half_extent(field)
    x, y = np.meshgrid(np.linspace(-half_x, half_x, POINTS), np.linspace(-half_y, half_y, POINTS))
    pixel = camera.pixel_from_field(np.column_stack([x.ravel(), y.ravel()]))
    with np.errstate(invalid="ignore"):
        inside = ((pixel >= 0.0) & (pixel <= np.array(size_px) - 1.0)).all(axis=1)
    return pixel[inside]


def exposure_check(pixels: Bytes, points_px: Floats) -> ExposureCheck:
    """How light the field is in a picture, in numbers and in words.

    pixels: shape (height, width, 3), blue green red; points_px: of the field, see ``field_pixels``.
    """
    if not len(points_px):
        return ExposureCheck(None, None, None, (NOTHING,))
    x, y = points_px.round().astype(np.intp).T
    seen = pixels[y, x].astype(np.float64)
    brightest = float(np.percentile(seen.max(axis=1), 99.8))
    _, two, one = (np.sort(seen, axis=1) >= WHITE).mean(axis=0).tolist()
    return ExposureCheck(
        brightest=brightest,
        median_luma=float(np.median(seen @ LUMA)),
        white=one,
        reasons=_blamed(brightest, float(seen.std(axis=0).max()), two, one),
    )


def exposure_reasons(pixels: Bytes, points_px: Floats) -> tuple[str, ...]:
    """What is wrong with a picture's light, in words; takes what ``exposure_check`` takes."""
    return exposure_check(pixels, points_px).reasons


def _blamed(brightest: float, deviation: float, two: float, one: float) -> tuple[str, ...]:
    """What numbers say in words. two, one: share of the field in which so many channels are at the sensor's end."""
    if brightest < BLACK:
        return (
            f"the picture is black: nothing on the field is brighter than {brightest:.0f} of 255 (lens cap, lamps?)",
        )
    if deviation < ALIKE:
        return ("the picture shows nothing: every pixel of the field has the same color",)
    if brightest < DARK:
        return (f"too dark: nothing on the field is brighter than {brightest:.0f} of 255 (lamps, exposure?)",)
    if two > MAX_WHITE or one > MAX_AT_END:
        return (f"over-exposed: {one:.0%} of the field is as bright as the sensor can tell (exposure, gain?)",)
    return ()
