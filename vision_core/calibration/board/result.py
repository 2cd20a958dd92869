"""What pictures of a board give: the lens, how sure it is, everything a page draws, and why it is not accepted."""

from dataclasses import dataclass

from vision_core.calibration.result import Vector
from vision_core.settings.schema import LensSettings
from vision_core.types.reasons import Reason


@dataclass(frozen=True, slots=True)
class BoardPicture:
    """One picture of a board."""

    name: str
    paper: str
    """Of the board that was seen: A4 or A3; empty: none was."""
    unseen: str
    """Why it does not count; empty: it does."""
    corners: tuple[Vector, ...]
    """Where corners were seen, and how far from there the lens puts them [px]."""
    rms_px: float | None
    """Of these distances; None: it does not count."""
    held_out_px: float | None
    """The same by the lens of all other pictures; None where they do not suffice."""
    tilt_deg: float | None
    """Angle between the board and the picture."""


@dataclass(frozen=True, slots=True)
class LensCalibration:
    """A lens that was calibrated with a board, or an attempt."""

    lens: LensSettings | None
    """None: too few boards were seen to say anything."""
    size_px: tuple[int, int]
    """Width and height of the pictures."""
    reasons: tuple[Reason, ...]
    """Why it is refused; empty: it is accepted."""
    notes: tuple[str, ...]
    """What one should know although it is accepted."""
    pictures: tuple[BoardPicture, ...]
    corners: int
    """That count, of all pictures."""
    rms_px: float
    """Of the corners' distances from where the lens puts them."""
    bend_error_px: float
    """Two standard deviations of a place in the picture, where it is largest, when the pose is fitted to the lens."""
    coverage: float
    """Share of the picture in which a board was seen at least once."""
    regions: dict[str, float]
    """The same for each ninth of the picture."""
    condition: float
    """Condition number of the lens' information, its parameters in units of the usual deviations."""

    @property
    def accepted(self) -> bool:
        """May it be used?"""
        return not self.reasons
