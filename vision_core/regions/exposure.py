"""Is there enough light on the field, and not too much?"""

import numpy as np

from vision_core.camera_model import CameraModel
from vision_core.field_model import accepted_half_extent
from vision_core.geometry import Bytes, Floats
from vision_core.settings import FieldSettings

POINTS = 60
"""Along either side of the field."""
ALIKE = 2.5
"""Grey levels by which the pixels of a picture that shows nothing differ (standard deviation)."""
DARK, BLACK = 100.0, 30.0
"""Grey levels that something on a field reaches: a line, a marker, a ball."""
WHITE = 250
MOST_WHITE, MOST_AT_END = 0.15, 0.4
"""Share of the field in which two channels may be at the sensor's end, and one."""


def field_pixels(field: FieldSettings, camera: CameraModel, size_px: tuple[int, int]) -> Floats:
    """Pixels spread over the field as far as the picture shows it, shape (n, 2); size_px: width and height."""
    half_x, half_y = accepted_half_extent(field)
    x, y = np.meshgrid(np.linspace(-half_x, half_x, POINTS), np.linspace(-half_y, half_y, POINTS))
    pixel = camera.pixel_from_field(np.column_stack([x.ravel(), y.ravel()]))
    with np.errstate(invalid="ignore"):
        inside = ((pixel >= 0.0) & (pixel <= np.array(size_px) - 1.0)).all(axis=1)
    return pixel[inside]


def exposure_reasons(pixels: Bytes, points_px: Floats) -> tuple[str, ...]:
    """What is wrong with a picture's light, in words.

    pixels: shape (height, width, 3), blue green red; points_px: of the field, see ``field_pixels``.
    """
    if not len(points_px):
        return ("the picture shows nothing of the field: camera position or field measures are wrong",)
    x, y = points_px.round().astype(np.intp).T
    seen = pixels[y, x].astype(np.float64)
    brightest = float(np.percentile(seen.max(axis=1), 99.8))
    if brightest < BLACK:
        return (
            f"the picture is black: nothing on the field is brighter than {brightest:.0f} of 255 (lens cap, lamps?)",
        )
    if seen.std(axis=0).max() < ALIKE:
        return ("the picture shows nothing: every pixel of the field has the same color",)
    if brightest < DARK:
        return (f"too dark: nothing on the field is brighter than {brightest:.0f} of 255 (lamps, exposure?)",)
    _, two, one = (np.sort(seen, axis=1) >= WHITE).mean(axis=0).tolist()
    if two > MOST_WHITE or one > MOST_AT_END:
        return (f"over-exposed: {one:.0%} of the field is as bright as the sensor can tell (exposure, gain?)",)
    return ()
