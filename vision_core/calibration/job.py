"""A calibration as a job for a process of its own: what goes in, and what comes out line by line."""

from base64 import b64decode, b64encode
from dataclasses import dataclass

import msgspec

from vision_core.calibration.result import Calibration
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


@dataclass(frozen=True, slots=True)
class CalibrationStep:
    """One line of the job's output."""

    what: str
    share: float
    """0..1 of the work is done."""
    result: Calibration | None = None
    """With the last line, when it is not refused by error."""
    error: str = ""
    """With the last line, when the input cannot be used at all."""

    def encode(self) -> bytes:
        """One line. Not JSON: what could not be measured is not a number."""
        return b64encode(msgspec.msgpack.encode(self)) + b"\n"

    @staticmethod
    def decode(line: bytes) -> "CalibrationStep":
        """From a line. Raises ValueError."""
        return msgspec.msgpack.decode(b64decode(line, validate=False), type=CalibrationStep)
