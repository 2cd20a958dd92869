"""Is there enough light on the field, and not too much?"""

import numpy as np

from vision_core.geometry import Bytes, Floats
from vision_core.models.camera import CameraModel
from vision_core.models.field import accepted_half_extent
from vision_core.settings.schema import FieldSettings
from vision_core.types.colors import LUMA_BGR
from vision_core.types.reasons import Reason
from vision_core.types.regions import ExposureCheck

POINTS = 60
"""Points of the sampling grid along each axis of the field."""
MIN_DEVIATION = 2.5
"""Standard deviation of the pixels below which a picture shows nothing [grey levels]."""
DARK, BLACK = 100.0, 30.0
"""In a picture that is light enough something on the field is brighter than this: a line, a marker, a ball [grey
levels]."""
BRIGHTEST_PERCENTILE = 99.8
"""The brightest 0.2 % of the field are left out: reflections."""
SATURATED = 250
"""From this level on a channel is saturated."""
MAX_TWO_SATURATED, MAX_ONE_SATURATED = 0.15, 0.4
"""Share of the field in which two channels may be saturated, and one."""
NOTHING = Reason(
    "the picture shows no part of the field: the camera position or the field measures are wrong",
    "Correct the camera's position and the field's measures in the venue's file.",
)


def field_pixels(field: FieldSettings, camera: CameraModel, size_px: tuple[int, int]) -> Floats:
    """Pixels of a grid over the field, those in the picture only; shape (n, 2). size_px: width and height."""
    half_x, half_y = accepted_half_extent(field)
    x, y = np.meshgrid(np.linspace(-half_x, half_x, POINTS), np.linspace(-half_y, half_y, POINTS))
    pixel = camera.pixel_from_field(np.column_stack([x.ravel(), y.ravel()]))
    with np.errstate(invalid="ignore"):
        inside = ((pixel >= 0.0) & (pixel <= np.array(size_px) - 1.0)).all(axis=1)
    return pixel[inside]


def exposure_check(pixels: Bytes, points_px: Floats) -> ExposureCheck:
    """How well the field is lit in a picture, in numbers and in words.

    pixels: shape (height, width, 3), blue green red; points_px: of ``field_pixels``.
    """
    if not len(points_px):
        return ExposureCheck(None, None, None, (NOTHING,))
    x, y = points_px.round().astype(np.intp).T
    seen = pixels[y, x].astype(np.float64)
    brightest = float(np.percentile(seen.max(axis=1), BRIGHTEST_PERCENTILE))
    _, two, one = (np.sort(seen, axis=1) >= SATURATED).mean(axis=0).tolist()
    return ExposureCheck(
        brightest=brightest,
        median_luma=float(np.median(seen @ LUMA_BGR)),
        white=one,
        reasons=_reasons(brightest, float(seen.std(axis=0).max()), two, one),
    )


def exposure_reasons(pixels: Bytes, points_px: Floats) -> tuple[Reason, ...]:
    """What is wrong with a picture's light; the arguments of ``exposure_check``."""
    return exposure_check(pixels, points_px).reasons


def _reasons(brightest: float, deviation: float, two: float, one: float) -> tuple[Reason, ...]:
    """What is wrong. two, one: share of the field in which so many channels are saturated."""
    if brightest < BLACK:
        black = f"the picture is black: nothing on the field is brighter than {brightest:.0f} of 255"
        return (Reason(black, "Take off the lens cap, switch on the lamps, or open the lens."),)
    if deviation < MIN_DEVIATION:
        blank = "the picture shows nothing: all pixels of the field have the same color"
        return (Reason(blank, "Check the lens cap, the camera's cable and the source."),)
    if brightest < DARK:
        dark = f"too dark: nothing on the field is brighter than {brightest:.0f} of 255"
        return (Reason(dark, "Switch on more lamps, open the lens, or let the camera expose longer."),)
    if two > MAX_TWO_SATURATED or one > MAX_ONE_SATURATED:
        bright = f"over-exposed: {one:.0%} of the field is saturated, as bright as the camera can measure"
        return (Reason(bright, "Close the lens, or lower the camera's exposure or gain."),)
    return ()
