"""Bodies on the floor: kernels that move robots and ball by one small step after the other.

A body is a row x, y, heading, vx, vy, turn [m, rad, m/s, rad/s]; the ball is one too.
"""

import math

import numpy as np

from vision_core.geometry import Floats
from vision_core.native.angles import wrap_angle
from vision_core.native.kernels import kernel

X, Y, HEADING, VX, VY, TURN = range(6)
COLUMNS = 6

STEP_S = 0.005
ROBOT_ACCELERATION_M_S2 = 3.0
TURN_ACCELERATION_RAD_S2 = 40.0
ROLLING_M_S2 = 0.35
"""A ball on carpet loses this much speed every second."""
REBOUND_WALL = 0.6
REBOUND_ROBOT = 0.4
PASSES = 4
"""Bodies pushed apart may push others: so often this is done again."""

FRONT = 0.055 / 0.09
"""A robot's flat front, in radii from its center."""
DRIBBLER_M = 0.012
"""The roller sticks out this far from the front, and there the ball rests."""
MOUTH = 0.5
"""Half width of the dribbler, in radii."""
GRIP_PER_S = 15.0
"""How quickly a dribbled ball takes on the robot's own motion."""
GRIP_REACH_M = 0.006


@kernel
def move(
    robots: Floats, wishes: Floats, ball: Floats, solids: Floats, half: Floats, radii: Floats, steps: int
) -> None:  # fmt: skip
    """Move everything by a number of steps, in place.

    robots: shape (n, 6); wishes: velocities and turns that the robots want, shape (n, 3); ball: shape (6,);
    solids: walls and goals x1, y1, x2, y2, shape (m, 4); half: half length and width of the area that robots
    keep to, shape (2,); radii: of robots and ball, shape (2,).
    """
    for _ in range(steps):
        x, y = ball[X], ball[Y]
        for i in range(len(robots)):
            _steer(robots[i], wishes[i])
            _advance(robots[i])
        _roll(ball)
        _advance(ball)
        for _ in range(PASSES):
            _part(robots, radii[0])
            for i in range(len(robots)):
                _touch(robots[i], ball, radii[0], radii[1])
            _rebound(ball, solids, radii[1], REBOUND_WALL)
            for i in range(len(robots)):
                _give_way(robots[i], ball, radii[0], radii[1])
                _rebound(robots[i], solids, radii[0], 0.0)
                _confine(robots[i], half, radii[0])
        if _is_crossed(solids, x, y, ball[X], ball[Y]):
            ball[X], ball[Y] = x, y
            ball[VX] = ball[VY] = 0.0


@kernel
def _steer(robot: Floats, wish: Floats) -> None:
    """Change velocity and turn towards the wish, as far as a step's acceleration allows."""
    dx, dy = wish[0] - robot[VX], wish[1] - robot[VY]
    size = math.hypot(dx, dy)
    share = min(1.0, ROBOT_ACCELERATION_M_S2 * STEP_S / size) if size > 0.0 else 0.0
    robot[VX] += share * dx
    robot[VY] += share * dy
    most = TURN_ACCELERATION_RAD_S2 * STEP_S
    robot[TURN] += min(max(wish[2] - robot[TURN], -most), most)


@kernel
def _advance(body: Floats) -> None:
    body[X] += body[VX] * STEP_S
    body[Y] += body[VY] * STEP_S
    body[HEADING] = wrap_angle(body[HEADING] + body[TURN] * STEP_S)


@kernel
def _roll(ball: Floats) -> None:
    speed = math.hypot(ball[VX], ball[VY])
    left = max(0.0, 1.0 - ROLLING_M_S2 * STEP_S / speed) if speed > 0.0 else 0.0
    ball[VX] *= left
    ball[VY] *= left


