"""Draws where boards were seen in a picture, and how far beside their corners the lens puts them."""

import numpy as np

from vision_core.calibration.board.result import LensCalibration
from vision_core.calibration.draw import FOUND, MAGNIFIED, RESIDUAL, TEXT_LEFT_PX, TEXT_STEP_PX, WHITE
from vision_core.geometry import Bytes
from vision_core.native.opencv import draw_circle, draw_line, draw_text

DARK = 40


def draw_lens(result: LensCalibration) -> Bytes:
    """All corners of all pictures on a dark ground of the pictures' size, with magnified distances and the verdict."""
    width, height = result.size_px
    canvas = np.full((height, width, 3), DARK, dtype=np.uint8)
    for picture in result.pictures:
        for x, y, step_x, step_y in picture.corners:
            draw_circle(canvas, (x, y), 1.5, FOUND, -1)
            draw_line(canvas, (x, y), (x + MAGNIFIED * step_x, y + MAGNIFIED * step_y), RESIDUAL)
    legend = f"{result.rms_px:.2f} px rms; green: corners of boards; yellow: distances x {MAGNIFIED:.0f}"
    for number, text in enumerate([legend, *(reason.text for reason in result.reasons)], start=1):
        plain = text.encode("ascii", "replace").decode()
        draw_text(canvas, plain, (TEXT_LEFT_PX, number * TEXT_STEP_PX), WHITE, 0.45)
    return canvas
