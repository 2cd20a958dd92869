"""How far the painted lines lie beside their places: a calibration that is a little wrong shows here.

Every line is cut into sections. Across each, the brightness profile says how far aside of its place the paint lies. One
displacement per corner of the field, bilinear in between, is then fitted to all sections; sections that found something
else (a robot, a wall) lose their weight. So one named point that is 15 px off shows as one corner that is.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from vision_core.geometry import Bytes, Floats
from vision_core.models.camera import CameraModel
from vision_core.models.field import painted_points
from vision_core.settings.schema import FieldSettings
from vision_core.types.reasons import Reason

POINTS_PER_LINE, POINTS_PER_SECTION = 60, 15
MIN_POINTS = 12
"""Points of a section that must lie in the picture."""
REACH_PX = 25
"""Distance from its place at which paint is searched."""
MIN_ASIDE_PX = 3
"""Carpet is looked at this far beside the paint, or a line's width if that is more."""
MIN_CONTRAST = 10.0
"""Difference between paint and carpet on both of its sides [grey levels]."""
MAX_SECOND = 0.5
"""A second line in reach with more than this share of the contrast makes a section ambiguous."""
MIN_SECTIONS = 12
NOISE_PX, PRIOR_PX = 2.0, 15.0
"""Standard deviations of a section's offset and of a corner's displacement before anything was measured."""
STEPS = 15
"""Reweighted least squares has settled by then."""
MIN_CERTAINTY = 3.0
"""A corner's displacement counts if it is this many times its standard deviation."""
MAX_SHIFT_PX, MAX_SHIFT = 6.0, 0.018
"""Displacement of a corner that is still in order: in pixels, or as a share of the picture's height."""
CORNER_NAMES = ("left top", "right top", "right bottom", "left bottom")


@dataclass(frozen=True, slots=True)
class _Section:
    """A piece of a line whose paint was found."""

    weights: Floats
    """Share of each corner's displacement here, shape (4,)."""
    normal: Floats
    """Unit vector across the line in the picture, shape (2,)."""
    offset_px: float
    """Distance of the paint from its place, along the normal."""


def corner_shifts(pixels: Bytes, field: FieldSettings, camera: CameraModel) -> dict[str, float]:
    """Displacement of the painted lines at the corners of the field [px]: by the corner's name.

    pixels: shape (height, width, 3), blue green red. Corners about which the lines say too little are left out.
    """
    sections = list(_sections(pixels, field, camera))
    if len(sections) < MIN_SECTIONS:
        return {}
    weights, normals = np.array([s.weights for s in sections]), np.array([s.normal for s in sections])
    design = np.hstack([weights * normals[:, :1], weights * normals[:, 1:]])
    offsets = np.array([s.offset_px for s in sections])
    prior = np.eye(8) * (NOISE_PX / PRIOR_PX) ** 2
    trust = np.ones(len(sections))
    for _ in range(STEPS):
        information = design.T @ (design * trust[:, None]) + prior
        shift = np.linalg.solve(information, design.T @ (offsets * trust))
        rest = np.abs(offsets - design @ shift)
        trust = np.where(rest < NOISE_PX, 1.0, (NOISE_PX / np.maximum(rest, NOISE_PX)) ** 2)
    deviations = NOISE_PX * np.sqrt(np.diag(np.linalg.inv(information)))
    found = {}
    for corner, name in enumerate(CORNER_NAMES):
        shift_px = math.hypot(shift[corner], shift[corner + 4])
        if shift_px < NOISE_PX or shift_px > MIN_CERTAINTY * math.hypot(deviations[corner], deviations[corner + 4]):
            found[name] = shift_px
    return found


def shift_reasons(pixels: Bytes, field: FieldSettings, camera: CameraModel) -> tuple[Reason, ...]:
    """Why the calibration seems to be wrong, by where the lines lie; () when they are in order."""
    shifts = corner_shifts(pixels, field, camera)
    if not shifts:
        return ()
    name = max(shifts, key=lambda corner: shifts[corner])
    if shifts[name] <= max(MAX_SHIFT_PX, MAX_SHIFT * pixels.shape[0]):
        return ()
    where = f"the painted lines lie up to {shifts[name]:.0f} px beside their places, most at the field's {name} corner"
    text = f"{where}: a named point, the camera's pose or the field's measures are wrong"
    return (Reason(text, "Calibrate the camera anew, beginning with the point at this corner."),)


def _sections(pixels: Bytes, field: FieldSettings, camera: CameraModel) -> Iterator[_Section]:
    if not field.line_width_m:
        return
    line_width_px = field.line_width_m * camera.pixels_per_metre((0.0, 0.0))
    if not line_width_px <= REACH_PX:
        return
    size = np.array(pixels.shape[1::-1])
    half_field = np.array([field.length_m, field.width_m]) / 2.0
    for line in painted_points(field, POINTS_PER_LINE):
        places = camera.pixel_from_field(line)
        along = np.gradient(places, axis=0)
        with np.errstate(invalid="ignore", divide="ignore"):
            normals = np.column_stack([-along[:, 1], along[:, 0]]) / np.hypot(along[:, 0], along[:, 1])[:, None]
            usable = np.asarray(((places >= 0.0) & (places <= size - 1.0) & np.isfinite(normals)).all(axis=1))
        for start in range(0, len(line), POINTS_PER_SECTION):
            chosen = np.flatnonzero(usable[start : start + POINTS_PER_SECTION]) + start
            if len(chosen) < MIN_POINTS:
                continue
            offset_px = _paint_offset(pixels, places[chosen], normals[chosen], line_width_px)
            if offset_px is not None:
                right, up = (line[chosen].mean(axis=0) / half_field + 1.0) / 2.0
                weights = np.array([(1.0 - right) * up, right * up, right * (1.0 - up), (1.0 - right) * (1.0 - up)])
                yield _Section(weights, normals[chosen].mean(axis=0), offset_px)


def _paint_offset(pixels: Bytes, places: Floats, normals: Floats, line_width_px: float) -> float | None:
    """Distance of the paint nearest to a line's place; None where there is none, or two lines.

    places, normals: points of a section and unit vectors across it, shape (n, 2).
    """
    offsets = np.arange(-REACH_PX, REACH_PX + 1.0)
    height, width = pixels.shape[:2]
    x, y = np.moveaxis((places + normals * offsets[:, None, None]).round().astype(np.intp), -1, 0)
    brightness = pixels[np.clip(y, 0, height - 1), np.clip(x, 0, width - 1)].mean(axis=-1)
    profile = np.median(brightness, axis=1)
    half_width = max(1, round(line_width_px / 2.0))
    box = np.full(2 * half_width - 1, 1.0 / (2 * half_width - 1))
    smooth = np.convolve(np.pad(profile, half_width - 1, mode="edge"), box, mode="valid")
    aside = max(math.ceil(line_width_px), MIN_ASIDE_PX)
    if 2 * aside >= len(offsets):
        return None
    contrast = smooth[aside:-aside] - np.maximum(smooth[: -2 * aside], smooth[2 * aside :])
    best = int(contrast.argmax())
    others = contrast[np.abs(np.arange(len(contrast)) - best) > aside + half_width]
    if contrast[best] < MIN_CONTRAST or others.max(initial=0.0) > MAX_SECOND * contrast[best]:
        return None
    return float(offsets[best + aside])
