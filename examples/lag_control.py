"""Upper level 4: control that accounts for the lag (paper, section 3.5).

    pslv play --controller examples/lag_control.py:AimAtBall --robots 3

A view shows the field as it was ``view.age_s`` ago, and the command that follows it takes effect later still. Since
then the robot has moved as it was told, and the ball has rolled on. The controller decides on the field as it will be
when its command takes effect.
"""

import math
from collections import deque
from itertools import pairwise

from vision_core.client import Drive, Robot, View

EFFECT_S = 0.033
"""From the sending of a command until the robot's motors have it: here one frame of the simulation."""
MEMORY_S = 1.0
SPEED_S = 0.1
"""The ball's velocity is that of so long a time: shorter, and the pixels' steps are taken for speed."""
STILL_M_S = 0.15
TURN_PER_S = 9.0


class AimAtBall:
    """Turns so that the ball lies straight ahead. predicts: False for a controller that knows nothing of lag."""

    def __init__(self, robot: Robot, *, predicts: bool = True) -> None:
        self._robot = robot
        self._predicts = predicts
        self._told: deque[tuple[float, Drive]] = deque()
        """When commands took effect [s of the server's clock]."""
        self._seen: deque[tuple[float, float, float]] = deque()
        """Time and place of the ball, in the robot's frame of the newest view."""

    def decide(self, view: View) -> Drive:
        """What the robot does next."""
        lag_s = view.age_s + EFFECT_S if self._predicts and math.isfinite(view.age_s) else 0.0
        if view.ball_m is None:
            return self._tell(view.time_s + lag_s, Drive(turn_rad_s=2.0))
        vx, vy = self._velocity(view.time_s, view.ball_m)
        x, y = self._moved(view.ball_m[0] + vx * lag_s, view.ball_m[1] + vy * lag_s, view.time_s, view.time_s + lag_s)
        return self._tell(view.time_s + lag_s, Drive(turn_rad_s=TURN_PER_S * math.atan2(y, x)))

    def _tell(self, effect_s: float, drive: Drive) -> Drive:
        """Remember what the robot is told, and from when on it does it."""
        told = self._robot.limits.clipped(drive)
        self._told.append((effect_s, told))
        while self._told[0][0] < effect_s - MEMORY_S:
            self._told.popleft()
        return told

    def _moved(self, x: float, y: float, from_s: float, to_s: float) -> tuple[float, float]:
        """A place in the robot's frame, after it has done what it was told between two times."""
        for (began_s, drive), (ended_s, _) in pairwise([*self._told, (math.inf, Drive())]):
            duration_s = min(ended_s, to_s) - max(began_s, from_s)
            if duration_s > 0.0:
                x, y = drive.seen_after(x, y, duration_s)
        return x, y

    def _velocity(self, time_s: float, ball: tuple[float, float]) -> tuple[float, float]:
        """The ball's velocity over the floor, in the robot's present frame."""
        if self._seen:
            last_s = self._seen[-1][0]
            self._seen = deque((at_s, *self._moved(x, y, last_s, time_s)) for at_s, x, y in self._seen)
        self._seen.append((time_s, *ball))
        while self._seen[0][0] < time_s - SPEED_S:
            self._seen.popleft()
        began_s, x, y = self._seen[0]
        passed_s = time_s - began_s
        if passed_s < SPEED_S / 2.0:
            return 0.0, 0.0
        vx, vy = (ball[0] - x) / passed_s, (ball[1] - y) / passed_s
        return (vx, vy) if math.hypot(vx, vy) > STILL_M_S else (0.0, 0.0)
