"""What changes with every frame: the ball with its trail, and what the robots see."""

from collections import deque
from collections.abc import Iterable, Mapping

import numpy as np
import viser
from numpy.typing import NDArray

from app.web.view3d.solids import circle_m
from vision_core.geometry import Floats, rotation
from vision_core.models.mirror import MAX_PX, MM_PER_M, Mirror
from vision_core.types.edges import EDGE_TYPES
from vision_core.types.objects import Team
from vision_core.types.regions import BodyContour
from vision_core.types.tracks import BallTrack, RobotTrack
from vision_core.types.views import ViewSnapshot

BALL_RGB = (250, 120, 30)
HIDDEN_RGB = (150, 110, 80)
"""A ball that the camera does not see: its place is predicted."""
HORIZON_RGB = (170, 120, 220)
CONTOUR_RGB = (20, 20, 20)
NOTHING_PX = 255
RAY_HEIGHT_M = 0.02
"""Rays and edges are drawn this high over the floor."""
POINT_M = 0.022
TRAIL_POINTS = 40
DIRECTIONS = 360
PARKED = np.zeros((1, 2, 3), dtype=np.float32)
"""Lines of length 0 in place of none."""
NO_COLORS = np.zeros((1, 2, 3), dtype=np.uint8)
Robot = tuple[Team, int]


class Ball3D:
    """The ball and where it was in the last seconds."""

    def __init__(self, scene: viser.SceneApi, radius_m: float) -> None:
        self._radius_m = radius_m
        self._trail: deque[tuple[float, float]] = deque(maxlen=TRAIL_POINTS)
        self._ball = scene.add_icosphere("/ball/ball", radius_m, BALL_RGB, visible=False)
        self._ghost = scene.add_icosphere("/ball/predicted", radius_m, HIDDEN_RGB, opacity=0.5, visible=False)
        self._line = scene.add_line_segments("/ball/trail", PARKED, BALL_RGB, thickness=0.008)

    def show(self, ball: BallTrack | None) -> None:
        """Move the ball, or hide it."""
        for node, visible in (
            (self._ball, ball is not None and not ball.hidden),
            (self._ghost, ball is not None and ball.hidden),
        ):
            if node.visible != visible:
                node.visible = visible
            if ball is not None:
                node.position = (ball.x_m, ball.y_m, self._radius_m)
        if ball is None:
            self._trail.clear()
        else:
            self._trail.append((ball.x_m, ball.y_m))
        points = np.array(self._trail, dtype=np.float32).reshape(-1, 2)
        line = np.column_stack([points, np.full(len(points), self._radius_m, dtype=np.float32)])
        self._line.points = np.stack([line[:-1], line[1:]], axis=1) if len(line) > 1 else PARKED


class Contours3D:
    """The parts of the floor that the camera cannot see for the robots."""

    def __init__(self, scene: viser.SceneApi) -> None:
        self._lines = scene.add_line_segments("/contours", PARKED, CONTOUR_RGB, thickness=0.004)

    def show(self, bodies: Iterable[BodyContour]) -> None:
        """Draw their outlines."""
        outlines = [np.array(body.outline_m, dtype=np.float32) for body in bodies]
        if not outlines:
            self._lines.points = PARKED
            return
        floor = np.concatenate(outlines)
        after = np.concatenate([np.roll(outline, -1, axis=0) for outline in outlines])
        lines = np.full((len(floor), 2, 3), RAY_HEIGHT_M, dtype=np.float32)
        lines[:, 0, :2], lines[:, 1, :2] = floor, after
        self._lines.points = lines


