"""What the slow trackers find: the field as the picture shows it, beside what the venue says of it."""

from dataclasses import dataclass
from typing import Generic, TypeVar

from vision_core.clock import Instant
from vision_core.types.colors import Levels

T = TypeVar("T")


@dataclass(frozen=True, slots=True)
class Finding(Generic[T]):
    """What was found in one frame: the record round what a stage returns, which knows no camera."""

    camera: str
    frame_number: int
    grabbed: Instant
    found: T


@dataclass(frozen=True, slots=True)
class FieldBoundary:
    """Where the carpet ends, on rays from the field's center outward, anticlockwise in the field from its x axis."""

    points_px: tuple[tuple[float, float], ...]
    """Per ray the pixel; nan where the picture ends first, or no end is seen."""
    confidences: tuple[float, ...]
    """Per ray 0..1: all is carpet up to there, and nothing beyond; 0 where there is no point."""
    found: float
    """Share of the rays with a point, of those whose wall or limit should be in the picture."""
    error_px: float | None
    """Median distance from the wall or limit as the venue has it, outward positive: its scale. None: too few rays."""
    off_px: float | None
    """The largest of the medians of the field's four sides, without its sign: a shifted or turned camera, too."""


@dataclass(frozen=True, slots=True)
class LineCheck:
    """Whether painted lines are where the field's measures and the camera say."""

    known: int
    """Lines of which enough is in the picture to judge them; 0 where they are too thin, or none are painted."""
    found: int
    samples: float | None
    """Share of the known lines' points at which there is paint; None where none is known."""
    residual_px: float | None
    """Median over the lines found of how far aside of its place each lies; None where none was found."""
    outside: float
    """Share of all lines' points that lie outside of the picture; 0 where none are painted."""


@dataclass(frozen=True, slots=True)
class ExposureCheck:
    """How light the field is [grey levels]; None where the picture shows nothing of it."""

    brightest: float | None
    """What all but 0.2 % of the field stay below, in their brightest channel."""
    median_luma: float | None
    white: float | None
    """Share of the field in which a channel is at the sensor's end."""
    reasons: tuple[str, ...]
    """What is wrong, in words."""


@dataclass(frozen=True, slots=True)
class ColorDrift:
    """How the light differs from the one that the colors were tuned in."""

    gain_bgr: Levels
    """What makes a picture look as in the venue's light; 1 for each channel where it cannot be judged."""
    reason: str
    """Why it cannot be judged; empty when it can."""
