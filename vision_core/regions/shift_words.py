"""What is wrong with a calibration, in words, by where the painted lines lie: what, in which direction, by how much.

Four corners that are displaced alike are one mistake of the camera (it is moved, turned, or its scale is wrong); one
corner alone is one named point; lines between right corners that bow are a lens that bends them; and lines that are
where another preset has them are those of another field.
"""

import math
from collections.abc import Iterator

import numpy as np

from vision_core.geometry import Bytes
from vision_core.models.camera_setup import CameraSetup
from vision_core.regions.line_fit import CORNER_NAMES, CORNERS, LineShifts, line_shifts
from vision_core.regions.lines import line_reasons
from vision_core.regions.other_fields import other_field_reason
from vision_core.settings.schema import FieldSettings
from vision_core.types.reasons import Reason

MAX_SHIFT_PX, MAX_SHIFT = 6.0, 0.022
"""Displacement that is still in order: in pixels, or as a share of the picture's height."""
WALL_M = 0.06
"""The same where walls stand on the lines: their tops are seen so far outside of their feet."""
MAX_BOW_PX, MAX_BOW = 4.0, 0.01
"""The same for the bow of lines, which no hand that clicks corners adds to."""
MIN_AGREEMENT = 0.5
"""Where a smaller share of the pieces of lines agrees, something else than the lines was found."""
MIN_GAIN = 1.2
"""A displacement must put so many times as many pieces of lines in place as there are without it: walls beside lines
look like lines, too."""
MAX_UNLIKE = 0.35
"""Corners are displaced alike when what they do beside a common motion is at most this share of the displacement."""
MIN_PART = 0.3
"""A part of a displacement is named when it is at least this share of the whole."""
AT_CORNER = 0.1
"""A named point so near to a corner, as a share of the field's half measures, is that corner."""
CALIBRATE = "Calibrate the camera anew: `pslv calibrate camera PICTURE --venue FILE`, or on the page."


def calibration_reasons(pixels: Bytes, field: FieldSettings, setup: CameraSetup) -> tuple[Reason, ...]:
    """Why the calibration seems to be wrong, by where the painted lines lie; () when they are in order.

    pixels: shape (height, width, 3), blue green red. Looks at the lines of every shipped field too when those of the
    own one are not seen: some 10 ms for each.
    """
    if reason := other_field_reason(pixels, field, setup.model):
        return (reason,)
    return displaced_reasons(pixels, field, setup, is_thorough=True) or line_reasons(pixels, field, setup.model)


def displaced_reasons(
    pixels: Bytes, field: FieldSettings, setup: CameraSetup, *, is_thorough: bool = False
) -> tuple[Reason, ...]:
    """How the field's corners are displaced and its lines bent; () where nothing is, or too few lines agree.

    is_thorough: take up to three times as long to find a field of another size.
    """
    shifts = line_shifts(pixels, field, setup.model, is_thorough=is_thorough)
    if shifts is None or shifts.agreement < MIN_AGREEMENT or shifts.agreeing < MIN_GAIN * shifts.in_place:
        return ()
    return tuple(_Words(shifts, setup, field, pixels.shape[0]).reasons())


