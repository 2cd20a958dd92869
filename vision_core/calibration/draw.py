"""Draws a calibration over its picture: where the camera puts the lines, and how far beside that the paint lies."""

from itertools import pairwise

from vision_core.calibration.result import Calibration
from vision_core.geometry import Bytes
from vision_core.native.opencv import Color, draw_line, draw_text

FOUND: Color = (80, 255, 80)
MISSING: Color = (255, 80, 255)
RESIDUAL: Color = (0, 220, 255)
WHITE: Color = (255, 255, 255)
MAGNIFIED = 20.0
"""Residuals are drawn so many times longer than they are."""
TEXT_LEFT_PX, TEXT_STEP_PX = 8, 18


def draw_calibration(pixels: Bytes, result: Calibration) -> Bytes:
    """A copy of a picture, shape (height, width, 3), with lines, magnified residuals and the verdict."""
    canvas = pixels.copy()
    for line in result.lines:
        color = FOUND if line.rms_px is not None else MISSING
        for start, end in pairwise(line.points_px):
            if all(-1e4 < value < 1e4 for value in (*start, *end)):
                draw_line(canvas, start, end, color)
        for x, y, step_x, step_y in line.residuals:
            draw_line(canvas, (x, y), (x + MAGNIFIED * step_x, y + MAGNIFIED * step_y), RESIDUAL)
    legend = f"{result.rms_px:.2f} px rms; green: measured, magenta: not; yellow: residuals x {MAGNIFIED:.0f}"
    texts = [legend, *(reason.text for reason in result.reasons)]
    for number, text in enumerate(texts, start=1):
        plain = text.encode("ascii", "replace").decode()
        draw_text(canvas, plain, (TEXT_LEFT_PX, number * TEXT_STEP_PX), WHITE, 0.45)
    return canvas
