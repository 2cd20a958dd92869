"""6. world -> view: what one robot would see."""

from dataclasses import dataclass

from vision_core.clock import Instant
from vision_core.geometry import Bytes, Floats
from vision_core.types.objects import Team


@dataclass(frozen=True, slots=True)
class BallView:
    """The ball as seen from a robot's center, while any part of it is visible."""

    distance_m: float
    """From the robot's center to the ball's point on the floor."""
    direction_deg: float
    """Of its center, anticlockwise from the heading, 0 <= d < 360."""
    size_deg: float
    """The whole azimuth it spans."""
    partial: bool
    """Something nearer hides a part of it."""


@dataclass(frozen=True, slots=True)
class RobotView:
    """What a robot would see at one instant (PSLV paper, section 3.3)."""

    team: Team
    number: int
    """The number clients use; the match configuration maps it to a marker id."""
    at: Instant
    frame_number: int
    distances_m: Floats
    """Nearest edge of each ray from the robot's center, inf for nothing; shape (n,)."""
    kinds: Bytes
    """EdgeKind of each ray, shape (n,)."""
    ball: BallView | None
    """None: hidden, or not known."""
    overlap: bool
    """Another robot's outline holds our center."""


@dataclass(frozen=True, slots=True)
class ViewSnapshot:
    """A view as it goes over the wire: one byte per direction for pixels (255: nothing) and for the kind."""

    team: Team
    number: int
    px: bytes
    kinds: bytes
    ball_px: int
    """-1: hidden."""
    ball_direction_deg: int
    ball_size_deg: int
    partial: bool
    overlap: bool


@dataclass(frozen=True, slots=True)
class Views:
    frame_number: int
    at: Instant
    views: tuple[ViewSnapshot, ...]
