"""The paper's figures 3, 4, 6 and 7 of one world, as pictures: blue green red, shape (height, width, 3)."""

import math
from itertools import pairwise

import numpy as np

from vision_core.capture.synthetic.world import Snapshot
from vision_core.client.panorama import COLORS, draw_panorama
from vision_core.fidelity.causes import Cause
from vision_core.fidelity.experiment import Comparison
from vision_core.fidelity.reports import NOTHING, Report
from vision_core.geometry import Bytes, Floats
from vision_core.models.camera import CameraModel
from vision_core.models.mirror import MM_PER_M, Mirror
from vision_core.native.opencv import Color, draw_circle, draw_line, draw_text
from vision_core.onboard.camera import OnboardCamera

BOLD: Color = (40, 40, 255)
INK: Color = (255, 255, 255)
"""Of texts, which have a dark outline."""
GRID: Color = (215, 215, 215)
WHITE = 255
JOINED_M = 0.12
"""Edges of neighboring directions that are nearer to each other are joined by a bold line."""
CHART_PX = (640, 480)
LEFT_PX, RIGHT_PX, TOP_PX, MIDDLE_PX, BOTTOM_PX = 52, 16, 30, 330, 420
STEP_PX, STEP_DEG = 20, 45
MARKS: dict[str, Color] = {"agrees": (90, 220, 90), "explained": (0, 220, 255), "unexplained": (255, 60, 255)}
"""Of directions in the on-board picture."""
TITLE_PX, GAP_PX = 26, 6


def figure_3(picture: Bytes, camera: CameraModel, snapshot: Snapshot, own: int, told: Report, mirror: Mirror) -> Bytes:
    """The ceiling camera's picture; bold lines are the nearest edges that robot A, the one of row own, is told."""
    canvas = picture.copy()
    x, y, heading = snapshot.robots[own, :3].tolist()
    angles = heading + np.arange(len(told.letters)) * (math.tau / len(told.letters))
    mm = np.where(told.letters == NOTHING, np.nan, mirror.mm_from_px(told.radii_px))
    points = np.column_stack([x + mm / MM_PER_M * np.cos(angles), y + mm / MM_PER_M * np.sin(angles)])
    pixels = camera.pixel_from_field(np.nan_to_num(points))
    for i, j in pairwise([*range(len(points)), 0]):
        if math.dist(points[i], points[j]) < JOINED_M:
            draw_line(canvas, tuple(pixels[i]), tuple(pixels[j]), BOLD, 3)
    column, row = camera.pixel_from_field(np.array([[x, y]]))[0].tolist()
    draw_text(canvas, "A", (column + 12, row - 12), INK, 0.8)
    return canvas


def figure_4(told: Report, horizon_px: float) -> Bytes:
    """The edge array: distance by direction above, type by direction below."""
    width, height = CHART_PX
    canvas = np.full((height, width, 3), WHITE, dtype=np.uint8)
    most = math.ceil(horizon_px / STEP_PX) * STEP_PX
    columns = LEFT_PX + (width - LEFT_PX - RIGHT_PX) * np.arange(len(told.letters) + 1) / len(told.letters)
    for level in range(0, most + 1, STEP_PX):
        row = MIDDLE_PX - (MIDDLE_PX - TOP_PX) * level / most
        draw_line(canvas, (LEFT_PX, row), (width - RIGHT_PX, row), GRID)
        draw_text(canvas, str(level), (LEFT_PX - 32, row + 4), INK, 0.4)
    for degrees in range(0, 361, STEP_DEG):
        column = LEFT_PX + (width - LEFT_PX - RIGHT_PX) * degrees / 360.0
        draw_line(canvas, (column, TOP_PX), (column, BOTTOM_PX), GRID)
        draw_text(canvas, str(degrees), (column - 10, BOTTOM_PX + 18), INK, 0.4)
    for i, letter in enumerate(told.letters.tolist()):
        left, right = columns[i], columns[i + 1]
        red, green, blue = COLORS[letter]
        canvas[MIDDLE_PX + 20 : BOTTOM_PX, int(left) : int(right) + 1] = blue, green, red
        row = MIDDLE_PX - (MIDDLE_PX - TOP_PX) * min(float(told.px[i]), most) / most
        draw_line(canvas, (left, row), (right, row), BOLD, 2)
    draw_text(canvas, "distance [px]", (LEFT_PX, TOP_PX - 10), INK, 0.45)
    draw_text(canvas, "type of the edge; direction [deg]", (LEFT_PX, height - 14), INK, 0.45)
    return canvas


def figure_6(told: Report, mirror: Mirror) -> Bytes:
    """The simulated on-board picture."""
    radii = np.where(np.isfinite(told.px), told.px, mirror.horizon_px)
    ball = (
        None if told.ball.hidden else (float(told.ball.px), float(told.ball.direction_deg), float(told.ball.size_deg))
    )
    return np.ascontiguousarray(draw_panorama(radii, "".join(told.letters), ball, mirror)[..., ::-1])


def marked(picture: Bytes, camera: OnboardCamera, comparison: Comparison) -> Bytes:
    """The on-board picture with what was told of every direction: green where both agree, yellow where a cause explains
    the difference, magenta where none does."""
    canvas = picture.copy()
    told, n = comparison.told, len(comparison.causes)
    angles = np.arange(n, dtype=np.float64) * (math.tau / n)
    radii = np.where(np.isfinite(told.radii_px), told.radii_px, camera.mirror.horizon_px)
    for place, cause in zip(_places(camera, radii, angles), comparison.causes, strict=True):
        mark = "agrees" if cause is None else "unexplained" if cause is Cause.UNEXPLAINED else "explained"
        draw_circle(canvas, place, 0.8, MARKS[mark])
    return canvas


def _places(camera: OnboardCamera, radii: Floats, angles: Floats) -> list[tuple[float, float]]:
    return [(x, y) for x, y in camera.pixel_from_px(radii * np.cos(angles), radii * np.sin(angles)).tolist()]


def side_by_side(titled: dict[str, Bytes], columns: int = 2) -> Bytes:
    """Pictures with their titles above them, row by row, each in a frame of the largest one's size."""
    height = max(len(picture) for picture in titled.values()) + TITLE_PX
    width = max(picture.shape[1] for picture in titled.values())
    rows = math.ceil(len(titled) / columns)
    canvas = np.full((rows * (height + GAP_PX), columns * (width + GAP_PX), 3), WHITE, dtype=np.uint8)
    for number, (title, picture) in enumerate(titled.items()):
        top, left = number // columns * (height + GAP_PX), number % columns * (width + GAP_PX)
        draw_text(canvas, title, (left + 4, top + 18), INK, 0.5)
        down, aside = (height - TITLE_PX - len(picture)) // 2 + TITLE_PX, (width - picture.shape[1]) // 2
        canvas[top + down : top + down + len(picture), left + aside : left + aside + picture.shape[1]] = picture
    return canvas


def doubled(picture: Bytes, times: int) -> Bytes:
    """A picture with every pixel so many times as wide and high."""
    return picture.repeat(times, axis=0).repeat(times, axis=1)
