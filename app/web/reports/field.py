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
from vision_core.models.from_settings import mirror_of, robots_of
from vision_core.models.mirror import MAX_PX, MM_PER_M, Mirror
from vision_core.rtdb.infos import ServiceInfo
from vision_core.settings.schema import MirrorSettings, Settings
from vision_core.types.edges import EDGE_TYPES, EdgeType
from vision_core.types.objects import ObstacleSighting, RobotSighting, Team

STEPS = 24
"""Straight pieces by which a line or an outline is drawn in the picture, where lenses bend it; a multiple of 8, so that
a square's corners are among its points."""

Points = list[tuple[float, float]]


class FieldSegment(Report):
    """A straight edge that robots can see: a wall, a goal, a line or a limit of the field [m]."""

    x1_m: float
    y1_m: float
    x2_m: float
    y2_m: float
    kind: int
    """Code of its edge type."""
    solid: bool
    """true: it hides what is behind it, like a wall; false: it hides nothing, like a line."""


class FieldArc(Report):
    """A painted arc, anticlockwise from start to end."""

    x_m: float
    y_m: float
    radius_m: float
    start_rad: float
    end_rad: float


class EdgeTypeReport(Report):
    """What an edge of a view can be, and how the page draws it."""

    code: int
    """In ``kinds`` of a view; of a robot: code + its number, code alone when its number is not known."""
    numbers: int
    """Highest number of such a robot; 0: no robot."""
    meaning: str
    label: str
    """Written beside such an edge; a robot's number follows."""
    legend: str
    """Its word in the legend, which types may share; empty: not in the legend."""
    on_light: str
    """Color on a light background, #rrggbb."""
    on_dark: str


class RobotBody(Report):
    """The outline of a team's robots."""

    outline: Literal["circle", "square"]
    """A square turns with the heading; while the heading is unknown, its inscribed circle is drawn."""
    radius_m: float
    """Radius of the circle, or half the side of the square [m]."""


class MaskReport(Report):
    """A polygon in the picture in which nothing is looked for."""

    name: str
    points_px: list[tuple[float, float]]


class Field(Report):
    """The field's geometry, and who wears which marker.

    Field space: origin at the field's center, x along its length, y along its width, z up [m].
    """

    name: str
    length_m: float
    width_m: float
    line_width_m: float
    segments: list[FieldSegment]
    lines: list[tuple[float, float, float, float]]
    """Painted lines: x1, y1, x2, y2 of their center lines [m]."""
    arcs: list[FieldArc]
    robots: dict[str, RobotBody]
    """By team."""
    ball_radius_m: float
    numbers: int
    """Robots that may connect, per team."""
    marker_ids: dict[str, list[int]]
    """By team: the marker id of robot number 1, 2, ..."""
    edge_types: dict[str, EdgeTypeReport]
    """By name: nothing, wall, goal_blue, ..."""
    mirror_m: dict[str, list[float | None]]
    """By team, and by robot (``blue 3``) for those with a mirror of their own: distance on the floor at 0, 1, 2, ...
    pixels from the mirror's center [m]; null beyond the horizon."""
    painted_px: list[list[tuple[float, float]]]
    """Painted lines and arcs, projected into the picture by the camera model [px]."""
    masks: list[MaskReport]
    """Where nothing is looked for, in the running service."""
    coverage_m: list[tuple[float, float]]
    """Border of the part of the floor that the camera sees [m]; empty where it sees no floor at all."""


def field_from(service: ServiceInfo) -> Field:
    """The field of a running service."""
    settings = service.settings
    field = settings.field
    lines, arcs = field_lines(field)
    setup = CameraSetup.from_settings(settings)
    camera = setup.model
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
        edge_types={edge.kind.name.lower(): _edge_type(edge) for edge in EDGE_TYPES},
        mirror_m=_mirror_tables(settings.mirror),
        painted_px=[_visible(_in_picture(camera, points)) for points in painted_points(field, STEPS + 1)],
        masks=[MaskReport(name=mask.name, points_px=list(mask.points_px)) for mask in setup.settings.masks],
        coverage_m=[(x, y) for x, y in np.round(setup.seen_floor_m(STEPS), 3).tolist()],
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
        """Outlines of robots: STEPS points each [px], the first in the direction of the heading."""
        return self._seen([self._body(robot) for robot in robots], [self._robots[r.team].height_m for r in robots])

    def of_obstacles(self, obstacles: Sequence[ObstacleSighting]) -> list[Points]:
        """Outlines of obstacles: STEPS points each [px]."""
        circle = self._unit["circle"]
        return self._seen([(o.x_m, o.y_m) + o.radius_m * circle for o in obstacles], [0.0] * len(obstacles))

    def _body(self, robot: RobotSighting) -> Floats:
        """Points of a robot's outline [m], shape (STEPS, 2)."""
        body = self._robots[robot.team]
        unit = self._unit["circle" if robot.heading_rad is None else body.outline]
        points: Floats = (robot.x_m, robot.y_m) + body.radius_m * unit @ rotation(robot.heading_rad or 0.0).T
        return points

    def _seen(self, outlines_m: list[Floats], heights_m: list[float]) -> list[Points]:
        """Outlines at their heights, projected by one call."""
        if not outlines_m:
            return []
        points = _in_picture(self._camera, np.concatenate(outlines_m), np.repeat(heights_m, STEPS))
        return [points[start : start + STEPS] for start in range(0, len(points), STEPS)]


def _body(settings: Settings, team: Team) -> RobotBody:
    robots = robots_of(settings.robots, team)
    return RobotBody(outline=robots.outline, radius_m=robots.radius_m)


def _edge_type(edge: EdgeType) -> EdgeTypeReport:
    return EdgeTypeReport(
        code=int(edge.kind),
        numbers=len(edge.codes) - 1,
        meaning=edge.meaning,
        label=edge.label,
        legend=edge.legend,
        on_light=edge.on_light,
        on_dark=edge.on_dark,
    )


def _in_picture(camera: CameraModel, points_m: Floats, height_m: float | Floats = 0.0) -> Points:
    """Points of the field in the picture, rounded to 0.1 px; nan where the camera cannot see them."""
    return [(x, y) for x, y in np.round(camera.pixel_from_field(points_m, height_m), 1).tolist()]


def _visible(points_px: Points) -> Points:
    return [(x, y) for x, y in points_px if math.isfinite(x)]


def _mirror_tables(mirrors: MirrorSettings) -> dict[str, list[float | None]]:
    teams = {team.value: _mirror_table(mirror_of(mirrors, team)) for team in Team}
    return teams | {robot: _mirror_table(Mirror(own.a, own.b, own.c)) for robot, own in mirrors.robots.items()}


def _mirror_table(mirror: Mirror) -> list[float | None]:
    metres = mirror.mm_from_px(np.arange(MAX_PX + 1, dtype=np.float64)) / MM_PER_M
    return [round(value, 4) if math.isfinite(value) else None for value in metres.tolist()]
