"""The tracker's memory and parameters: one structured array each, of one row.

Both are arguments of this stage's kernels, so that a larger kernel can contain the whole stage.
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
"""One row of a table in a kernel: its fields are attributes."""
GATE_SIGMAS = 3.0
UNKNOWN_HEADING_VARIANCE = math.pi**2 / 3.0
"""Variance of an angle that is uniformly distributed over the circle [rad^2]."""
NEVER = -1
"""Instant of a frame that has not come yet."""

KINEMATICS = [
    ("x_m", np.float64), ("y_m", np.float64), ("vx_m_s", np.float64), ("vy_m_s", np.float64),
    ("variance", np.float64), ("covariance", np.float64), ("rate_variance", np.float64),
]  # fmt: skip
"""Position and velocity on the floor at the last sighting, and the covariance matrix that x and y share."""

ROBOT_STATE = np.dtype(
    [
        ("team", np.int32), ("id", np.int32), *KINEMATICS,
        ("heading_rad", np.float64), ("turn_rad_s", np.float64), ("heading_known", np.int64),
        ("heading_variance", np.float64), ("heading_covariance", np.float64), ("turn_variance", np.float64),
        ("confidence", np.float64), ("seen", np.int64), ("sightings", np.int64),
        ("candidate_id", np.int32), ("candidate_readings", np.int32),
        ("predicted_x_m", np.float64), ("predicted_y_m", np.float64), ("predicted_variance", np.float64),
        ("predicted_covariance", np.float64), ("predicted_rate_variance", np.float64),
        ("paired", np.int64), ("id_read", np.int64), ("expired", np.int64),
        ("nearest", np.int64), ("distance_m2", np.float64),
    ]
)  # fmt: skip
"""The track of a robot. heading_known: the heading was seen at least once. candidate_id: another id that was read on
this track, candidate_readings times in a row. The fields after these are scratch memory of one frame: the prediction
to its instant; paired: with a sighting; id_read: the track's own id was read; expired: to be deleted, as another track
took its id; nearest: the nearest free sighting, distance_m2: its squared distance."""

BALL_STATE = np.dtype([*KINEMATICS, ("seen", np.int64)])

OBSTACLE_STATE = np.dtype([*KINEMATICS, ("radius_m", np.float64), ("seen", np.int64), ("sightings", np.int64)])

TRACKER_STATE = np.dtype(
    [
        ("frames", np.int64), ("refused", np.int64), ("frame_number", np.int64), ("grabbed", np.int64),
        ("obstacles_at", np.int64), ("counts", np.int64, (3,)),
        ("robots", ROBOT_STATE, (2 * MAX_ROBOTS,)),
        ("taken", np.int64, (MAX_ROBOTS,)), ("pairs", np.int64, (MAX_ROBOTS, 2)), ("sorted", np.int64, (MAX_ROBOTS,)),
        ("balls", BALL_STATE, (1 + MAX_BALLS,)),
        ("obstacles", OBSTACLE_STATE, (MAX_OBSTACLES,)), ("new_obstacles", OBSTACLE_STATE, (MAX_OBSTACLES,)),
    ]
)  # fmt: skip
"""counts: of robots, balls, obstacles. robots: the old tracks and, while a frame is processed, as many new ones.
taken: sightings that are paired already; sorted: rows of robots in the order of the world. balls: the ball's track,
then the positions where the last frame showed other balls."""

PARAMETERS = np.dtype(
    [
        ("validity_ns", np.int64), ("ball_validity_ns", np.int64), ("obstacle_validity_ns", np.int64),
        ("gate_m", np.float64),
        ("robot_noise", np.float64), ("heading_noise", np.float64), ("ball_noise", np.float64),
        ("robot_density", np.float64), ("turn_density", np.float64), ("ball_density", np.float64),
        ("robot_start", np.float64), ("turn_start", np.float64), ("ball_start", np.float64),
        ("radius_m", np.float64, (len(TEAMS),)), ("square", np.int64, (len(TEAMS),)),
    ]
)  # fmt: skip
"""The settings in the units of the filter. noise: variance that the calibration adds to a sighting's own; density:
spectral density of the acceleration noise; start: variance of a new track's rate; radius_m, square: outline of each
team's robots."""


def parameters_from(settings: TrackSettings, robots: RobotSettings) -> Table:
    """The parameters that the settings describe: PARAMETERS, shape (1,)."""
    parameters = np.zeros(1, dtype=PARAMETERS)
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
        parameters[name] = value
    return parameters


def empty_state() -> Table:
    """A tracker's memory before its first frame: TRACKER_STATE, shape (1,)."""
    state = np.zeros(1, dtype=TRACKER_STATE)
    state["grabbed"] = state["obstacles_at"] = NEVER
    return state
