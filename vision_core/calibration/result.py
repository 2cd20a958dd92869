"""What a calibration gives back: the camera, how sure it is, everything a page draws, and why it is not accepted."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeAlias

from vision_core.settings.schema import PinholeSettings
from vision_core.types.reasons import Reason

Progress: TypeAlias = Callable[[str, float], None]
"""Called with what is being done and the share that is done, 0..1. It may raise ``Cancelled``: nothing is kept then."""

Vector: TypeAlias = tuple[float, float, float, float]
"""x, y and the step x, y to where the paint is [px]."""

MAX_HEIGHT_DEVIATION = 0.04
"""Share of the height from which on it is not known."""


def no_progress(_what: str, _share: float) -> None:
    """For callers that show none."""


class Cancelled(Exception):
    """Raised by a caller's progress function to end a calibration."""


@dataclass(frozen=True, slots=True)
class LineResult:
    """One painted line of the field in the picture."""

    name: str
    points_px: tuple[tuple[float, float], ...]
    """Where the camera puts the line: a path to draw."""
    visible: float
    """Share of it that lies in the picture."""
    found: float
    """Share of the visible part that shows paint at its place."""
    rms_px: float | None
    """Of the paint's distances from the line's place; None where none was found."""
    beside_px: float | None
    """How far beside its place a line is seen that shows no paint there; None where none is near."""
    held_out_px: float | None
    """The same when the camera is fitted to all other lines; None where they do not suffice."""
    residuals: tuple[Vector, ...]


@dataclass(frozen=True, slots=True)
class PictureResult:
    """One of the pictures that were calibrated by."""

    name: str
    sections: int
    """Of lines that it shows."""
    shift_px: tuple[float, float] | None
    """How far to the right and down it shows the field from where the others do; None: it shows too few lines."""
    apart_px: float
    """Root mean square length of such distances all over its lines: a camera that turned moves no middle."""


@dataclass(frozen=True, slots=True)
class Calibration:
    """A camera that was calibrated, or an attempt."""

    camera: PinholeSettings
    size_px: tuple[int, int]
    """Width and height of the pictures."""
    measures_m: dict[str, float]
    """Measures of the field by their names in [field], where they were solved as well; otherwise empty."""
    reasons: tuple[Reason, ...]
    """Why it is refused; empty: it is accepted."""
    notes: tuple[str, ...]
    """What one should know although it is accepted."""
    lines: tuple[LineResult, ...]
    samples: int
    """Sections of lines that count."""
    rms_px: float
    """Of their distances from where the camera puts them."""
    floor_error_m: float
    """Two standard deviations of a floor point's place, where on the field that is largest."""
    height_deviation_m: float
    """Standard deviation of the camera's height, which lines on the floor hardly determine."""
    marker_error_m: float
    """Two standard deviations of a place at the height of the robots' markers, where it is largest."""
    condition: float
    """Condition number of the normal equations, in units of the priors."""
    coverage: float
    """Share of the field inside the hull of the sections that count."""

    pictures: tuple[PictureResult, ...] = ()
    """Empty where no camera was found."""

    @property
    def is_height_unknown(self) -> bool:
        """Do neither the lines nor a tape measure tell how high the camera is?"""
        return self.height_deviation_m > MAX_HEIGHT_DEVIATION * self.camera.position_m[2]

    @property
    def accepted(self) -> bool:
        """May it be used?"""
        return not self.reasons
