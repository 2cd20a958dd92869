"""The paper's tables."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Line:
    """A process: when it is activated (table 2), and how regularly it was (table 3)."""

    period_ms: float
    priority: int
    """SCHED_FIFO."""
    offset_ms: float
    max_ms: float
    """Longest interval between two activations, as the next two."""
    min_ms: float
    sd_ms: float


@dataclass(frozen=True, slots=True)
class Response:
    """How long a loop takes for a frame (table 1)."""

    max_ms: float
    min_ms: float
    mean_ms: float
    sd_ms: float


RATE_HZ = 20.0
"""Of both cameras."""
TASKS = {
    "avoid_om": Line(50.0, 45, 0.0, 56.9, 43.0, 1.9),
    "avoid_fr": Line(50.0, 45, 0.0, 58.1, 41.9, 2.5),
    "ball_om": Line(50.0, 40, 0.0, 56.9, 43.1, 3.2),
    "ball_fr": Line(50.0, 35, 0.0, 75.9, 25.4, 8.9),
    "kgoal": Line(100.0, 30, 0.0, 506.6, 0.5, 27.4),
    "bgoal": Line(200.0, 25, 50.0, 547.9, 0.6, 39.1),
    "ygoal": Line(200.0, 25, 150.0, 654.6, 0.6, 42.0),
    "line": Line(400.0, 20, 0.0, 711.0, 38.8, 53.3),
    "bpost": Line(800.0, 15, 100.0, 1159.7, 541.1, 60.8),
    "ypost": Line(800.0, 15, 200.0, 1101.0, 485.6, 53.3),
}
"""In the order of table 3; their names in small letters, as the service has them."""
LOOPS = {
    "Frontvision": Response(427.7, 9.9, 43.6, 30.6),
    "Omnivision": Response(635.5, 10.8, 44.0, 30.4),
}
"""The two loops of the monolithic architecture, one for each camera."""