class _Words:
    """Says what displacements mean."""

    def __init__(self, shifts: LineShifts, setup: CameraSetup, field: FieldSettings, height_px: int) -> None:
        self._shifts, self._setup = shifts, setup
        self._limit_px = max(MAX_SHIFT_PX, MAX_SHIFT * height_px)
        if field.walls and field.margin_m < WALL_M:
            self._limit_px = max(self._limit_px, WALL_M * setup.model.pixels_per_metre((0.0, 0.0)))
        self._bow_limit_px = max(MAX_BOW_PX, MAX_BOW * height_px)
        self._half_field = np.array([field.length_m, field.width_m]) / 2.0
        self._lengths = np.where(shifts.certain, np.hypot(*shifts.shifts_px.T), 0.0)

    def reasons(self) -> Iterator[Reason]:
        """The displacement, in one sentence, and the bow."""
        if self._lengths.max() > self._limit_px:
            yield self._common() or self._corner(int(self._lengths.argmax()))
        if abs(self._shifts.bow_px) > self._bow_limit_px:
            yield self._bow()

    def _corner(self, corner: int) -> Reason:
        """One corner that is off."""
        aside, below = (-self._shifts.shifts_px[corner]).tolist()  # where the calibration is, seen from the lines
        off_m = self._off_m(corner)
        metres_per_px = off_m / self._lengths[corner]
        parts = []
        for length, words in ((aside, ("to the right of", "to the left of")), (below, ("below", "above"))):
            if abs(length) >= MIN_PART * self._lengths[corner]:
                size = f"{abs(length):.0f} px ({_distance(abs(length) * metres_per_px)})"
                parts.append(f"{size} {words[0] if length > 0.0 else words[1]}")
        name = self._name(corner)
        others = int((self._lengths > self._limit_px).sum()) - 1
        more = f"; {others} other {'corner lies' if others == 1 else 'corners lie'} beside it too" if others else ""
        text = f"{name} lies {' and '.join(parts)} where the lines say{more}: robots there are {_distance(off_m)} off"
        if self._setup.settings.model == "pinhole":
            return _calibration(text)
        x, y = (self._shifts.corners_px + self._shifts.shifts_px)[corner].tolist()
        return _calibration(f"{text}; by the lines {name} is at ({x:.0f}, {y:.0f}) px")

    def _common(self) -> Reason | None:
        """A motion that all corners share: moved, turned, another scale; None when they do not share one."""
        if not self._shifts.certain.all():
            return None
        places = self._shifts.corners_px - self._shifts.corners_px.mean(axis=0)
        shifts = self._shifts.shifts_px
        shift = shifts.mean(axis=0)
        power = (places**2).sum()
        growth = float((places * shifts).sum() / power)
        turn = float((places[:, 0] * shifts[:, 1] - places[:, 1] * shifts[:, 0]).sum() / power)
        turned = np.column_stack([-places[:, 1], places[:, 0]])
        rest = shifts - shift - growth * places - turn * turned
        if np.hypot(*rest.T).max() > MAX_UNLIKE * self._lengths.max():
            return None
        reach = float(np.hypot(*places.T).max())
        least = max(MIN_PART * self._lengths.max(), self._limit_px / 2.0)
        parts = []
        if abs(growth) * reach >= least:
            parts.append(f"{abs(growth) / (1.0 + growth):.0%} {'too small' if growth > 0.0 else 'too large'}")
        if abs(turn) * reach >= least:
            parts.append(
                f"turned {'anticlockwise' if turn > 0.0 else 'clockwise'} by {math.degrees(abs(turn)):.1f} deg"
            )
        if math.hypot(*shift) >= least:
            parts.append(self._moved(*(-shift).tolist()))
        worst = int(self._lengths.argmax())
        text = f"the calibration puts the field {', '.join(parts)}, compared with its painted lines"
        off = f"at the {CORNER_NAMES[worst]} corner robots are placed {_distance(self._off_m(worst))} off"
        return _calibration(f"{text}: {off}{self._height(growth)}")

    def _moved(self, aside: float, below: float) -> str:
        """A shift of the whole field in the picture, from the lines to where the calibration is."""
        metres_per_px = 1.0 / self._setup.model.pixels_per_metre((0.0, 0.0))
        parts = [
            f"{abs(length):.0f} px ({_distance(abs(length) * metres_per_px)}) too far {ahead if length > 0.0 else back}"
            for length, ahead, back in ((aside, "right", "left"), (below, "down", "up"))
            if abs(length) >= MIN_PART * math.hypot(aside, below)
        ]
        return " and ".join(parts)

    def _height(self, growth: float) -> str:
        """At which height of the camera the scale would be right; empty where it is not the height that counts."""
        height_m = float(self._setup.model.position_m[2])
        if self._setup.settings.model != "pinhole" or abs(growth) < 0.01:
            return ""
        return f"; a camera {height_m / (1.0 + growth):.2f} m high, not {height_m:.2f} m, would see this size"

    def _bow(self) -> Reason:
        """Lines that a lens bends."""
        place = np.array([self._shifts.bow_at_m])
        model = self._setup.model
        px_per_m = model.pixels_per_metre(self._shifts.bow_at_m)
        size = f"{abs(self._shifts.bow_px):.0f} px ({_distance(abs(self._shifts.bow_px) / px_per_m)})"
        x, y = model.pixel_from_field(place)[0].tolist()
        if self._setup.settings.model == "pinhole":
            text = (
                f"the lens bends lines other than the venue's distortion says, by up to {size} at ({x:.0f}, {y:.0f}) px"
            )
            return _calibration(text)
        text = (
            f"the lens bends lines, which named points cannot describe: up to {size} between them, most at "
            f"({x:.0f}, {y:.0f}) px, and robots there are placed as far off"
        )
        return _calibration(
            text, "Make it a pinhole with distortion: `pslv calibrate camera PICTURE --venue FILE --save`."
        )

    def _off_m(self, corner: int) -> float:
        """How far off the calibration places what stands at a corner of the lines."""
        seen = self._setup.model.field_from_pixel(self._shifts.corners_px + self._shifts.shifts_px)
        return float(np.hypot(*(seen - CORNERS * self._half_field)[corner]))

    def _name(self, corner: int) -> str:
        """The venue's own name of the point at a corner, or the corner's."""
        named = self._setup.settings.homography
        if self._setup.settings.model == "homography" and named is not None:
            for point in named.points:
                away = np.abs(np.array(point.field_m) / self._half_field - CORNERS[corner])
                if away.max() <= AT_CORNER:
                    return repr(point.name)
        return f"corner {CORNER_NAMES[corner]}"


def _calibration(text: str, advice: str = CALIBRATE) -> Reason:
    return Reason(text, advice, is_calibration=True)


def _distance(metres: float) -> str:
    """A distance for people."""
    return f"{metres * 100.0:.0f} cm" if metres >= 0.01 else f"{metres * 1000.0:.0f} mm"