class Sights3D:
    """The edges that all robots see as points, and the rays and the horizon of the selected robot."""

    def __init__(self, scene: viser.SceneApi) -> None:
        self._colors = _colors_by_code()
        directions = np.deg2rad(np.arange(DIRECTIONS))
        self._unit: Floats = np.column_stack([np.cos(directions), np.sin(directions)])
        empty, black = np.zeros((1, 3), dtype=np.float32), np.zeros((1, 3), dtype=np.uint8)
        self._edges = scene.add_point_cloud(
            "/edges", empty, black, point_size=POINT_M, point_shape="circle", precision="float32"
        )
        self._rays = scene.add_line_segments("/rays", PARKED, NO_COLORS, thickness=0.004)
        self._horizon = scene.add_line_segments("/horizon", PARKED, HORIZON_RGB, thickness=0.012)

    def show(
        self,
        views: Iterable[ViewSnapshot],
        robots: Mapping[Robot, RobotTrack],
        mirrors: Mapping[Robot, Mirror],
        selected: Robot | None,
    ) -> None:
        """Draw the views of robots by team and number. mirrors: of each robot, whose pixels its view has."""
        all_px = np.arange(MAX_PX + 1, dtype=np.float64)
        metres = {robot: mirrors[robot].mm_from_px(all_px) / MM_PER_M for robot in robots if robot in mirrors}
        points, colors, rays = [], [], (PARKED, NO_COLORS)
        for view in views:
            robot = robots.get((view.team, view.number))
            if robot is None:
                continue
            ends, kinds = self._ends(view, robot, metres[view.team, view.number])
            points.append(ends)
            colors.append(self._colors[kinds])
            if (view.team, view.number) == selected:
                rays = self._lines(robot, ends, kinds)
        self._edges.points = np.concatenate(points) if points else np.zeros((1, 3), dtype=np.float32)
        self._edges.colors = np.concatenate(colors) if colors else np.zeros((1, 3), dtype=np.uint8)
        self._rays.points, self._rays.colors = rays
        chosen = robots.get(selected) if selected else None
        self._horizon.points = self._ring(chosen, metres[selected]) if selected and chosen else PARKED

    def _ends(
        self, view: ViewSnapshot, robot: RobotTrack, metres: Floats
    ) -> tuple[NDArray[np.float32], NDArray[np.uint8]]:
        """Where the edges are that a robot sees, shape (n, 3), and their codes, shape (n,)."""
        px = np.frombuffer(view.px, dtype=np.uint8)
        distances = np.where(px < NOTHING_PX, metres[np.minimum(px, MAX_PX)], np.inf)
        seen = np.isfinite(distances)
        floor = (distances[seen, None] * self._unit[seen]) @ rotation(robot.heading_rad).T + (robot.x_m, robot.y_m)
        ends = np.column_stack([floor, np.full(len(floor), RAY_HEIGHT_M)]).astype(np.float32)
        return ends, np.frombuffer(view.kinds, dtype=np.uint8)[seen]

    def _lines(
        self, robot: RobotTrack, ends: NDArray[np.float32], kinds: NDArray[np.uint8]
    ) -> tuple[NDArray[np.float32], NDArray[np.uint8]]:
        """A line from a robot to each edge, shape (n, 2, 3), and the colors of both ends."""
        if not len(ends):
            return PARKED, NO_COLORS
        start = np.array([robot.x_m, robot.y_m, RAY_HEIGHT_M], dtype=np.float32)
        starts = np.broadcast_to(start, ends.shape)
        return np.stack([starts, ends], axis=1), np.repeat(self._colors[kinds][:, None, :], 2, axis=1)

    def _ring(self, robot: RobotTrack, metres: Floats) -> NDArray[np.float32]:
        """The farthest circle on the floor that the mirror shows round a robot."""
        finite = metres[np.isfinite(metres)]
        if not len(finite):
            return PARKED
        ring = circle_m(float(finite[-1]), (robot.x_m, robot.y_m))
        closed = np.column_stack([ring, np.full(len(ring), RAY_HEIGHT_M)]).astype(np.float32)
        return np.stack([closed, np.roll(closed, -1, axis=0)], axis=1)


def _colors_by_code() -> NDArray[np.uint8]:
    """Red, green, blue of every code of an edge; shape (256, 3)."""
    colors = np.zeros((256, 3), dtype=np.uint8)
    for edge in EDGE_TYPES:
        rgb = [int(edge.on_dark[start : start + 2], 16) for start in (1, 3, 5)]
        colors[edge.codes.start : edge.codes.stop] = rgb
    return colors
