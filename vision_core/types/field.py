"""What stands or is painted on the field, and what an edge can be."""

from dataclasses import dataclass
from enum import IntEnum


class EdgeKind(IntEnum):
    """What a ray meets first. A robot's kind is ROBOT_BLUE or ROBOT_YELLOW + its number (0: not known)."""

    NOTHING = 0
    WALL = 1
    GOAL_BLUE = 2
    """The goal that blue defends."""
    GOAL_YELLOW = 3
    UNKNOWN = 4
    """A thing that is no known robot."""
    ROBOT_BLUE = 16
    ROBOT_YELLOW = 48


@dataclass(frozen=True, slots=True)
class Segment:
    """A straight piece of the field's boundary [m]."""

    x1_m: float
    y1_m: float
    x2_m: float
    y2_m: float
    kind: EdgeKind
    solid: bool
    """Solid things hide what is behind them; virtual limits are edges but hide nothing."""


@dataclass(frozen=True, slots=True)
class Arc:
    """A painted arc [m, rad], anticlockwise from start to end."""

    x_m: float
    y_m: float
    radius_m: float
    start_rad: float
    end_rad: float
