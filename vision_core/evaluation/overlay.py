"""Draws sightings, field lines and color classes into pictures."""

import math
from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from vision_core.geometry import Bytes, Floats, rotation
from vision_core.models.camera import CameraModel
from vision_core.models.field import painted_points
from vision_core.models.from_settings import robots_of
from vision_core.native.opencv import Color, draw_circle, draw_line, draw_text, text_size
from vision_core.settings.schema import Settings, TeamRobotSettings
from vision_core.types.colors import ColorTable
from vision_core.types.objects import BallSighting, ObstacleSighting, RobotSighting, Sightings, Team

TEAM_COLORS: dict[Team, Color] = {Team.BLUE: (255, 160, 40), Team.YELLOW: (40, 230, 255)}
BALL_COLOR: Color = (0, 140, 255)
OBSTACLE_COLOR: Color = (200, 80, 200)
PAINT_COLOR: Color = (255, 80, 255)
POINTS_PER_LINE = 40
"""Points between which a field line is drawn straight; a lens bends it."""
MIN_TEXT = 0.45
GAP_PX = 3.0
DARK: Color = (0, 0, 0)
BACKGROUND = 0.4


def draw_sightings(
    pixels: Bytes, seen: Sightings, camera: CameraModel, settings: Settings, obstacles: Sequence[ObstacleSighting] = ()
) -> Bytes:
    """A copy of a picture with every robot's outline, heading, team and id, every ball and obstacle, and the lines.

    Lines that are drawn beside the painted ones show that the camera or the field's measures are wrong.
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
    for thing in obstacles:
        radius_px = thing.radius_m * camera.pixels_per_metre((thing.x_m, thing.y_m))
        _ring(canvas, (thing.x_px, thing.y_px), radius_px, OBSTACLE_COLOR)
        _label(canvas, "?", (thing.x_px - radius_px, thing.x_px + radius_px), thing.y_px, OBSTACLE_COLOR)
    return canvas


def draw_classes(pixels: Bytes, table: ColorTable) -> Bytes:
    """The color class of every pixel: each class in its mean color, the rest dark and grey."""
    classes = table.classes_of(pixels)
    grey = (pixels.mean(axis=2) * BACKGROUND).astype(np.uint8)
    drawn: Bytes = np.where(classes[..., None] > 0, table.mean_bgr[classes], grey[..., None])
    return drawn


def _draw_robot(canvas: Bytes, robot: RobotSighting, camera: CameraModel, settings: Settings) -> None:
    body = robots_of(settings.robots, robot.team)
    color = TEAM_COLORS[robot.team]
    place = np.array([robot.x_m, robot.y_m])
    outline = camera.pixel_from_field(place + _outline(body, robot.heading_rad), body.height_m)
    if not np.isfinite(outline).all():
        return
    _closed_line(canvas, outline)
    _closed_line(canvas, outline, color)
    name = "?" if robot.id is None else str(robot.id)
    if robot.heading_rad is not None:
        ahead = place + body.radius_m * np.array([math.cos(robot.heading_rad), math.sin(robot.heading_rad)])
        x, y = camera.pixel_from_field(ahead, body.height_m)[0].tolist()
        draw_line(canvas, (robot.x_px, robot.y_px), (x, y), DARK, 4)
        draw_line(canvas, (robot.x_px, robot.y_px), (x, y), color, 2)
        name += f" {math.degrees(robot.heading_rad):+.0f} deg"
    sides = float(outline[:, 0].min()), float(outline[:, 0].max())
    _label(canvas, f"{robot.team} {name}", sides, robot.y_px - 3, color)


def _outline(body: TeamRobotSettings, heading_rad: float | None) -> Floats:
    """Points round a body's center [m], shape (n, 2); a square whose heading is not known is drawn as its circle."""
    if body.outline == "square" and heading_rad is not None:
        corners = np.array([[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]]) * body.radius_m
        return np.asarray(corners @ rotation(heading_rad).T)
    angles = np.arange(POINTS_PER_LINE) * (math.tau / POINTS_PER_LINE)
    return body.radius_m * np.column_stack([np.cos(angles), np.sin(angles)])


def _closed_line(canvas: Bytes, points_px: Floats, color: Color | None = None) -> None:
    """Lines through points and back to the first: a dark rim, or a color on it."""
    corners = points_px.tolist()
    for start, end in pairwise([*corners, corners[0]]):
        draw_line(canvas, start, end, color or DARK, 1 if color else 3)


def _draw_ball(canvas: Bytes, ball: BallSighting, camera: CameraModel, settings: Settings) -> None:
    radius = settings.ball.radius_m
    radius_px = radius * camera.pixels_per_metre((ball.x_m, ball.y_m), radius) + 3.0
    _ring(canvas, (ball.x_px, ball.y_px), radius_px, BALL_COLOR)
    sides = ball.x_px - radius_px, ball.x_px + radius_px
    _label(canvas, f"ball {ball.confidence:.2f}", sides, ball.y_px + 4, BALL_COLOR)


def _ring(canvas: Bytes, center: tuple[float, float], radius_px: float, color: Color) -> None:
    draw_circle(canvas, center, radius_px, DARK, 3)
    draw_circle(canvas, center, radius_px, color, 1)


def _label(canvas: Bytes, text: str, sides_px: tuple[float, float], bottom_px: float, color: Color) -> None:
    """Write a text to the right of an object, or to its left at the picture's right edge."""
    height, width, _ = canvas.shape
    scale = max(MIN_TEXT, width / 3000.0)
    long, high = text_size(text, scale)
    x = sides_px[1] + GAP_PX if sides_px[1] + GAP_PX + long < width else sides_px[0] - GAP_PX - long
    draw_text(canvas, text, (x, min(max(bottom_px, high + GAP_PX), height - GAP_PX)), color, scale)
