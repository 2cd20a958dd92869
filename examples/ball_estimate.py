"""Upper level 3: the ball, also while something hides it. A filter with the ball's velocity, in the robot's own frame.

    pslv play --controller examples/ball_estimate.py:Follow --robots 3

The robot moves under the estimate: each step first carries it into the new frame by what the robot was told to do.
"""

import math

from vision_core.client import Drive, Robot, View

TRUST = 0.6
"""Share of a measured difference that the position takes over; the rest is taken for noise of the pixels."""
SPEED_TRUST = 0.25
ROLLING_M_S2 = 0.35
"""Deceleration of a ball that rolls on carpet."""
FORGET_S = 2.0
"""A ball that was not seen for so long may be anywhere."""
APART_M = 0.4
"""A ball that is seen so far from where it should be was kicked or put down elsewhere: begin anew."""


class BallEstimate:
    """Position and velocity of the ball in the robot's frame [m, m/s]."""

    def __init__(self) -> None:
        self.position: tuple[float, float] | None = None
        self.velocity = 0.0, 0.0
        self.unseen_s = 0.0
        self._time_s = math.nan

    def update(self, view: View, moved: Drive) -> tuple[float, float] | None:
        """Where the ball was at the view's instant; None when nothing is known.

        moved: the command that the robot has followed since the last view.
        """
        passed_s = view.time_s - self._time_s
        self._time_s = view.time_s
        if self.position is not None and 0.0 < passed_s < FORGET_S:
            self._predict(moved, passed_s)
        if view.ball_m is not None:
            self._correct(view.ball_m, passed_s)
        elif self.unseen_s > FORGET_S:
            self.position, self.velocity = None, (0.0, 0.0)
        return self.position

    def _predict(self, moved: Drive, passed_s: float) -> None:
        assert self.position is not None
        speed = math.hypot(*self.velocity)
        slower = max(1.0 - ROLLING_M_S2 * passed_s / speed, 0.0) if speed else 0.0
        vx, vy = (part * slower for part in self.velocity)
        x, y = self.position
        self.position = moved.seen_after(x + vx * passed_s, y + vy * passed_s, passed_s)
        turned = Drive(turn_rad_s=moved.turn_rad_s)
        self.velocity = turned.seen_after(vx, vy, passed_s)
        self.unseen_s += passed_s

    def _correct(self, seen: tuple[float, float], passed_s: float) -> None:
        self.unseen_s = 0.0
        if self.position is None or math.dist(seen, self.position) > APART_M or not passed_s > 0.0:
            self.position, self.velocity = seen, (0.0, 0.0)
            return
        dx, dy = seen[0] - self.position[0], seen[1] - self.position[1]
        self.position = self.position[0] + TRUST * dx, self.position[1] + TRUST * dy
        gain = SPEED_TRUST / passed_s
        self.velocity = self.velocity[0] + gain * dx, self.velocity[1] + gain * dy


class Follow:
    """Drives to the ball, also while it is hidden."""

    def __init__(self, robot: Robot) -> None:
        self._robot = robot
        self.estimate = BallEstimate()
        self._told = Drive()

    def decide(self, view: View) -> Drive:
        """What the robot does next."""
        ball = self.estimate.update(view, self._told)
        self._told = Drive(turn_rad_s=2.0)
        if ball is not None:
            toward = self._robot.towards(*ball, math.atan2(ball[1], ball[0]), 1.0)
            self._told = self._robot.limits.clipped(toward)
        return self._told
