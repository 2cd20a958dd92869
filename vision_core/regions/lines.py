"""Are the painted lines where the field's measures and the camera put them? Judged by brightness profiles."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from vision_core.errors import SettingsError
from vision_core.geometry import Bytes, Floats, Mask
from vision_core.models.camera import CameraModel
from vision_core.models.field import painted_points
from vision_core.settings.schema import FieldSettings
from vision_core.types.colors import LUMA_BGR
from vision_core.types.overlay import PaintedLine
from vision_core.types.reasons import Reason
from vision_core.types.regions import LineCheck

POINTS_PER_LINE = 60
ASIDE_WIDTHS = 2.0
"""Distance from a line's middle at which the carpet beside it is looked at, in line widths; at least MIN_ASIDE_PX."""
MIN_ASIDE_PX = 4.0
SHIFTS_PX = np.arange(-3.0, 3.5)
"""Distances from its place at which a line is searched: calibrations are not perfect."""
MIN_CONTRAST = 10.0
"""Difference between paint and carpet [grey levels]."""
MIN_POINTS = 15
"""Points of a line that must lie in the picture to judge it."""
MIN_WIDTH_PX = 1.0
"""Lines that are thinner in the picture are not judged."""
MIN_PAINTED = 0.5
"""Share of its points at which a line must show paint to be found."""
MIN_FOUND = 0.3
"""Share of the lines that must be found: not every field has all lines of its preset."""
MAX_OUTSIDE = 0.5
"""Share of the lines' points that may lie outside of the picture."""
PROFILE_STEP_PX, PROFILE_EVERY = 0.5, 2
"""A line's profile is sampled in such steps across it, at one of so many of its points."""
SHOWN_POINTS = 16
"""Points by which a line is drawn."""
CORNERS = np.array([(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)])


@dataclass(frozen=True, slots=True)
class _MeasuredLine:
    """One line in the picture."""

    points: int
    """Points of the line that lie in the picture."""
    painted: float
    """Share of them that show paint, at the best of the shifts."""
    offset_px: float
    """Distance of the line from its place, by its profile."""

    @property
    def is_found(self) -> bool:
        """Does enough of it show paint?"""
        return self.painted > MIN_PAINTED


def line_check(
    pixels: Bytes, field: FieldSettings, camera: CameraModel, covered: Callable[[Floats], Mask] | None = None
) -> LineCheck:
    """How well the painted lines of the field match an image.

    pixels: shape (height, width, 3), blue green red; covered: says which points of the floor, shape (n, 2) [m], a robot
    covers, so that no paint is expected there. Lines thinner than a pixel are not judged. Raises SettingsError when the
    camera makes a line wider than the picture: then it does not belong to the field.
    """
    lines = painted_points(field, POINTS_PER_LINE)
    if not lines:
        return LineCheck(0, 0, None, None, 0.0)
    width_px = _width_px(pixels, field, camera)
    placed = [camera.pixel_from_field(points) for points in lines]
    within = [_inside(line, pixels.shape[:2]) for line in placed]
    outside = 1.0 - float(np.concatenate(within).mean())
    if width_px < MIN_WIDTH_PX:
        return LineCheck(0, 0, None, None, outside)
    if covered is not None:
        within = [inside & ~covered(points) for points, inside in zip(lines, within, strict=True)]
    measured = [_measure(pixels, line, inside, width_px) for line, inside in zip(placed, within, strict=True)]
    known = [line for line in measured if line is not None]
    found = [line for line in known if line.is_found]
    points = sum(line.points for line in known)
    return LineCheck(
        known=len(known),
        found=len(found),
        samples=sum(line.points * line.painted for line in known) / points if points else None,
        residual_px=float(np.median([abs(line.offset_px) for line in found])) if found else None,
        outside=outside,
    )


def judged_lines(pixels: Bytes, field: FieldSettings, camera: CameraModel) -> tuple[PaintedLine, ...]:
    """Every painted line of which a part is in the picture, with the verdict of ``line_check`` on it.

    Takes its arguments, and raises SettingsError as it does.
    """
    lines = painted_points(field, POINTS_PER_LINE)
    width_px = _width_px(pixels, field, camera) if lines else 0.0
    found = []
    for points in lines:
        line = camera.pixel_from_field(points)
        inside = _inside(line, pixels.shape[:2])
        if inside.any():
            found.append(_verdict(pixels, line, inside, width_px))
    return tuple(found)