@kernel
def _part(robots: Floats, radius: float) -> None:
    """Push robots that overlap apart, each by half, and take away the speed at which they close in."""
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
def _rebound(body: Floats, solids: Floats, radius: float, rebound: float) -> None:
    """Push a body out of all walls and goals; its speed into them returns with a share."""
    for i in range(len(solids)):
        ax, ay = solids[i, 0], solids[i, 1]
        bx, by = solids[i, 2] - ax, solids[i, 3] - ay
        share = ((body[X] - ax) * bx + (body[Y] - ay) * by) / (bx * bx + by * by)
        share = min(max(share, 0.0), 1.0)
        dx, dy = body[X] - ax - share * bx, body[Y] - ay - share * by
        distance = math.hypot(dx, dy)
        if 1e-9 < distance < radius:
            _push(body, dx / distance, dy / distance, radius - distance, 0.0, 0.0, rebound)


@kernel
def _push(body: Floats, nx: float, ny: float, depth: float, vx: float, vy: float, rebound: float) -> None:
    """Move a body along a normal, and turn back its speed against it, seen from what moves with (vx, vy)."""
    body[X] += depth * nx
    body[Y] += depth * ny
    closing = (body[VX] - vx) * nx + (body[VY] - vy) * ny
    if closing < 0.0:
        body[VX] -= (1.0 + rebound) * closing * nx
        body[VY] -= (1.0 + rebound) * closing * ny


@kernel
def _confine(robot: Floats, half: Floats, radius: float) -> None:
    for axis in range(2):
        most = half[axis] - radius
        if abs(robot[axis]) > most:
            robot[axis] = most if robot[axis] > 0.0 else -most
            robot[VX + axis] = 0.0


@kernel
def _is_crossed(solids: Floats, x1: float, y1: float, x2: float, y2: float) -> bool:
    """Does the way between two points cross a wall or goal? A ball pressed hard may not slip through."""
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
    """Direction from robot to ball where they touch, how deep they overlap there [m], and is it the dribbler?"""
    c, s = math.cos(robot[HEADING]), math.sin(robot[HEADING])
    dx, dy = ball[X] - robot[X], ball[Y] - robot[Y]
    ahead, aside = c * dx + s * dy, c * dy - s * dx
    if ahead > 0.0 and abs(aside) < MOUTH * radius:
        return c, s, FRONT * radius + DRIBBLER_M + ball_radius - ahead, True
    distance = max(math.hypot(dx, dy), 1e-9)
    return dx / distance, dy / distance, radius + ball_radius - distance, False


@kernel
def _touch(robot: Floats, ball: Floats, radius: float, ball_radius: float) -> None:
    """Push the ball out of a robot; what the dribbler touches it holds."""
    nx, ny, depth, dribbled = _overlap(robot, ball, radius, ball_radius)
    if dribbled and depth > -GRIP_REACH_M:
        share = min(1.0, GRIP_PER_S * STEP_S / PASSES)
        ball[VX] += share * (robot[VX] - robot[TURN] * (ball[Y] - robot[Y]) - ball[VX])
        ball[VY] += share * (robot[VY] + robot[TURN] * (ball[X] - robot[X]) - ball[VY])
    if depth > 0.0:
        _push(ball, nx, ny, depth, robot[VX], robot[VY], 0.0 if dribbled else REBOUND_ROBOT)


@kernel
def _give_way(robot: Floats, ball: Floats, radius: float, ball_radius: float) -> None:
    """Push a robot back from a ball that could not move any further."""
    nx, ny, depth, _ = _overlap(robot, ball, radius, ball_radius)
    if depth > 0.0:
        _push(robot, -nx, -ny, depth, 0.0, 0.0, 0.0)


def holds_ball(robot: Floats, ball: Floats, radius_m: float, ball_radius_m: float) -> bool:
    """Does the ball lie at a robot's dribbler? Bodies of shape (6,)."""
    c, s = math.cos(robot[HEADING]), math.sin(robot[HEADING])
    dx, dy = ball[X] - robot[X], ball[Y] - robot[Y]
    ahead, aside = c * dx + s * dy, c * dy - s * dx
    rest = FRONT * radius_m + DRIBBLER_M + ball_radius_m
    return bool(0.0 < ahead < rest + 2.0 * GRIP_REACH_M and abs(aside) < MOUTH * radius_m)


def no_bodies(count: int) -> Floats:
    """Bodies at rest at the field's center, shape (count, 6)."""
    return np.zeros((count, COLUMNS))
