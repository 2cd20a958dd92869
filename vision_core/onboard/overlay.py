"""What was recognized in an on-board picture, drawn into it."""

import numpy as np

from vision_core.client.panorama import BALL, COLORS, UNDEFINED_COLOR
from vision_core.client.recognition import PictureGeometry, Recognized
from vision_core.geometry import Bytes
from vision_core.native.opencv import Color, draw_circle
from vision_core.types.edges import Rgb

MIN_WIDTH_PX = 960
"""Smaller pictures are enlarged by a whole factor."""
DOT_PX, RIM_PX = 2.5, 3.5
"""Of an edge: the dot in the color of its type, and the dark disc under it."""
DARK: Color = (0, 0, 0)


def draw_recognized(picture: Bytes, recognized: Recognized, geometry: PictureGeometry) -> Bytes:
    """The picture, enlarged, with a dot for the edge of every direction and a circle for the ball."""
    factor = max(-(-MIN_WIDTH_PX // picture.shape[1]), 1)
    large = np.ascontiguousarray(picture.repeat(factor, axis=0).repeat(factor, axis=1))

    def place(radius_px: float, direction_deg: float) -> tuple[float, float]:
        angle = np.radians(direction_deg)
        forward, left = np.array([radius_px * np.cos(angle)]), np.array([radius_px * np.sin(angle)])
        (column,), (row,) = geometry.pixel_from_px(forward, left)
        return factor * (float(column) + 0.5) - 0.5, factor * (float(row) + 0.5) - 0.5

    step_deg = 360.0 / len(recognized.px)
    for number, (letter, radius) in enumerate(zip(recognized.letters, recognized.radii_px, strict=True)):
        if np.isfinite(radius):
            at = place(float(radius), number * step_deg)
            draw_circle(large, at, RIM_PX, DARK, -1)
            draw_circle(large, at, DOT_PX, _bgr(COLORS.get(str(letter), UNDEFINED_COLOR)), -1)
    ball = recognized.ball
    if not ball.hidden:
        shown_mm = geometry.mirror.mm_from_px(ball.px + 0.5) / geometry.ball_shrink
        radius = geometry.mirror.px_from_mm(shown_mm) if np.isfinite(shown_mm) else ball.px + 0.5
        half = max(np.sin(np.radians(min(ball.size_deg, 180) / 2.0)) * radius, 2.0)
        draw_circle(large, place(radius, ball.direction_deg), factor * geometry.scale * half, _bgr(BALL), 2)
    return large


def _bgr(rgb: Rgb) -> Color:
    return rgb[2], rgb[1], rgb[0]
