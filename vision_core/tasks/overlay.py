"""Draws into pictures what was seen in them."""

import math
from itertools import pairwise

import numpy as np

from vision_core.camera_model import CameraModel
from vision_core.field_model import painted_points
from vision_core.geometry import Bytes
from vision_core.opencv import Color, draw_circle, draw_line, draw_text
from vision_core.settings import Settings
from vision_core.types.colors import ColorTable
from vision_core.types.objects import BallSighting, RobotSighting, Sightings, Team

TEAM_COLORS: dict[Team, Color] = {Team.BLUE: (255, 160, 40), Team.YELLOW: (40, 230, 255)}
BALL_COLOR: Color = (0, 140, 255)
PAINT_COLOR: Color = (255, 80, 255)
POINTS_PER_LINE = 40
"""A lens bends lines."""
DARK: Color = (0, 0, 0)
BACKGROUND = 0.4


def draw_sightings(pixels: Bytes, seen: Sightings, camera: CameraModel, settings: Settings) -> Bytes:
    """A copy of a picture with every robot's outline, heading, team and id, every ball, and the field's lines.

    Lines beside the painted ones tell that the camera or the field's measures are wrong.
    """
    canvas = pixels.copy()
    for points in painted_points(settings.field, POINTS_PER_LINE):
        seen_px = camera.pixel_from_field(points).tolist()
        for start, end in pairwise(seen_px):
            if all(map(math.isfinite, (*start, *end))):
                draw_line(canvas, start, end, PAINT_COLOR)
    for robot in seen.robots:
        _draw_robot(canvas, robot, camera, settings)
    for ball in seen.balls:
        _draw_ball(canvas, ball, camera, settings)
    return canvas


def draw_classes(pixels: Bytes, table: ColorTable) -> Bytes:
    """What segmentation makes of a picture: every class in its typical color, the rest dark and grey."""
    classes = table.classes_of(pixels)
    grey = (pixels.mean(axis=2) * BACKGROUND).astype(np.uint8)
    drawn: Bytes = np.where(classes[..., None] > 0, table.mean_bgr[classes], grey[..., None])
    return drawn


def _draw_robot(canvas: Bytes, robot: RobotSighting, camera: CameraModel, settings: Settings) -> None:
    height, radius = settings.robots.height_m, settings.robots.radius_m
    color = TEAM_COLORS[robot.team]
    center = (robot.x_px, robot.y_px)
    radius_px = radius * camera.pixels_per_metre((robot.x_m, robot.y_m), height)
    _ring(canvas, center, radius_px, color)
    name = "?" if robot.id is None else str(robot.id)
    if robot.heading_rad is not None:
        ahead = np.array([robot.x_m, robot.y_m]) + radius * np.array(
            [math.cos(robot.heading_rad), math.sin(robot.heading_rad)]
        )
        x, y = camera.pixel_from_field(ahead, height)[0].tolist()
        draw_line(canvas, center, (x, y), DARK, 4)
        draw_line(canvas, center, (x, y), color, 2)
        name += f" {math.degrees(robot.heading_rad):+.0f} deg"
    _label(canvas, f"{robot.team} {name}", (center[0] + radius_px + 3, center[1] - 3), color)


def _draw_ball(canvas: Bytes, ball: BallSighting, camera: CameraModel, settings: Settings) -> None:
    radius = settings.ball.radius_m
    radius_px = radius * camera.pixels_per_metre((ball.x_m, ball.y_m), radius) + 3.0
    _ring(canvas, (ball.x_px, ball.y_px), radius_px, BALL_COLOR)
    _label(canvas, f"ball {ball.confidence:.2f}", (ball.x_px + radius_px + 3, ball.y_px + 4), BALL_COLOR)


def _ring(canvas: Bytes, center: tuple[float, float], radius_px: float, color: Color) -> None:
    draw_circle(canvas, center, radius_px, DARK, 3)
    draw_circle(canvas, center, radius_px, color, 1)


def _label(canvas: Bytes, text: str, place: tuple[float, float], color: Color) -> None:
    draw_text(canvas, text, place, color, scale=max(0.35, canvas.shape[1] / 3000.0))
