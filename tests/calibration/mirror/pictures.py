"""On-board pictures that are drawn, not traced: rings and walls around the center of the picture."""

import numpy as np

from vision_core.geometry import Bytes, Floats

SIZE_PX = (320, 240)
CENTER_PX = (159.5, 119.5)
FLOOR, WALL, BODY = (60, 120, 50), (200, 200, 200), (40, 40, 40)
FINE = 4


def around(edge_px: Floats, *, line_px: float | None = None, center_px: tuple[float, float] = CENTER_PX) -> Bytes:
    """A floor that ends at a radius for each whole degree anticlockwise from up, shape (360,); shape (240, 320, 3).

    line_px: radius of a painted ring, 2 px wide. The robot's body covers 20 px, and all is dark from 115 px on.
    """
    width, height = SIZE_PX
    x = (np.arange(width * FINE) + 0.5) / FINE - 0.5 - center_px[0]
    y = (np.arange(height * FINE) + 0.5) / FINE - 0.5 - center_px[1]
    right, down = np.meshgrid(x, y)
    radius, turn = np.hypot(right, down), np.degrees(np.arctan2(-right, -down)) % 360.0
    edge = np.interp(turn, np.arange(361.0), np.append(edge_px, edge_px[0]))
    picture = np.where((radius < edge)[..., None], FLOOR, WALL)
    picture[(radius > 115.0)] = (5, 5, 5)
    if line_px is not None:
        picture[(np.abs(radius - line_px) < 1.0) & (radius < edge)] = (230, 230, 230)
    picture[radius < 20.0] = BODY
    return np.asarray(picture.reshape(height, FINE, width, FINE, 3).mean(axis=(1, 3)).round(), dtype=np.uint8)
