"""What stands on the field or is painted on it."""

from dataclasses import dataclass

from vision_core.types.edges import EdgeKind


@dataclass(frozen=True, slots=True)
class Segment:
    """A straight piece of the field's boundary [m]."""

    x1_m: float
    y1_m: float
    x2_m: float
    y2_m: float
    kind: EdgeKind
    solid: bool
    """A solid segment hides what is behind it; a virtual limit is an edge but hides nothing."""


@dataclass(frozen=True, slots=True)
class Arc:
    """A painted arc [m, rad], anticlockwise from start to end."""

    x_m: float
    y_m: float
    radius_m: float
    start_rad: float
    end_rad: float
