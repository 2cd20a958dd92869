"""5. Sightings -> World."""

from dataclasses import dataclass

from vision_core.clock import Instant
from vision_core.types.objects import Team


@dataclass(frozen=True, slots=True)
class RobotTrack:
    """A robot's state at the world's instant."""

    team: Team
    id: int | None
    """Marker id; None for a robot whose id could not be read."""
    x_m: float
    y_m: float
    heading_rad: float
    vx_m_s: float
    vy_m_s: float
    turn_rad_s: float
    position_sd_m: float
    """Standard deviation of the position, per axis [m]."""
    heading_sd_rad: float
    confidence: float
    """Of the last sighting, 0..1."""
    seen: Instant
    """Grab instant of the last sighting; if it is before the world's instant, the state is predicted."""


@dataclass(frozen=True, slots=True)
class BallTrack:
    """The ball's state at the world's instant; x_m, y_m is its point on the floor."""

    x_m: float
    y_m: float
    vx_m_s: float
    vy_m_s: float
    position_sd_m: float
    hidden: bool
    """The world's frame does not show it, so it is predicted."""
    seen: Instant


@dataclass(frozen=True, slots=True)
class ObstacleTrack:
    """An object of robot size that is no known robot, at the world's instant: a circle on the floor."""

    x_m: float
    y_m: float
    vx_m_s: float
    vy_m_s: float
    radius_m: float
    seen: Instant


@dataclass(frozen=True, slots=True)
class World:
    """The field at one instant. Robots are ordered by team and id. Nothing in it is older than its validity."""

    frame_number: int
    at: Instant
    robots: tuple[RobotTrack, ...]
    ball: BallTrack | None
    obstacles: tuple[ObstacleTrack, ...]
