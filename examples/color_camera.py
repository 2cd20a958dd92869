"""A team's program for an on-board camera, by color with OpenCV: where is the ball, and what is the nearest obstacle?

    python examples/color_camera.py VIDEO                            pictures of a camera, as it was written
    python examples/color_camera.py TEAM NUMBER [HOST [PORT [PICTURES]]]   the views of PSLV in the camera's place

Only the line that opens the camera knows the difference. Directions are anticlockwise from the robot's heading.
"""

import itertools
import math
import sys
from collections.abc import Callable
from typing import Any, TypeAlias

import cv2
import numpy as np
from numpy.typing import NDArray

from vision_core.client.camera import Camera

Image: TypeAlias = NDArray[Any]

FLOOR = (35, 70, 0), (95, 255, 255)
WHITE = (0, 0, 110), (179, 70, 255)
BALL = (4, 150, 110), (18, 255, 255)
"""Lowest and highest hue, saturation and value."""
BODY_PX, HORIZON_PX = 30, 100


def look(picture: Image) -> dict[str, str]:
    """What is seen in one picture, blue green red."""
    hsv = cv2.cvtColor(picture, cv2.COLOR_BGR2HSV)
    floor, white, ball = (cv2.inRange(hsv, *limits) > 0 for limits in (FLOOR, WHITE, BALL))
    rows, columns = np.indices(floor.shape)
    up, left = (floor.shape[0] - 1) / 2 - rows, (floor.shape[1] - 1) / 2 - columns
    away = np.hypot(up, left)
    ring = (away > BODY_PX) & (away < HORIZON_PX)
    return {
        "ball": place(up, left, ball & ring, np.mean),
        "obstacle": place(up, left, opened(~(floor | white | ball) & ring), np.min),
    }


def opened(mask: Image) -> Image:
    """Without specks."""
    return cv2.morphologyEx(mask.astype(np.uint8), cv2.MORPH_OPEN, np.ones((3, 3), np.uint8)) > 0


def place(up: Image, left: Image, mask: Image, measure: Callable[[Image], float]) -> str:
    """Distance and direction of what is in the mask, in words."""
    if mask.sum() < 5:
        return "none"
    away = np.hypot(up, left)
    distance = measure(away[mask])
    near = mask & (away <= distance + 3)
    direction = math.degrees(math.atan2(left[near].mean(), up[near].mean())) % 360
    return f"{int(distance)} px at {direction:.0f} deg"


def main(
    source: str, number: str | None = None, host: str = "127.0.0.1", port: str = "6000", pictures: str = "100"
) -> None:
    """Print what every picture shows, until there are no more."""
    camera = cv2.VideoCapture(source) if number is None else Camera(host, int(port), source, int(number))
    for _ in itertools.repeat(None, int(pictures)):
        ok, picture = camera.read()
        if not ok or picture is None:
            break
        seen = look(picture)
        print(f"ball {seen['ball']}, nearest obstacle {seen['obstacle']}")
    camera.release()


if __name__ == "__main__":
    main(*sys.argv[1:])
