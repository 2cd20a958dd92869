"""4. blobs -> sightings: what one frame shows."""

from dataclasses import dataclass
from enum import StrEnum

from vision_core.clock import Instant
from vision_core.types.reasons import Reason


class Team(StrEnum):
    """The two teams, named by the color of their center dots."""

    BLUE = "blue"
    YELLOW = "yellow"


@dataclass(frozen=True, slots=True)
class RobotSighting:
    """A robot in one frame."""

    team: Team
    id: int | None
    """Marker id; None where it cannot be read, or another robot of the team has the same."""
    x_px: float
    y_px: float
    """The marker's center in the image."""
    x_m: float
    y_m: float
    heading_rad: float | None
    """None where the pattern has no direction, or it could not be determined."""
    confidence: float
    """0..1."""
    position_sd_m: float
    """Standard deviation of the position, per axis."""
    heading_sd_rad: float | None


@dataclass(frozen=True, slots=True)
class BallSighting:
    """A ball in one frame; x_m, y_m is its point on the floor."""

    x_px: float
    y_px: float
    x_m: float
    y_m: float
    confidence: float
    position_sd_m: float
    """Standard deviation of the position, per axis."""


@dataclass(frozen=True, slots=True)
class ObstacleSighting:
    """An object of robot size in one frame that is no known robot and no ball, as a circle on the floor."""

    x_px: float
    y_px: float
    x_m: float
    y_m: float
    radius_m: float
    confidence: float


@dataclass(frozen=True, slots=True)
class Obstacles:
    """The obstacles of one frame; searched less often than robots are."""

    camera: str
    frame_number: int
    grabbed: Instant
    obstacles: tuple[ObstacleSighting, ...]


@dataclass(frozen=True, slots=True)
class Diagnosis:
    """Why nothing or too little is found in one frame, in sentences; computed less often than robots are searched."""

    camera: str
    frame_number: int
    grabbed: Instant
    reasons: tuple[Reason, ...]


@dataclass(frozen=True, slots=True)
class Sightings:
    """Robots and balls of one frame. Balls: those between the lines first, then by confidence."""

    camera: str
    frame_number: int
    grabbed: Instant
    perceived: Instant
    """When perception had finished the frame."""
    robots: tuple[RobotSighting, ...]
    balls: tuple[BallSighting, ...]
    complete: bool
    """False when there were more blobs than there was room for: a part of the picture was not searched."""
