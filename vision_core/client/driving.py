"""Driving a robot of a simulated venue: what it can do, how it gets somewhere, and the command that is sent."""

import math
from dataclasses import dataclass

from vision_core.errors import ConnectionRefused
from vision_core.models.mirror import MM_PER_M
from vision_core.protocol.driving import Drive, DriveLimits
from vision_core.protocol.encoding import encode
from vision_core.protocol.error_codes import MEANINGS, ErrorCode
from vision_core.protocol.messages import Init, SessionFacts
from vision_core.types.objects import Team

APPROACH_PER_S = 2.5
"""Speed towards a point, per distance: low enough that a robot that sees late does not overshoot."""
TURN_PER_S = 5.0
"""Turn rate towards a direction, per angle."""


@dataclass(frozen=True, slots=True)
class Robot:
    """What a controller may know of its robot: the answer to ``init``."""

    team: Team
    number: int
    limits: DriveLimits
    radius_m: float
    field_m: tuple[float, float]
    """Length and width of the field."""

    def towards(self, x_m: float, y_m: float, facing_rad: float, most_m_s: float = math.inf) -> Drive:
        """Drive to a point of the robot's own frame, slower when it is near, and turn to a direction.

        On two wheels the robot turns to the point first, and to the direction when it has arrived. most_m_s: do not
        drive faster.
        """
        distance, angle = math.hypot(x_m, y_m), math.atan2(y_m, x_m)
        speed = min(APPROACH_PER_S * distance, most_m_s, self.limits.vx_m_s)
        if self.limits.vy_m_s:
            return Drive(speed * math.cos(angle), speed * math.sin(angle), TURN_PER_S * facing_rad)
        if distance < self.radius_m / 4.0:
            return Drive(0.0, 0.0, TURN_PER_S * facing_rad)
        return Drive(speed * max(math.cos(angle), 0.0), 0.0, TURN_PER_S * angle)


def robot_of(name: str, init: Init, facts: SessionFacts | None) -> Robot:
    """The robot of a connection. Raises ConnectionRefused as ``limits_of``."""
    limits = limits_of(name, facts)
    assert facts is not None
    length_mm, width_mm = facts.field_mm
    return Robot(init.team, init.number, limits, facts.rmin_mm / MM_PER_M, (length_mm / MM_PER_M, width_mm / MM_PER_M))


def limits_of(name: str, facts: SessionFacts | None) -> DriveLimits:
    """What the robot of a connection can do. Raises ConnectionRefused when no program drives it."""
    if facts is None or facts.drive is None:
        raise ConnectionRefused(
            f"drive {name}",
            found=f"{ErrorCode.NO_DRIVE}: {MEANINGS[ErrorCode.NO_DRIVE]}",
            accepted="a robot of a simulated venue: pslv serve",
            code=ErrorCode.NO_DRIVE,
        )
    return facts.drive


def checked(drive: Drive, limits: DriveLimits) -> bytes:
    """The datagram of a command that the robot can follow. Raises ValueError."""
    if not limits.allow(drive):
        raise ValueError(f"{drive}: {MEANINGS[ErrorCode.ILLEGAL_DRIVE]}; accepted: {limits}")
    return encode(drive)
