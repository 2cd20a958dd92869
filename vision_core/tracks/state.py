"""What the tracker remembers, and by which rules it goes: one structured array each, of one row.

Both are what the kernels of this stage take, so that a larger kernel can hold the stage whole.
"""

import math
from typing import Any, TypeAlias

import numpy as np

from vision_core.clock import NS_PER_MS
from vision_core.models.from_settings import robots_of
from vision_core.settings.schema import RobotSettings, TrackSettings
from vision_core.tracks.filters import density_from_acceleration, start_variance
from vision_core.types.tables import MAX_BALLS, MAX_OBSTACLES, MAX_ROBOTS, TEAMS, Table

Row: TypeAlias = Any
"""One row of a table, as kernels take it: its fields are attributes."""
GATE_SIGMAS = 3.0
UNKNOWN_HEADING_VARIANCE = math.pi**2 / 3.0
"""Of an angle that may be any."""
NEVER = -1
"""Instant of a frame that has not come."""

PLACE = [
    ("x_m", np.float64), ("y_m", np.float64), ("vx_m_s", np.float64), ("vy_m_s", np.float64),
    ("variance", np.float64), ("covariance", np.float64), ("rate_variance", np.float64),
]  # fmt: skip
"""A place on the floor as of its last sighting, and the covariances that x and y share."""

ROBOT_LIFE = np.dtype(
    [
        ("team", np.int32), ("id", np.int32), *PLACE,
        ("heading_rad", np.float64), ("turn_rad_s", np.float64), ("headed", np.int64),
        ("heading_variance", np.float64), ("heading_covariance", np.float64), ("turn_variance", np.float64),
        ("confidence", np.float64), ("seen", np.int64), ("sightings", np.int64),
        ("claim", np.int32), ("claims", np.int32),
        ("ahead_x_m", np.float64), ("ahead_y_m", np.float64),
        ("ahead_variance", np.float64), ("ahead_covariance", np.float64), ("ahead_rate_variance", np.float64),
        ("paired", np.int64), ("read", np.int64), ("gone", np.int64),
        ("nearest", np.int64), ("distance_m2", np.float64),
    ]
)  # fmt: skip
"""A robot. headed: its heading was seen at least once. claim: a foreign id that was read here, claims: how often in
a row. The rest serves one frame: predicted to its instant; paired with a sighting; read under its own id; gone with
its id to another track; the nearest free sighting and its squared distance."""

BALL_LIFE = np.dtype([*PLACE, ("seen", np.int64)])

OBSTACLE_LIFE = np.dtype([*PLACE, ("radius_m", np.float64), ("seen", np.int64), ("sightings", np.int64)])

STATE = np.dtype(
    [
        ("frames", np.int64), ("refused", np.int64), ("frame_number", np.int64), ("grabbed", np.int64),
        ("obstacles_at", np.int64), ("counts", np.int64, (3,)),
        ("robots", ROBOT_LIFE, (2 * MAX_ROBOTS,)),
        ("taken", np.int64, (MAX_ROBOTS,)), ("pairs", np.int64, (MAX_ROBOTS, 2)), ("order", np.int64, (MAX_ROBOTS,)),
        ("balls", BALL_LIFE, (1 + MAX_BALLS,)),
        ("obstacles", OBSTACLE_LIFE, (MAX_OBSTACLES,)), ("fresh", OBSTACLE_LIFE, (MAX_OBSTACLES,)),
    ]
)  # fmt: skip
"""counts: robots, balls, obstacles. robots: old tracks and, for the length of a frame, as many new ones.
balls: the ball, then the places where it may have jumped to."""

RULES = np.dtype(
    [
        ("validity_ns", np.int64), ("ball_validity_ns", np.int64), ("obstacle_validity_ns", np.int64),
        ("gate_m", np.float64),
        ("robot_noise", np.float64), ("heading_noise", np.float64), ("ball_noise", np.float64),
        ("robot_density", np.float64), ("turn_density", np.float64), ("ball_density", np.float64),
        ("robot_start", np.float64), ("turn_start", np.float64), ("ball_start", np.float64),
        ("radius_m", np.float64, (len(TEAMS),)), ("square", np.int64, (len(TEAMS),)),
    ]
)  # fmt: skip
"""Settings as the kernels want them. noise: variance that calibration adds to a sighting's own; density: of the
acceleration noise; start: variance of a new track's rate; radius_m and square: outline of each team's robots."""


def rules_from(settings: TrackSettings, robots: RobotSettings) -> Table:
    """The rules that the settings describe, shape (1,)."""
    rules = np.zeros(1, dtype=RULES)
    values = {
        "validity_ns": round(settings.validity_ms * NS_PER_MS),
        "ball_validity_ns": round(settings.ball_validity_ms * NS_PER_MS),
        "obstacle_validity_ns": round(settings.obstacle_validity_ms * NS_PER_MS),
        "gate_m": settings.gate_m,
        "robot_noise": settings.robot_noise_m**2,
        "heading_noise": settings.heading_noise_rad**2,
        "ball_noise": settings.ball_noise_m**2,
        "robot_density": density_from_acceleration(settings.robot_acceleration_m_s2),
        "turn_density": density_from_acceleration(settings.robot_turn_acceleration_rad_s2),
        "ball_density": density_from_acceleration(settings.ball_acceleration_m_s2),
        "robot_start": start_variance(settings.robot_acceleration_m_s2),
        "turn_start": start_variance(settings.robot_turn_acceleration_rad_s2),
        "ball_start": start_variance(settings.ball_acceleration_m_s2),
        "radius_m": [robots_of(robots, team).radius_m for team in TEAMS],
        "square": [robots_of(robots, team).outline == "square" for team in TEAMS],
    }
    for name, value in values.items():
        rules[name] = value
    return rules


def state_of_nothing() -> Table:
    """A tracker's memory before its first frame, shape (1,)."""
    state = np.zeros(1, dtype=STATE)
    state["grabbed"] = state["obstacles_at"] = NEVER
    return state
