"""What moves: robots and the ball as rows of numbers, what the drivers of robots ask for, and what is counted."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from vision_core.geometry import Floats

X, Y, HEADING, VX, VY, TURN_RATE = range(6)
"""Columns of a body [m, rad, m/s, rad/s]. The ball is a body, too."""
COLUMNS = 6
STEP_S = 0.005
"""Of the simulation."""
FRONT_RADII = 0.055 / 0.09
"""Distance of a robot's flat front from its center, in radii."""
NOBODY = -1


class Drivers(NamedTuple):
    """What the drivers of robots ask for. Robots without a driver follow their commands, and always dribble."""

    driven: NDArray[np.bool_]
    """Which robots have a driver, shape (n,)."""
    wanted: Floats
    """Forward, to the left, turn rate [m/s, rad/s], in the robot's frame, shape (n, 3)."""
    dribbles: NDArray[np.bool_]
    """Shape (n,)."""
    kicks_m_s: Floats
    """The robot kicks with this speed as soon as the ball is at its front; 0: it does not; shape (n,)."""
    limits: Floats
    """Acceleration [m/s^2], turn acceleration [rad/s^2], and 1 for robots on two wheels, shape (3,)."""


class Tally(NamedTuple):
    """What is counted."""

    touching: NDArray[np.bool_]
    """Which robot touches which one of a smaller number, shape (n, n)."""
    collisions: NDArray[np.int64]
    """Contacts of two robots that have begun, shape (1,)."""
    touched: NDArray[np.int64]
    """The robot that touched the ball last, NOBODY at first, shape (1,)."""


def no_drivers(count: int, limits: Floats) -> Drivers:
    """No robot of so many has a driver."""
    nobody, everybody = np.zeros(count, dtype=np.bool_), np.ones(count, dtype=np.bool_)
    return Drivers(nobody, np.zeros((count, 3)), everybody, np.zeros(count), limits)


def new_tally(count: int) -> Tally:
    """Nothing has happened to so many robots."""
    touching = np.zeros((count, count), dtype=np.bool_)
    return Tally(touching, np.zeros(1, dtype=np.int64), np.full(1, NOBODY, dtype=np.int64))


def no_bodies(count: int) -> Floats:
    """Bodies at rest at the field's center, shape (count, 6)."""
    return np.zeros((count, COLUMNS))
