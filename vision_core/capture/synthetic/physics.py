"""Rigid-body dynamics in the plane: kernels that move robots and ball in small fixed time steps."""

import math

from vision_core.capture.synthetic.bodies import HEADING, STEP_S, TURN_RATE, VX, VY, Drivers, Tally, X, Y
from vision_core.capture.synthetic.contacts import (
    ITERATIONS,
    RESTITUTION_WALL,
    bounce,
    crosses_solid,
    end_contacts,
    keep_inside,
    kick,
    push_ball_out,
    push_robot_back,
    separate,
)
from vision_core.geometry import Floats
from vision_core.native.angles import wrap_angle
from vision_core.native.kernels import kernel

ROBOT_ACCELERATION_M_S2 = 3.0
TURN_ACCELERATION_RAD_S2 = 40.0
"""Of robots without a driver."""
ROLLING_DECELERATION_M_S2 = 0.35
"""Deceleration of a ball that rolls on carpet."""


@kernel
def move(
    robots: Floats, commands: Floats, drivers: Drivers, ball: Floats, solids: Floats, half: Floats, radii: Floats,
    tally: Tally, steps: int,
) -> None:  # fmt: skip
    """Move everything by a number of steps, in place.

    robots: shape (n, 6); commands: velocity and turn rate that each robot shall have, shape (n, 3); ball: shape (6,);
    solids: walls and goals x1, y1, x2, y2, shape (m, 4); half: half length and width of the area that robots
    may not leave, shape (2,); radii: of robots and ball, shape (2,).
    """
    for _ in range(steps):
        # move every body freely
        x, y = ball[X], ball[Y]
        for i in range(len(robots)):
            if drivers.driven[i]:
                _follow_driver(robots[i], drivers.wanted[i], drivers.limits)
            else:
                vx, vy, turn = commands[i]
                _steer(robots[i], vx, vy, turn, ROBOT_ACCELERATION_M_S2, TURN_ACCELERATION_RAD_S2)
            _advance(robots[i])
        _slow_rolling_ball(ball)
        _advance(ball)
        # resolve contacts, several times since each may cause another
        for _ in range(ITERATIONS):
            separate(robots, radii[0], tally)
            for i in range(len(robots)):
                if push_ball_out(robots[i], ball, radii[0], radii[1], drivers.dribbles[i]):
                    tally.touched[0] = i
            bounce(ball, solids, radii[1], RESTITUTION_WALL)
            for i in range(len(robots)):
                push_robot_back(robots[i], ball, radii[0], radii[1])
                bounce(robots[i], solids, radii[0], 0.0)
                keep_inside(robots[i], half, radii[0])
        # a ball that was pressed through a wall goes back to where it was
        if crosses_solid(solids, x, y, ball[X], ball[Y]):
            ball[X], ball[Y] = x, y
            ball[VX] = ball[VY] = 0.0
        kick(robots, drivers, ball, radii, tally)
        end_contacts(robots, radii[0], tally)


@kernel
def _steer(robot: Floats, vx: float, vy: float, turn: float, acceleration: float, turn_acceleration: float) -> None:
    """Change a robot's velocity and turn rate towards those wanted, within the limits of acceleration."""
    dx, dy = vx - robot[VX], vy - robot[VY]
    size = math.hypot(dx, dy)
    share = min(1.0, acceleration * STEP_S / size) if size > 0.0 else 0.0
    robot[VX] += share * dx
    robot[VY] += share * dy
    limit = turn_acceleration * STEP_S
    robot[TURN_RATE] += min(max(turn - robot[TURN_RATE], -limit), limit)


@kernel
def _follow_driver(robot: Floats, wanted: Floats, limits: Floats) -> None:
    """Steer a robot as its driver asks. Two wheels do not slip sideways: the robot rolls where it heads."""
    c, s = math.cos(robot[HEADING]), math.sin(robot[HEADING])
    forward, left = wanted[0], wanted[1]
    if limits[2] > 0.0:
        rolling = c * robot[VX] + s * robot[VY]
        robot[VX], robot[VY] = c * rolling, s * rolling
        left = 0.0
    _steer(robot, c * forward - s * left, s * forward + c * left, wanted[2], limits[0], limits[1])


@kernel
def _advance(body: Floats) -> None:
    """Integrate a body's velocity over one step."""
    body[X] += body[VX] * STEP_S
    body[Y] += body[VY] * STEP_S
    body[HEADING] = wrap_angle(body[HEADING] + body[TURN_RATE] * STEP_S)


@kernel
def _slow_rolling_ball(ball: Floats) -> None:
    """Reduce the ball's speed by rolling friction."""
    speed = math.hypot(ball[VX], ball[VY])
    factor = max(0.0, 1.0 - ROLLING_DECELERATION_M_S2 * STEP_S / speed) if speed > 0.0 else 0.0
    ball[VX] *= factor
    ball[VY] *= factor
