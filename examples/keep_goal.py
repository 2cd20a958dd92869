"""A controller that keeps its goal: it stays between the goal and the ball, and kicks away what comes near.

pslv play --controller keeper                                      # robots 1 of both teams play it anyway
python examples/keep_goal.py [TEAM NUMBER [HOST [PORT [VIEWS]]]]   # one robot
"""

import math
import sys

import numpy as np

from vision_core.client import Drive, Options, Robot, View
from vision_core.client.play.one_robot import drive_robot

GOALS = {"blue": "u", "yellow": "v"}
"""The goal that each team defends."""
OUT_M = 0.42
"""Distance from the middle of what is seen of the goal: the keeper stands before its mouth."""
NEAR_M = 0.35
SEARCH_RAD_S = 2.0


class KeepGoal:
    """Plays one robot."""

    options = Options(types="team")

    def __init__(self, robot: Robot) -> None:
        self._robot = robot
        self._goal = GOALS[robot.team]
        self._out_m = max(OUT_M * robot.field_m[1] / 2.3, 2.5 * robot.radius_m)

    def decide(self, view: View) -> Drive:
        """What the robot does next."""
        ball, own = view.ball_m, view.points_m[view.letters == self._goal]
        if not len(own):  # nothing is known of where the goal is
            return Drive(turn_rad_s=SEARCH_RAD_S)
        goal = own.mean(axis=0)
        if ball is None:
            away = -goal / max(float(np.hypot(*goal)), 1e-6)
            x, y = goal + self._out_m * away
            return self._robot.towards(float(x), float(y), 0.5)
        angle, distance = math.atan2(ball[1], ball[0]), math.hypot(*ball)
        to_ball = ball - goal
        out = to_ball / max(float(np.hypot(*to_ball)), 1e-6)
        if distance < NEAR_M and float(np.dot(ball, goal)) <= 0.5 * distance * float(np.hypot(*goal)):
            return self._clear(ball, angle, distance)
        x, y = goal + min(self._out_m, 0.7 * float(np.hypot(*to_ball))) * out
        return self._robot.towards(float(x), float(y), angle)

    def _clear(self, ball: tuple[float, float], angle: float, distance: float) -> Drive:
        """The ball is near and the goal is not behind it: drive at it and kick."""
        drive = self._robot.towards(1.3 * ball[0], 1.3 * ball[1], angle)
        aims = distance < self._robot.radius_m + 0.05 and abs(angle) < 0.5
        return Drive(drive.vx_m_s, drive.vy_m_s, drive.turn_rad_s, self._robot.limits.kick_m_s * 0.8 if aims else 0.0)


if __name__ == "__main__":
    drive_robot(KeepGoal, *(sys.argv[1:] or ["blue", "1"]))
