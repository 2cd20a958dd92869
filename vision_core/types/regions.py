"""The results of the slow tasks: the field as the picture shows it, compared with the venue's settings."""

from dataclasses import dataclass
from enum import StrEnum
from typing import Generic, TypeVar

from vision_core.clock import Instant
from vision_core.types.colors import Levels
from vision_core.types.objects import Team
from vision_core.types.reasons import Reason

T = TypeVar("T")


@dataclass(frozen=True, slots=True)
class Finding(Generic[T]):
    """The result of a stage for one frame. The stage itself does not know the camera."""

    camera: str
    frame_number: int
    grabbed: Instant
    found: T


@dataclass(frozen=True, slots=True)
class FieldBoundary:
    """Where the carpet ends, on rays from the field's center outward, anticlockwise in the field from its x axis."""

    points_px: tuple[tuple[float, float], ...]
    """Per ray the pixel; nan where the picture ends first or no boundary is found."""
    confidences: tuple[float, ...]
    """Per ray 0..1: 1 when every sample up to the point is carpet and none beyond; 0 without a point."""
    found: float
    """Share of the rays that have a point, among those whose wall or limit should be in the picture."""
    error_px: float | None
    """Median distance from the wall or limit of the settings, outward positive: a wrong scale. None: too few rays."""
    off_px: float | None
    """The largest absolute median of the field's four sides: also a shifted or turned camera."""


@dataclass(frozen=True, slots=True)
class LineCheck:
    """Whether painted lines are where the field's measures and the camera put them."""

    known: int
    """Lines of which enough is in the picture to judge them; 0 where they are too thin or none is painted."""
    found: int
    samples: float | None
    """Share of the known lines' points that show paint; None where no line is known."""
    residual_px: float | None
    """Median distance of the found lines from their places; None where none was found."""
    outside: float
    """Share of all lines' points that lie outside of the picture; 0 where none is painted."""
    reasons: tuple[Reason, ...] = ()
    """What is wrong with the calibration: which corner of the field is how far off."""


@dataclass(frozen=True, slots=True)
class ExposureCheck:
    """How well the field is lit [grey levels]; None where the picture shows no part of it."""

    brightest: float | None
    """Level that 99.8 % of the field stay below in their brightest channel."""
    median_luma: float | None
    white: float | None
    """Share of the field in which a channel is saturated."""
    reasons: tuple[Reason, ...]
    """What is wrong."""


@dataclass(frozen=True, slots=True)
class ColorDrift:
    """How the light differs from that in which the venue's colors were measured."""

    gain_bgr: Levels
    """Factors that convert a picture to the venue's light; 1 for each channel where it cannot be measured."""
    reason: str
    """Why it cannot be measured; empty when it can."""


@dataclass(frozen=True, slots=True)
class BodyContour:
    """What one robot covers in a picture."""

    team: Team
    id: int | None
    outline_m: tuple[tuple[float, float], ...]
    """The part of the floor that the camera cannot see for this robot, anticlockwise [m]."""
    outline_px: tuple[tuple[float, float], ...]
    """The same in the picture: the robot's silhouette [px]."""
    can_hide_ball: bool
    """A ball that touches the robot on the side away from the camera may not be seen."""


class BallVisibility(StrEnum):
    """Whether the ball is seen, and what follows where it is not."""

    SEEN = "seen"
    MAY_BE_HIDDEN = "may be hidden"
    """A robot covers the place where the ball should be."""
    OUT_OF_PICTURE = "out of the picture"
    """The ball should be where this camera does not look."""
    GONE = "gone"
    """Nothing covers the place where the ball should be: it was taken away, or is not recognized."""
    UNKNOWN = "unknown"
    """It was not seen since the service began."""


@dataclass(frozen=True, slots=True)
class BodyContours:
    """What the robots cover in a camera's picture, and what that says about the ball."""

    bodies: tuple[BodyContour, ...]
    ball: BallVisibility
    ball_m: tuple[float, float] | None
    """Where the ball should be: where it is tracked, or was tracked last [m]."""
    hiding: tuple[tuple[Team, int | None], ...]
    """The robots that cover some of that place."""
