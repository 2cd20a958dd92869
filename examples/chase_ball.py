"""Turn towards the ball and drive, unless something stands in the way: a robot's program on the client module.

    python examples/chase_ball.py [TEAM NUMBER [HOST [PORT [VIEWS]]]]

It prints the wheel commands that it would give. Angles are anticlockwise from the heading, as everywhere.
"""

import sys

import numpy as np

from vision_core.client import View, connect

BODY_MM = 90.0
CLEAR_MM = 250.0
AHEAD_DEG = 30.0


def command(view: View) -> str:
    """What to do about what is seen."""
    if view.ball.hidden:
        return "turn left, looking for the ball"
    turn_deg = (view.ball.direction_deg + 180) % 360 - 180
    way = np.abs((view.directions_deg - view.ball.direction_deg + 180.0) % 360.0 - 180.0) < AHEAD_DEG
    nearest_mm = view.mm[way].min()
    if nearest_mm < min(CLEAR_MM, view.ball_mm):
        return f"something {nearest_mm - BODY_MM:.0f} mm before us: drive around it"
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
