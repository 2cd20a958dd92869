"""6. World -> view: what one robot would see."""

from dataclasses import dataclass

from vision_core.clock import Instant
from vision_core.geometry import Bytes, Floats
from vision_core.types.objects import Team


@dataclass(frozen=True, slots=True)
class BallView:
    """The ball as seen from a robot's center, if any part of it is visible."""

    distance_m: float
    """From the robot's center to the ball's point on the floor."""
    direction_deg: float
    """Direction of its center, anticlockwise from the heading, 0 <= d < 360."""
    size_deg: float
    """The full azimuth that it spans."""
    partial: bool
    """A nearer object hides a part of it."""


@dataclass(frozen=True, slots=True)
class RobotView:
    """What a robot would see at one instant (PSLV paper, section 3.3)."""

    team: Team
    number: int
    """The number clients use; the match configuration maps it to a marker id."""
    at: Instant
    frame_number: int
    distances_m: Floats
    """Distance of the nearest edge along each ray from the robot's center, inf for nothing; shape (n,)."""
    kinds: Bytes
    """EdgeKind of each ray, shape (n,)."""
    ball: BallView | None
    """None: hidden, or its position is unknown."""
    overlap: bool
    """Another outline contains the robot's center."""


@dataclass(frozen=True, slots=True)
class ViewSnapshot:
    """A view as the page gets it: distances in pixels of its team's mirror, one direction per whole degree."""

    team: Team
    number: int
    px: bytes
    """Distance of the nearest edge in each direction [px], 255: nothing."""
    kinds: bytes
    """Its EdgeKind."""
    ball_px: int
    """Distance of the ball [px], -1: hidden."""
    ball_direction_deg: int
    ball_size_deg: int
    partial: bool
    overlap: bool


@dataclass(frozen=True, slots=True)
class Views:
    """The views of all robots of one world, ordered by team and number."""

    frame_number: int
    at: Instant
    views: tuple[ViewSnapshot, ...]
