"""The field as the page draws it: on the floor, in the picture, and in the mirror's pixels."""

import math
from collections.abc import Sequence
from typing import Literal

import numpy as np

from app.web.reports.base import Report
from vision_core.geometry import Floats, rotation
from vision_core.models.camera import CameraModel
from vision_core.models.camera_setup import CameraSetup
from vision_core.models.field import field_lines, field_segments, painted_points
from vision_core.models.from_settings import mirror_from, robots_of
from vision_core.models.mirror import MAX_PX
from vision_core.rtdb.infos import ServiceInfo
from vision_core.settings.schema import Settings
from vision_core.types.field import EdgeKind
from vision_core.types.objects import ObstacleSighting, RobotSighting, Team

MM_PER_M = 1000.0
STEPS = 24
"""Pieces of a line or outline in the picture, where lenses bend them; a multiple of 8, for a square's corners."""

Points = list[tuple[float, float]]


class FieldSegment(Report):
    """A straight piece of what makes edges [m]."""

    x1_m: float
    y1_m: float
    x2_m: float
    y2_m: float
    kind: int
    """A code of ``kinds``."""
    solid: bool
    """Solid things hide what is behind them; virtual limits are edges but hide nothing."""


class FieldArc(Report):
    """A painted arc, anticlockwise from start to end."""

    x_m: float
    y_m: float
    radius_m: float
    start_rad: float
    end_rad: float


class RobotBody(Report):
    """The outline of a team's robots."""

    outline: Literal["circle", "square"]
    """A square is turned by the heading; where that is not known, the circle in it is meant."""
    radius_m: float
    """Of the circle, or half the side of the square."""


class Field(Report):
    """Everything about the field that stays the same while the service runs.

    Field space: origin at the field's center, x along its length, y along its width, z up [m].
    """

    name: str
    length_m: float
    width_m: float
    line_width_m: float
    segments: list[FieldSegment]
    lines: list[tuple[float, float, float, float]]
    """Painted lines: x1, y1, x2, y2 of their middles [m]."""
    arcs: list[FieldArc]
    robots: dict[str, RobotBody]
    """By team."""
    ball_radius_m: float
    numbers: int
    """Robots per team that may connect."""
    marker_ids: dict[str, list[int]]
    """By team: the marker that number 1, 2, ... wears."""
    kinds: dict[str, int]
    """What an edge can be; a robot's code is its team's plus its number, 0 for one without."""
    mirror_m: list[float | None]
    """Distance on the floor of 0, 1, 2, ... mirror pixels [m]; null beyond the horizon."""
    painted_px: list[list[tuple[float, float]]]
    """The painted lines and arcs as the camera model sees them in the picture [px]."""


def field_from(service: ServiceInfo) -> Field:
    """The field of a running service."""
    settings = service.settings
    field = settings.field
    lines, arcs = field_lines(field)
    camera = CameraSetup.from_settings(settings).model
    return Field(
        name=field.name,
        length_m=field.length_m,
        width_m=field.width_m,
        line_width_m=field.line_width_m,
        segments=[
            FieldSegment(x1_m=s.x1_m, y1_m=s.y1_m, x2_m=s.x2_m, y2_m=s.y2_m, kind=s.kind, solid=s.solid)
            for s in field_segments(field, settings.match.blue_defends)
        ],
        lines=list(lines),
        arcs=[
            FieldArc(x_m=a.x_m, y_m=a.y_m, radius_m=a.radius_m, start_rad=a.start_rad, end_rad=a.end_rad) for a in arcs
        ],
        robots={team.value: _body(settings, team) for team in Team},
        ball_radius_m=settings.ball.radius_m,
        numbers=settings.match.numbers,
        marker_ids={"blue": list(settings.match.blue_ids), "yellow": list(settings.match.yellow_ids)},
        kinds={kind.name.lower(): int(kind) for kind in EdgeKind},
        mirror_m=_mirror_table(settings),
        painted_px=[_visible(_in_picture(camera, points)) for points in painted_points(field, STEPS + 1)],
    )


class Outlines:
    """Draws into the picture: robots' bodies at the height of their markers, obstacles' circles on the floor."""

    def __init__(self, settings: Settings) -> None:
        self._camera = CameraSetup.from_settings(settings).model
        self._robots = {team: robots_of(settings.robots, team) for team in Team}
        angles: Floats = np.linspace(0.0, math.tau, STEPS, endpoint=False)
        circle: Floats = np.column_stack([np.cos(angles), np.sin(angles)])
        self._unit = {"circle": circle, "square": circle / np.abs(circle).max(axis=1, keepdims=True)}

    def of_robots(self, robots: Sequence[RobotSighting]) -> list[Points]:
        """Per robot STEPS points [px], the first one where its heading points to."""
        return self._seen([self._body(robot) for robot in robots], [self._robots[r.team].height_m for r in robots])

    def of_obstacles(self, obstacles: Sequence[ObstacleSighting]) -> list[Points]:
        """Per obstacle STEPS points [px]."""
        circle = self._unit["circle"]
        return self._seen([(o.x_m, o.y_m) + o.radius_m * circle for o in obstacles], [0.0] * len(obstacles))

    def _body(self, robot: RobotSighting) -> Floats:
        """Points round a robot [m], shape (STEPS, 2)."""
        body = self._robots[robot.team]
        unit = self._unit["circle" if robot.heading_rad is None else body.outline]
        points: Floats = (robot.x_m, robot.y_m) + body.radius_m * unit @ rotation(robot.heading_rad or 0.0).T
        return points

    def _seen(self, outlines_m: list[Floats], heights_m: list[float]) -> list[Points]:
        """Outlines at their heights, all in one go."""
        if not outlines_m:
            return []
        points = _in_picture(self._camera, np.concatenate(outlines_m), np.repeat(heights_m, STEPS))
        return [points[start : start + STEPS] for start in range(0, len(points), STEPS)]


def _body(settings: Settings, team: Team) -> RobotBody:
    robots = robots_of(settings.robots, team)
    return RobotBody(outline=robots.outline, radius_m=robots.radius_m)


def _in_picture(camera: CameraModel, points_m: Floats, height_m: float | Floats = 0.0) -> Points:
    """Points of the field in the picture, to a tenth of a pixel; nan where no camera sees."""
    return [(x, y) for x, y in np.round(camera.pixel_from_field(points_m, height_m), 1).tolist()]


def _visible(points_px: Points) -> Points:
    return [(x, y) for x, y in points_px if math.isfinite(x)]


def _mirror_table(settings: Settings) -> list[float | None]:
    metres = mirror_from(settings).mm_from_px(np.arange(MAX_PX + 1, dtype=np.float64)) / MM_PER_M
    return [round(value, 4) if math.isfinite(value) else None for value in metres.tolist()]
