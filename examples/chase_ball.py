"""A robot's program with the client module: turn towards the ball and drive there, unless something is in the way.

    python examples/chase_ball.py [TEAM NUMBER [HOST [PORT [VIEWS]]]]

It prints what it would tell the wheels. Angles grow anticlockwise from the robot's heading.
"""

import sys

import numpy as np

from vision_core.client import View, connect

BODY_MM = 90.0
CLEAR_MM = 250.0
AHEAD_DEG = 30.0


def command(view: View) -> str:
    """What the robot does next."""
    if view.ball.hidden:
        return "turn left, looking for the ball"
    turn_deg = (view.ball.direction_deg + 180) % 360 - 180
    towards_ball = np.abs((view.directions_deg - view.ball.direction_deg + 180.0) % 360.0 - 180.0) < AHEAD_DEG
    nearest_mm = view.mm[towards_ball].min()
    if nearest_mm < min(CLEAR_MM, view.ball_mm):
        return f"something {nearest_mm - BODY_MM:.0f} mm ahead: drive around it"
    return f"turn {turn_deg:+d} deg, drive {view.ball_mm - BODY_MM:.0f} mm"


def main(
    team: str = "blue", number: str = "3", host: str = "127.0.0.1", port: str = "6000", views: str = "100"
) -> None:
    """Connect and follow the ball."""
    with connect(host, int(port), team, int(number)) as robot:
        for count, view in enumerate(robot, start=1):
            print(f"{view.time_s:.3f} s: {command(view)}")
            if count == int(views):
                break


if __name__ == "__main__":
    main(*sys.argv[1:])
