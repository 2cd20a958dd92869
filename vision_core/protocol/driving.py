"""Driving the robots of a simulated venue: the command, and what the robots can do."""

import math
from dataclasses import dataclass, replace
from typing import NamedTuple

from vision_core.types.objects import Team

ROUNDING = 1e-3
"""A speed may be beyond a limit by so much: commands are written in decimals [m/s, rad/s]."""


@dataclass(frozen=True, slots=True)
class Drive:
    """``(drive Vx Vy Omega)``: how a robot shall move from now on, in its own frame."""

    vx_m_s: float = 0.0
    """Forward."""
    vy_m_s: float = 0.0
    """To the left."""
    turn_rad_s: float = 0.0
    """Anticlockwise."""
    kick_m_s: float = 0.0
    """``(kick Speed)``: kick the ball with this speed as soon as it is at the front; 0: no kick."""
    dribble: bool = False
    """``(dribble)``: hold the ball at the front."""
    team: Team | None = None
    number: int | None = None

    @property
    def is_finite(self) -> bool:
        """Is every number one?"""
        return all(map(math.isfinite, (self.vx_m_s, self.vy_m_s, self.turn_rad_s, self.kick_m_s)))

    def seen_after(self, x_m: float, y_m: float, duration_s: float) -> tuple[float, float]:
        """Where a standing point is in the robot's frame, when it has followed this command for so long [s]."""
        angle = self.turn_rad_s * duration_s
        along, across = (math.sin(angle) / angle, (1.0 - math.cos(angle)) / angle) if angle else (1.0, 0.0)
        moved_x = duration_s * (along * self.vx_m_s - across * self.vy_m_s)
        moved_y = duration_s * (across * self.vx_m_s + along * self.vy_m_s)
        c, s = math.cos(angle), math.sin(angle)
        dx, dy = x_m - moved_x, y_m - moved_y
        return c * dx + s * dy, c * dy - s * dx


class DriveLimits(NamedTuple):
    """What a robot can do: the pair ``(drive Vx Vy Omega Kick Dribbler)`` of the answer to ``init``."""

    vx_m_s: float
    """Highest speed, forward and backward and altogether."""
    vy_m_s: float
    """Highest speed to the left and right; 0: on two wheels."""
    turn_rad_s: float
    kick_m_s: float
    """0: no kicker."""
    dribbler: bool

    def allow(self, drive: Drive) -> bool:
        """Can a robot do this?"""
        return (
            drive.is_finite
            and math.hypot(drive.vx_m_s, drive.vy_m_s) <= self.vx_m_s + ROUNDING
            and abs(drive.vy_m_s) <= self.vy_m_s + ROUNDING
            and abs(drive.turn_rad_s) <= self.turn_rad_s + ROUNDING
            and 0.0 <= drive.kick_m_s <= self.kick_m_s + ROUNDING
            and (self.dribbler or not drive.dribble)
        )

    def clipped(self, drive: Drive) -> Drive:
        """The nearest that a robot can do: slower in the same direction, and without what it lacks."""
        vy = drive.vy_m_s if self.vy_m_s else 0.0
        share = min(1.0, self.vx_m_s / max(math.hypot(drive.vx_m_s, vy), 1e-9), self.vy_m_s / abs(vy) if vy else 1.0)
        return replace(
            drive,
            vx_m_s=share * drive.vx_m_s,
            vy_m_s=share * vy,
            turn_rad_s=min(max(drive.turn_rad_s, -self.turn_rad_s), self.turn_rad_s),
            kick_m_s=min(max(drive.kick_m_s, 0.0), self.kick_m_s),
            dribble=drive.dribble and self.dribbler,
        )
