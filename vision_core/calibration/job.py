"""A calibration as a job for a process of its own: what goes in."""

from dataclasses import dataclass

from vision_core.settings.schema import Settings


@dataclass(frozen=True, slots=True)
class CalibrationJob:
    """What to calibrate; the picture's pixels follow on standard input."""

    settings: Settings
    size_px: tuple[int, int]
    """Width and height of the picture."""
    corners_px: tuple[tuple[float, float], ...] | None
    """Outer corners of the field's lines: left top, right top, right bottom, left bottom. None: not given."""
    finds: bool
    """Search the field in the picture. Otherwise, without corners, the camera of the settings is the first guess."""
    height_m: float | None
    """Of the camera, by tape measure."""
    swaps_ends: bool
    """The field's left end is the other one."""
