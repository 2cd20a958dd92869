"""Rigid-body dynamics in the plane: kernels that move robots and ball in small fixed time steps.

A body is a row x, y, heading, vx, vy, turn rate [m, rad, m/s, rad/s]. The ball is a body, too.
"""

import math

import numpy as np

from vision_core.geometry import Floats
from vision_core.native.angles import wrap_angle
from vision_core.native.kernels import kernel

X, Y, HEADING, VX, VY, TURN_RATE = range(6)
COLUMNS = 6

STEP_S = 0.005
ROBOT_ACCELERATION_M_S2 = 3.0
TURN_ACCELERATION_RAD_S2 = 40.0
ROLLING_DECELERATION_M_S2 = 0.35
"""Deceleration of a ball that rolls on carpet."""
RESTITUTION_WALL = 0.6
"""Coefficient of restitution: the part of its normal speed that the ball keeps when it bounces off."""
RESTITUTION_ROBOT = 0.4
ITERATIONS = 4
"""Times that contacts are resolved in each step: a body that is pushed out of one may be pushed into another."""

FRONT_RADII = 0.055 / 0.09
"""Distance of a robot's flat front from its center, in radii."""
DRIBBLER_M = 0.012
"""The dribbler's roller stands out this far from the front; a dribbled ball rests against it."""
DRIBBLER_HALF_WIDTH = 0.5
"""Half width of the dribbler, in radii of the robot."""
GRIP_PER_S = 15.0
"""Rate at which a dribbled ball's velocity approaches that of the dribbler."""
GRIP_RANGE_M = 0.006
"""The dribbler grips a ball up to this far from it."""