def _verdict(pixels: Bytes, line: Floats, inside: Mask, width_px: float) -> PaintedLine:
    """A line that is at least partly in the picture, and whether its paint is where it should be."""
    kept = np.flatnonzero(inside)[np.linspace(0, inside.sum() - 1, SHOWN_POINTS).round().astype(np.intp)]
    points = tuple((x, y) for x, y in line[np.unique(kept)].round(1).tolist())
    if width_px < MIN_WIDTH_PX:
        return PaintedLine(points, False, None, f"{width_px:.2g} px wide", f"{MIN_WIDTH_PX:g} px or more to judge it")
    measured = _measure(pixels, line, inside, width_px)
    if measured is None:
        share, least = inside.mean(), MIN_POINTS / POINTS_PER_LINE
        return PaintedLine(points, False, None, f"{share:.0%} of it in the picture", f"{least:.0%} or more to judge it")
    if not measured.is_found:
        found, accepted = f"paint on {measured.painted:.0%} of its length", f"more than {MIN_PAINTED:.0%}"
        return PaintedLine(points, False, None, found, accepted)
    return PaintedLine(points, True, measured.offset_px)


def _width_px(pixels: Bytes, field: FieldSettings, camera: CameraModel) -> float:
    """Width of the painted lines in the picture's middle. Raises SettingsError when it is wider than the picture."""
    width_px = field.line_width_m * camera.pixels_per_metre((0.0, 0.0))
    if not width_px <= max(pixels.shape[:2]):
        raise SettingsError(
            "camera: width of the field's painted lines in the picture",
            found=f"{width_px:.3g} px",
            accepted=f"at most the picture's {max(pixels.shape[:2])} px: check camera position and calibration points",
        )
    return float(width_px)


def line_reasons(pixels: Bytes, field: FieldSettings, camera: CameraModel) -> tuple[Reason, ...]:
    """Why the painted lines of the field do not match an image; () where none is painted."""
    check = line_check(pixels, field, camera)
    if check.outside > MAX_OUTSIDE:
        where = f"{check.outside:.0%} of the lines of field {field.name!r} lie outside of the picture"
        advice = "Choose the field preset of this field, or correct the camera's position."
        return (Reason(f"{where}: the field preset or the camera position is wrong", advice, is_calibration=True),)
    if check.found >= MIN_FOUND * check.known:
        return ()
    where = f"only {check.found} of {check.known} painted lines are where field {field.name!r} has them"
    advice = "Choose the preset of this field, or calibrate the camera; without painted lines set line_width_m = 0."
    return (Reason(f"{where}: the field preset or the camera position is wrong", advice, is_calibration=True),)


def _inside(points: Floats, shape: tuple[int, ...]) -> Mask:
    """Which points lie in the picture, far enough from its edge to look beside them."""
    margin = MIN_ASIDE_PX + SHIFTS_PX[-1]
    with np.errstate(invalid="ignore"):
        inside: Mask = ((points >= margin) & (points <= np.array(shape[::-1]) - 1.0 - margin)).all(axis=1)
    return inside


def _measure(pixels: Bytes, line: Floats, inside: Mask, width_px: float) -> _MeasuredLine | None:
    """Where a line differs from the carpet on both of its sides; None: too little of it is in the picture."""
    along = np.gradient(line, axis=0)
    length = np.hypot(along[:, 0], along[:, 1])
    usable = inside & (length > 0.0)
    if usable.sum() < MIN_POINTS:
        return None
    across = np.column_stack([-along[:, 1], along[:, 0]])[usable] / length[usable, None]
    places = line[usable] + across * SHIFTS_PX[:, None, None]
    aside = across * max(ASIDE_WIDTHS * width_px, MIN_ASIDE_PX)
    here, left, right = _luma(pixels, np.stack([places, places + aside, places - aside]))
    painted = (here - left > MIN_CONTRAST) & (here - right > MIN_CONTRAST)
    shares = painted.mean(axis=1)
    best = int(shares.argmax())
    there = painted[best]
    offset_px = _offset_px(pixels, line[usable][there], across[there], width_px) if there.any() else 0.0
    return _MeasuredLine(int(usable.sum()), float(shares[best]), offset_px)


def _offset_px(pixels: Bytes, line: Floats, across: Floats, width_px: float) -> float:
    """Distance of a line from its place: the centroid of its mean profile above half of the profile's height.

    line, across: points and unit normals, shape (n, 2). Both edges count, so the line's width has no influence.
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
    luma: Floats = np.take(pixels.reshape(-1, 3), y * width + x, axis=0) @ LUMA_BGR
    return luma


def _luma_between(pixels: Bytes, points: Floats) -> Floats:
    """Brightness at points between pixels, bilinear, shape (..., 2) -> (...)."""
    corner = np.floor(points)
    x, y = np.moveaxis(points - corner, -1, 0)
    weights = np.stack([(1.0 - x) * (1.0 - y), x * (1.0 - y), (1.0 - x) * y, x * y])
    luma: Floats = (_luma(pixels, np.stack([corner + step for step in CORNERS])) * weights).sum(axis=0)
    return luma
