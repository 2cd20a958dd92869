"""A controller that drives to the ball from behind, takes it to the other goal and kicks. It knows its views only.

    pslv play --controller chase                                               # robots of both teams
    python examples/chase_ball.py [TEAM NUMBER [HOST [PORT [VIEWS]]]]          # one robot

Points are in the robot's own frame: x forward, y to the left.
"""

import math
import sys

import numpy as np

from vision_core.client import Drive, Options, Robot, View
from vision_core.client.play.one_robot import drive_robot

GOALS = {"blue": "v", "yellow": "u"}
"""The goal that each team attacks."""
MATES = {"blue": "x", "yellow": "y"}
BODIES = ("r", "x", "y", "q")
"""Robots of both teams, in a match perhaps without their colors, and things that are no robot."""
SEARCH_RAD_S = 2.0
HOLD_M = 0.03
"""The ball is held when it is nearer to the robot's rim than this, in front."""
AIM_RAD = 0.12
BEHIND_M = 0.10
SUPPORT_M = 0.55
"""A robot whose mate is nearer to the ball stays so far from it."""
LOOK_AHEAD_M = 0.4


class ChaseBall:
    """Plays one robot."""

    options = Options(types="team")

    def __init__(self, robot: Robot) -> None:
        self._robot = robot
        self._goal, self._mate = GOALS[robot.team], MATES[robot.team]

    def decide(self, view: View) -> Drive:
        """What the robot does next."""
        ball, points = view.ball_m, view.points_m
        if ball is None:
            return Drive(turn_rad_s=SEARCH_RAD_S)
        goal = middle(points[view.letters == self._goal])
        distance, angle = math.hypot(*ball), math.atan2(ball[1], ball[0])
        if distance < self._robot.radius_m + HOLD_M and abs(angle) < 0.5 and self._robot.limits.dribbler:
            return self._play_ball(goal)
        mates = points[view.letters == self._mate] - ball
        if len(mates) and np.hypot(*mates.T).min() + self._robot.radius_m < distance - 0.1:
            x, y = (part * (1.0 - SUPPORT_M / distance) for part in ball)
        else:
            x, y = self._behind(ball, goal)
        x, y = self._around(x, y, points[np.isin(view.letters, BODIES)])
        return self._robot.towards(x, y, angle, self._robot.limits.vx_m_s * 0.7)

    def _play_ball(self, goal: tuple[float, float] | None) -> Drive:
        """The ball is held: turn to the goal and kick, or look for the goal."""
        if goal is None:
            return Drive(0.2, 0.0, 1.2, dribble=True)
        angle = math.atan2(goal[1], goal[0])
        if abs(angle) < AIM_RAD:
            return Drive(0.5, 0.0, 0.0, kick_m_s=self._robot.limits.kick_m_s * 0.7)
        return Drive(0.1, 0.0, max(-2.5, min(2.5, 4.0 * angle)), dribble=True)

    def _behind(self, ball: tuple[float, float], goal: tuple[float, float] | None) -> tuple[float, float]:
        """Where to drive: to a point behind the ball as the goal sees it, then through the ball."""
        if goal is None:
            return ball
        to_goal = np.subtract(goal, ball)
        aim = to_goal / max(float(np.hypot(*to_goal)), 1e-6)
        if float(np.dot(ball, aim)) > 0.85 * math.hypot(*ball):
            return ball[0] + 0.1 * float(aim[0]), ball[1] + 0.1 * float(aim[1])
        side = np.array([-aim[1], aim[0]])
        target = ball - (self._robot.radius_m + BEHIND_M) * aim
        if float(np.dot(ball, aim)) < 0.0:  # the robot is on the wrong side: go round the ball
            target += math.copysign(2.0 * self._robot.radius_m, -float(np.dot(ball, side))) * side
        return float(target[0]), float(target[1])

    def _around(self, x: float, y: float, bodies: np.ndarray) -> tuple[float, float]:
        """The target, or a point beside what stands in the way."""
        distance = math.hypot(x, y)
        if distance < 1e-6:
            return x, y
        along = np.array([x, y]) / distance
        ahead, aside = bodies @ along, bodies @ np.array([-along[1], along[0]])
        blocks = (ahead > 0.0) & (ahead < min(distance, LOOK_AHEAD_M)) & (np.abs(aside) < 1.3 * self._robot.radius_m)
        if not blocks.any():
            return x, y
        turn = math.copysign(0.9, -float(aside[blocks].mean()))
        c, s = math.cos(turn), math.sin(turn)
        return c * x - s * y, s * x + c * y


def middle(points: np.ndarray) -> tuple[float, float] | None:
    """The middle of some points; None when there is none."""
    return (float(points[:, 0].mean()), float(points[:, 1].mean())) if len(points) else None


if __name__ == "__main__":
    drive_robot(ChaseBall, *sys.argv[1:])