@kernel
def move(
    robots: Floats, commands: Floats, ball: Floats, solids: Floats, half: Floats, radii: Floats, steps: int
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
            _steer(robots[i], commands[i])
            _advance(robots[i])
        _slow_rolling_ball(ball)
        _advance(ball)
        # resolve contacts, several times since each may cause another
        for _ in range(ITERATIONS):
            _separate(robots, radii[0])
            for i in range(len(robots)):
                _push_ball_out(robots[i], ball, radii[0], radii[1])
            _bounce(ball, solids, radii[1], RESTITUTION_WALL)
            for i in range(len(robots)):
                _push_robot_back(robots[i], ball, radii[0], radii[1])
                _bounce(robots[i], solids, radii[0], 0.0)
                _keep_inside(robots[i], half, radii[0])
        # a ball that was pressed through a wall goes back to where it was
        if _crosses_solid(solids, x, y, ball[X], ball[Y]):
            ball[X], ball[Y] = x, y
            ball[VX] = ball[VY] = 0.0


@kernel
def _steer(robot: Floats, command: Floats) -> None:
    """Change a robot's velocity and turn rate towards its command, within the limits of acceleration."""
    dx, dy = command[0] - robot[VX], command[1] - robot[VY]
    size = math.hypot(dx, dy)
    share = min(1.0, ROBOT_ACCELERATION_M_S2 * STEP_S / size) if size > 0.0 else 0.0
    robot[VX] += share * dx
    robot[VY] += share * dy
    limit = TURN_ACCELERATION_RAD_S2 * STEP_S
    robot[TURN_RATE] += min(max(command[2] - robot[TURN_RATE], -limit), limit)


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


@kernel
def _separate(robots: Floats, radius: float) -> None:
    """Move overlapping robots apart, each by half the overlap, and remove the speed of their approach."""
    for i in range(len(robots)):
        for j in range(i):
            dx, dy = robots[i, X] - robots[j, X], robots[i, Y] - robots[j, Y]
            distance = math.hypot(dx, dy)
            overlap = 2.0 * radius - distance
            if overlap <= 0.0:
                continue
            nx, ny = (dx / distance, dy / distance) if distance > 1e-9 else (1.0, 0.0)
            closing = (robots[i, VX] - robots[j, VX]) * nx + (robots[i, VY] - robots[j, VY]) * ny
            for k, sign in ((i, 0.5), (j, -0.5)):
                robots[k, X] += sign * overlap * nx
                robots[k, Y] += sign * overlap * ny
                robots[k, VX] -= sign * min(closing, 0.0) * nx
                robots[k, VY] -= sign * min(closing, 0.0) * ny


@kernel
def _bounce(body: Floats, solids: Floats, radius: float, restitution: float) -> None:
    """Push a body out of all walls and goals; restitution: the part of its normal speed that it keeps."""
    for i in range(len(solids)):
        ax, ay = solids[i, 0], solids[i, 1]
        bx, by = solids[i, 2] - ax, solids[i, 3] - ay
        share = ((body[X] - ax) * bx + (body[Y] - ay) * by) / (bx * bx + by * by)
        share = min(max(share, 0.0), 1.0)
        dx, dy = body[X] - ax - share * bx, body[Y] - ay - share * by
        distance = math.hypot(dx, dy)
        if 1e-9 < distance < radius:
            _push(body, dx / distance, dy / distance, radius - distance, 0.0, 0.0, restitution)


@kernel
def _push(body: Floats, nx: float, ny: float, depth: float, vx: float, vy: float, restitution: float) -> None:
    """Move a body along a contact's normal by its depth; if it approaches, reflect its speed relative to (vx, vy)."""
    body[X] += depth * nx
    body[Y] += depth * ny
    closing = (body[VX] - vx) * nx + (body[VY] - vy) * ny
    if closing < 0.0:
        body[VX] -= (1.0 + restitution) * closing * nx
        body[VY] -= (1.0 + restitution) * closing * ny


@kernel
def _keep_inside(robot: Floats, half: Floats, radius: float) -> None:
    """Stop a robot at the border of the area that it may not leave."""
    for axis in range(2):
        limit = half[axis] - radius
        if abs(robot[axis]) > limit:
            robot[axis] = limit if robot[axis] > 0.0 else -limit
            robot[VX + axis] = 0.0


@kernel
def _crosses_solid(solids: Floats, x1: float, y1: float, x2: float, y2: float) -> bool:
    """Does the segment between two points cross a wall or goal?"""
    for i in range(len(solids)):
        ax, ay, bx, by = solids[i]
        from_a = (bx - ax) * (y1 - ay) - (by - ay) * (x1 - ax)
        to_a = (bx - ax) * (y2 - ay) - (by - ay) * (x2 - ax)
        a_side = (x2 - x1) * (ay - y1) - (y2 - y1) * (ax - x1)
        b_side = (x2 - x1) * (by - y1) - (y2 - y1) * (bx - x1)
        if from_a * to_a < 0.0 and a_side * b_side < 0.0:
            return True
    return False


@kernel
def _overlap(robot: Floats, ball: Floats, radius: float, ball_radius: float) -> tuple[float, float, float, bool]:
    """The contact of robot and ball: its normal x, y from robot to ball, depth [m], and whether it is at the dribbler.

    A negative depth is a gap.
    """
    c, s = math.cos(robot[HEADING]), math.sin(robot[HEADING])
    dx, dy = ball[X] - robot[X], ball[Y] - robot[Y]
    ahead, aside = c * dx + s * dy, c * dy - s * dx
    if ahead > 0.0 and abs(aside) < DRIBBLER_HALF_WIDTH * radius:
        return c, s, FRONT_RADII * radius + DRIBBLER_M + ball_radius - ahead, True
    distance = max(math.hypot(dx, dy), 1e-9)
    return dx / distance, dy / distance, radius + ball_radius - distance, False


@kernel
def _push_ball_out(robot: Floats, ball: Floats, radius: float, ball_radius: float) -> None:
    """Push the ball out of a robot. A ball at the dribbler takes on the dribbler's velocity."""
    nx, ny, depth, dribbled = _overlap(robot, ball, radius, ball_radius)
    if dribbled and depth > -GRIP_RANGE_M:
        share = min(1.0, GRIP_PER_S * STEP_S / ITERATIONS)
        ball[VX] += share * (robot[VX] - robot[TURN_RATE] * (ball[Y] - robot[Y]) - ball[VX])
        ball[VY] += share * (robot[VY] + robot[TURN_RATE] * (ball[X] - robot[X]) - ball[VY])
    if depth > 0.0:
        _push(ball, nx, ny, depth, robot[VX], robot[VY], 0.0 if dribbled else RESTITUTION_ROBOT)


@kernel
def _push_robot_back(robot: Floats, ball: Floats, radius: float, ball_radius: float) -> None:
    """Push a robot back from a ball that still overlaps it, because a wall stopped the ball."""
    nx, ny, depth, _ = _overlap(robot, ball, radius, ball_radius)
    if depth > 0.0:
        _push(robot, -nx, -ny, depth, 0.0, 0.0, 0.0)


def holds_ball(robot: Floats, ball: Floats, radius_m: float, ball_radius_m: float) -> bool:
    """Does the ball lie at a robot's dribbler? Bodies of shape (6,)."""
    c, s = math.cos(robot[HEADING]), math.sin(robot[HEADING])
    dx, dy = ball[X] - robot[X], ball[Y] - robot[Y]
    ahead, aside = c * dx + s * dy, c * dy - s * dx
    rest = FRONT_RADII * radius_m + DRIBBLER_M + ball_radius_m
    return bool(0.0 < ahead < rest + 2.0 * GRIP_RANGE_M and abs(aside) < DRIBBLER_HALF_WIDTH * radius_m)


def no_bodies(count: int) -> Floats:
    """Bodies at rest at the field's center, shape (count, 6)."""
    return np.zeros((count, COLUMNS))
