"""Are the painted lines where the field's measures and the camera say? Brightness across every line tells."""

import numpy as np

from vision_core.camera_model import CameraModel
from vision_core.field_model import painted_points
from vision_core.geometry import Bytes, Floats
from vision_core.settings import FieldSettings

PER_LINE = 60
ASIDE = 2.0
"""The carpet beside a line is looked at so many line widths from its middle, but at least `LEAST_ASIDE_PX`."""
LEAST_ASIDE_PX = 4.0
SHIFTS_PX = np.arange(-3.0, 3.5)
"""A line may lie so far from its place: calibrations are not perfect."""
CONTRAST = 10.0
"""Grey levels by which paint differs from carpet."""
LEAST_POINTS = 15
THINNEST_PX = 1.0
ALONG = 0.5
"""Share of its length on which a line must be found."""
FOUND = 0.3
"""Share of the lines that must be found: not every field has all of its preset's."""
OUTSIDE = 0.5


def line_reasons(pixels: Bytes, field: FieldSettings, camera: CameraModel) -> tuple[str, ...]:
    """Why the painted lines of the field do not match an image, in words; nothing where none is painted.

    pixels: shape (height, width, 3). Lines thinner than a pixel cannot be judged.
    """
    lines = painted_points(field, PER_LINE)
    if not lines:
        return ()
    luma = pixels @ np.array([0.114, 0.587, 0.299])
    width_px = field.line_width_m * camera.pixels_per_metre((0.0, 0.0))
    placed = [camera.pixel_from_field(points) for points in lines]
    within = [_inside(line, luma.shape) for line in placed]
    outside = 1.0 - float(np.concatenate(within).mean())
    if outside > OUTSIDE:
        where = f"{outside:.0%} of the lines of field {field.name!r} lie outside of the picture"
        return (f"{where}: wrong field preset, or wrong camera position",)
    if width_px < THINNEST_PX:
        return ()
    judged = [_is_painted(luma, line, inside, width_px) for line, inside in zip(placed, within, strict=True)]
    known = [verdict for verdict in judged if verdict is not None]
    if not known or sum(known) >= FOUND * len(known):
        return ()
    where = f"only {sum(known)} of {len(known)} painted lines are where field {field.name!r} has them"
    return (f"{where}: wrong field preset, or wrong camera position (line_width_m = 0: none are painted)",)


def _inside(points: Floats, shape: tuple[int, ...]) -> np.ndarray:
    margin = LEAST_ASIDE_PX + SHIFTS_PX[-1]
    with np.errstate(invalid="ignore"):
        inside: np.ndarray = ((points >= margin) & (points <= np.array(shape[::-1]) - 1.0 - margin)).all(axis=1)
    return inside


def _is_painted(luma: Floats, line: Floats, inside: np.ndarray, width_px: float) -> bool | None:
    """Does a line differ from the carpet on both of its sides along most of its length? None: too little is seen."""
    along = np.gradient(line, axis=0)
    length = np.hypot(along[:, 0], along[:, 1])
    usable = inside & (length > 0.0)
    if usable.sum() < LEAST_POINTS:
        return None
    across = np.column_stack([-along[:, 1], along[:, 0]])[usable] / length[usable, None]
    middle = line[usable]
    aside = max(ASIDE * width_px, LEAST_ASIDE_PX)
    best = 0.0
    for shift in SHIFTS_PX:
        here, left, right = (_looked_up(luma, middle + across * (shift + offset)) for offset in (0.0, aside, -aside))
        painted = (here - left > CONTRAST) & (here - right > CONTRAST)
        best = max(best, float(painted.mean()))
    return best > ALONG


def _looked_up(luma: Floats, points: Floats) -> Floats:
    height, width = luma.shape
    x = np.clip(points[:, 0].round().astype(np.intp), 0, width - 1)
    y = np.clip(points[:, 1].round().astype(np.intp), 0, height - 1)
    found: Floats = luma[y, x]
    return found
