"""Are the painted lines where the field's measures and the camera say? Brightness across every line tells."""

from dataclasses import dataclass

import numpy as np

from vision_core.geometry import Bytes, Floats
from vision_core.models.camera import CameraModel
from vision_core.models.field import painted_points
from vision_core.settings.schema import FieldSettings
from vision_core.types.regions import LineCheck

PER_LINE = 60
ASIDE = 2.0
"""The carpet beside a line is looked at so many line widths from its middle, but at least `MIN_ASIDE_PX`."""
MIN_ASIDE_PX = 4.0
SHIFTS_PX = np.arange(-3.0, 3.5)
"""A line may lie so far from its place: calibrations are not perfect."""
CONTRAST = 10.0
"""Grey levels by which paint differs from carpet."""
MIN_POINTS = 15
THINNEST_PX = 1.0
ALONG = 0.5
"""Share of its length on which a line must be found."""
FOUND = 0.3
"""Share of the lines that must be found: not every field has all of its preset's."""
OUTSIDE = 0.5
PROFILE_STEP_PX, PROFILE_EVERY = 0.5, 2
"""A line's profile is taken in such steps across it, at every so many-th of its points."""
CORNERS = np.array([(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)])
LUMA = np.array([0.114, 0.587, 0.299])


@dataclass(frozen=True, slots=True)
class _Line:
    """What is seen of one line."""

    points: int
    """That lie in the picture."""
    painted: float
    """Share of them at which there is paint, with all of the line shifted alike."""
    aside_px: float
    """How far aside of its place the line lies, by its profile."""


def line_check(pixels: Bytes, field: FieldSettings, camera: CameraModel) -> LineCheck:
    """How well the painted lines of the field match an image.

    pixels: shape (height, width, 3), blue green red. Lines thinner than a pixel are not known.
    """
    lines = painted_points(field, PER_LINE)
    if not lines:
        return LineCheck(0, 0, None, None, 0.0)
    width_px = field.line_width_m * camera.pixels_per_metre((0.0, 0.0))
    placed = [camera.pixel_from_field(points) for points in lines]
    within = [_inside(line, pixels.shape[:2]) for line in placed]
    outside = 1.0 - float(np.concatenate(within).mean())
    if width_px < THINNEST_PX:
        return LineCheck(0, 0, None, None, outside)
    looked = [_looked_at(pixels, line, inside, width_px) for line, inside in zip(placed, within, strict=True)]
    known = [line for line in looked if line is not None]
    found = [line for line in known if line.painted > ALONG]
    points = sum(line.points for line in known)
    return LineCheck(
        known=len(known),
        found=len(found),
        samples=sum(line.points * line.painted for line in known) / points if points else None,
        residual_px=float(np.median([abs(line.aside_px) for line in found])) if found else None,
        outside=outside,
    )


def line_reasons(pixels: Bytes, field: FieldSettings, camera: CameraModel) -> tuple[str, ...]:
    """Why the painted lines of the field do not match an image, in words; nothing where none is painted."""
    check = line_check(pixels, field, camera)
    if check.outside > OUTSIDE:
        where = f"{check.outside:.0%} of the lines of field {field.name!r} lie outside of the picture"
        return (f"{where}: wrong field preset, or wrong camera position",)
    if check.found >= FOUND * check.known:
        return ()
    where = f"only {check.found} of {check.known} painted lines are where field {field.name!r} has them"
    return (f"{where}: wrong field preset, or wrong camera position (line_width_m = 0: none are painted)",)


def _inside(points: Floats, shape: tuple[int, ...]) -> np.ndarray:
    margin = MIN_ASIDE_PX + SHIFTS_PX[-1]
    with np.errstate(invalid="ignore"):
        inside: np.ndarray = ((points >= margin) & (points <= np.array(shape[::-1]) - 1.0 - margin)).all(axis=1)
    return inside


def _looked_at(pixels: Bytes, line: Floats, inside: np.ndarray, width_px: float) -> _Line | None:
    """Does a line differ from the carpet on both of its sides, and where? None: too little is seen."""
    along = np.gradient(line, axis=0)
    length = np.hypot(along[:, 0], along[:, 1])
    usable = inside & (length > 0.0)
    if usable.sum() < MIN_POINTS:
        return None
    across = np.column_stack([-along[:, 1], along[:, 0]])[usable] / length[usable, None]
    places = line[usable] + across * SHIFTS_PX[:, None, None]
    aside = across * max(ASIDE * width_px, MIN_ASIDE_PX)
    here, left, right = _luma(pixels, np.stack([places, places + aside, places - aside]))
    painted = (here - left > CONTRAST) & (here - right > CONTRAST)
    shares = painted.mean(axis=1)
    best = int(shares.argmax())
    there = painted[best]
    aside_px = _aside_px(pixels, line[usable][there], across[there], width_px) if there.any() else 0.0
    return _Line(int(usable.sum()), float(shares[best]), aside_px)


def _aside_px(pixels: Bytes, line: Floats, across: Floats, width_px: float) -> float:
    """How far aside of its place a line lies: the middle of what its mean profile has over half of its height.

    line, across: points and unit normals, shape (n, 2). Both edges count, so a line's width does not matter.
    """
    steps = np.ceil((width_px / 2.0 + SHIFTS_PX[-1]) / PROFILE_STEP_PX)
    offsets = np.arange(-steps, steps + 1.0) * PROFILE_STEP_PX
    some, aside = line[::PROFILE_EVERY], across[::PROFILE_EVERY] * offsets[:, None, None]
    profile = _luma_between(pixels, some + aside).mean(axis=1)
    over = np.clip(profile - (profile.max() + profile.min()) / 2.0, 0.0, None)
    return float((over * offsets).sum() / max(over.sum(), 1e-9))


def _luma(pixels: Bytes, points: Floats) -> Floats:
    """Brightness at the pixels nearest to points, shape (..., 2) -> (...)."""
    height, width = pixels.shape[:2]
    x, y = np.moveaxis(points.round().astype(np.intp), -1, 0)
    x, y = np.minimum(np.maximum(x, 0), width - 1), np.minimum(np.maximum(y, 0), height - 1)
    luma: Floats = np.take(pixels.reshape(-1, 3), y * width + x, axis=0) @ LUMA
    return luma


def _luma_between(pixels: Bytes, points: Floats) -> Floats:
    """Brightness at points between pixels, shape (..., 2) -> (...)."""
    corner = np.floor(points)
    x, y = np.moveaxis(points - corner, -1, 0)
    weights = np.stack([(1.0 - x) * (1.0 - y), x * (1.0 - y), (1.0 - x) * y, x * y])
    luma: Floats = (_luma(pixels, np.stack([corner + step for step in CORNERS])) * weights).sum(axis=0)
    return luma
