"""Upper level 1: free space. How far a robot can drive in each direction, from the edges alone; and a robot that roams.

pslv play --controller examples/free_space.py:Roam --robots 3
"""

import math

import numpy as np
import numpy.typing as npt

from vision_core.client import Drive, Robot, View

CANDIDATES_RAD = np.radians(np.arange(-180, 180, 5))
MARGIN_M = 0.03
STRAIGHT_ON = 0.6
"""How much a direction counts less when it lies behind: 0 not at all, 1 wholly."""


def free_m(points_m: npt.NDArray[np.float64], radius_m: float) -> npt.NDArray[np.float64]:
    """How far a disc can be driven in each of CANDIDATES_RAD until it touches an edge [m], inf for no edge.

    points_m: edges in the robot's frame, nan for none, shape (n, 2).
    """
    heading = np.column_stack([np.cos(CANDIDATES_RAD), np.sin(CANDIDATES_RAD)])
    ahead = points_m @ heading.T
    aside = points_m @ np.column_stack([-heading[:, 1], heading[:, 0]]).T
    reach = radius_m + MARGIN_M
    in_the_way = (ahead > 0.0) & (np.abs(aside) < reach)
    until = ahead - np.sqrt(np.maximum(reach**2 - aside**2, 0.0))
    free: npt.NDArray[np.float64] = np.where(in_the_way, until, np.inf).min(axis=0)
    return np.maximum(free, 0.0)


class Roam:
    """Drives where there is most room, rather ahead than back."""

    def __init__(self, robot: Robot) -> None:
        self._robot = robot

    def decide(self, view: View) -> Drive:
        """What the robot does next."""
        free = np.minimum(free_m(view.points_m, self._robot.radius_m), 2.0)
        best = int((free * (1.0 - STRAIGHT_ON * (1.0 - np.cos(CANDIDATES_RAD)) / 2.0)).argmax())
        angle, distance = float(CANDIDATES_RAD[best]), float(free[best])
        ahead_m = 0.8 * distance
        return self._robot.towards(ahead_m * math.cos(angle), ahead_m * math.sin(angle), angle, 0.8)
