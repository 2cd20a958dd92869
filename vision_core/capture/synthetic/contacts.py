"""Contacts in the plane: kernels that move bodies apart, let the ball bounce, and let robots hold and kick it."""

import math

from vision_core.capture.synthetic.bodies import FRONT_RADII, HEADING, STEP_S, TURN_RATE, VX, VY, Drivers, Tally, X, Y
from vision_core.geometry import Floats
from vision_core.native.kernels import kernel

RESTITUTION_WALL = 0.6
"""Coefficient of restitution: the part of its normal speed that the ball keeps when it bounces off."""
RESTITUTION_ROBOT = 0.4
ITERATIONS = 4
"""Times that contacts are resolved in each step: a body that is pushed out of one may be pushed into another."""
DRIBBLER_M = 0.012
"""The dribbler's roller stands out this far from the front; a dribbled ball rests against it."""
DRIBBLER_HALF_WIDTH = 0.5
"""Half width of the dribbler, in radii of the robot."""
GRIP_PER_S = 15.0
"""Rate at which a dribbled ball's velocity approaches that of the dribbler."""
GRIP_RANGE_M = 0.006
"""The dribbler grips a ball up to this far from it."""
APART_M = 0.005
"""Robots whose gap is wider touch no more: what follows is another collision."""


@kernel
def separate(robots: Floats, radius: float, tally: Tally) -> None:
    """Move overlapping robots apart, each by half the overlap, and remove the speed of their approach."""
    for i in range(len(robots)):
        for j in range(i):
            dx, dy = robots[i, X] - robots[j, X], robots[i, Y] - robots[j, Y]
            distance = math.hypot(dx, dy)
            overlap = 2.0 * radius - distance
            if overlap <= 0.0:
                continue
            if not tally.touching[i, j]:
                tally.touching[i, j] = True
                tally.collisions[0] += 1
            nx, ny = (dx / distance, dy / distance) if distance > 1e-9 else (1.0, 0.0)
            closing = (robots[i, VX] - robots[j, VX]) * nx + (robots[i, VY] - robots[j, VY]) * ny
            for k, sign in ((i, 0.5), (j, -0.5)):
                robots[k, X] += sign * overlap * nx
                robots[k, Y] += sign * overlap * ny
                robots[k, VX] -= sign * min(closing, 0.0) * nx
                robots[k, VY] -= sign * min(closing, 0.0) * ny


@kernel
def bounce(body: Floats, solids: Floats, radius: float, restitution: float) -> None:
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
def keep_inside(robot: Floats, half: Floats, radius: float) -> None:
    """Stop a robot at the border of the area that it may not leave."""
    for axis in range(2):
        limit = half[axis] - radius
        if abs(robot[axis]) > limit:
            robot[axis] = limit if robot[axis] > 0.0 else -limit
            robot[VX + axis] = 0.0


@kernel
def crosses_solid(solids: Floats, x1: float, y1: float, x2: float, y2: float) -> bool:
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
def push_ball_out(robot: Floats, ball: Floats, radius: float, ball_radius: float, dribbles: bool) -> bool:
    """Push the ball out of a robot; do they touch? A ball at a turning dribbler takes on the dribbler's velocity."""
    nx, ny, depth, at_front = _overlap(robot, ball, radius, ball_radius)
    dribbled = at_front and dribbles
    gripped = dribbled and depth > -GRIP_RANGE_M
    if gripped:
        share = min(1.0, GRIP_PER_S * STEP_S / ITERATIONS)
        ball[VX] += share * (robot[VX] - robot[TURN_RATE] * (ball[Y] - robot[Y]) - ball[VX])
        ball[VY] += share * (robot[VY] + robot[TURN_RATE] * (ball[X] - robot[X]) - ball[VY])
    if depth > 0.0:
        _push(ball, nx, ny, depth, robot[VX], robot[VY], 0.0 if dribbled else RESTITUTION_ROBOT)
    return bool(gripped or depth > 0.0)


@kernel
def push_robot_back(robot: Floats, ball: Floats, radius: float, ball_radius: float) -> None:
    """Push a robot back from a ball that still overlaps it, because a wall stopped the ball."""
    nx, ny, depth, _ = _overlap(robot, ball, radius, ball_radius)
    if depth > 0.0:
        _push(robot, -nx, -ny, depth, 0.0, 0.0, 0.0)


@kernel
def kick(robots: Floats, drivers: Drivers, ball: Floats, radii: Floats, tally: Tally) -> None:
    """Let robots kick the ball that lies at their front. A kick is carried out once, and ends the dribbling."""
    for i in range(len(robots)):
        if drivers.kicks_m_s[i] > 0.0:
            nx, ny, depth, at_front = _overlap(robots[i], ball, radii[0], radii[1])
            if at_front and depth > -GRIP_RANGE_M:
                ball[VX] = robots[i, VX] + drivers.kicks_m_s[i] * nx
                ball[VY] = robots[i, VY] + drivers.kicks_m_s[i] * ny
                drivers.kicks_m_s[i] = 0.0
                drivers.dribbles[i] = False
                tally.touched[0] = i


@kernel
def end_contacts(robots: Floats, radius: float, tally: Tally) -> None:
    """Note which robots have come apart."""
    for i in range(len(robots)):
        for j in range(i):
            if tally.touching[i, j]:
                distance = math.hypot(robots[i, X] - robots[j, X], robots[i, Y] - robots[j, Y])
                tally.touching[i, j] = distance <= 2.0 * radius + APART_M


def holds_ball(robot: Floats, ball: Floats, radius_m: float, ball_radius_m: float) -> bool:
    """Does the ball lie at a robot's dribbler? Bodies of shape (6,)."""
    c, s = math.cos(robot[HEADING]), math.sin(robot[HEADING])
    dx, dy = ball[X] - robot[X], ball[Y] - robot[Y]
    ahead, aside = c * dx + s * dy, c * dy - s * dx
    rest = FRONT_RADII * radius_m + DRIBBLER_M + ball_radius_m
    return bool(0.0 < ahead < rest + 2.0 * GRIP_RANGE_M and abs(aside) < DRIBBLER_HALF_WIDTH * radius_m)
