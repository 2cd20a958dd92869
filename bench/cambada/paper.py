"""The tables of the CAMBADA paper; see the package for its title."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class TaskTiming:
    """One process: its timing (table 2), and the measured intervals between its activations (table 3)."""

    period_ms: float
    priority: int
    """SCHED_FIFO."""
    offset_ms: float
    max_ms: float
    """Longest interval between two activations."""
    min_ms: float
    """Shortest interval."""
    sd_ms: float
    """Standard deviation of the intervals."""


@dataclass(frozen=True, slots=True)
class ResponseTimes:
    """How long a loop takes for one frame (table 1)."""

    max_ms: float
    min_ms: float
    mean_ms: float
    sd_ms: float


RATE_HZ = 20.0
"""Of both cameras."""
TASKS = {
    "avoid_om": TaskTiming(50.0, 45, 0.0, 56.9, 43.0, 1.9),
    "avoid_fr": TaskTiming(50.0, 45, 0.0, 58.1, 41.9, 2.5),
    "ball_om": TaskTiming(50.0, 40, 0.0, 56.9, 43.1, 3.2),
    "ball_fr": TaskTiming(50.0, 35, 0.0, 75.9, 25.4, 8.9),
    "kgoal": TaskTiming(100.0, 30, 0.0, 506.6, 0.5, 27.4),
    "bgoal": TaskTiming(200.0, 25, 50.0, 547.9, 0.6, 39.1),
    "ygoal": TaskTiming(200.0, 25, 150.0, 654.6, 0.6, 42.0),
    "line": TaskTiming(400.0, 20, 0.0, 711.0, 38.8, 53.3),
    "bpost": TaskTiming(800.0, 15, 100.0, 1159.7, 541.1, 60.8),
    "ypost": TaskTiming(800.0, 15, 200.0, 1101.0, 485.6, 53.3),
}
"""In the order of table 3, with the paper's names in lower case."""
LOOPS = {
    "Frontvision": ResponseTimes(427.7, 9.9, 43.6, 30.6),
    "Omnivision": ResponseTimes(635.5, 10.8, 44.0, 30.4),
}
"""The two loops of the monolithic architecture, one for each camera."""
