"""A world in, the views of all its robots out: one compiled call, into preallocated memory."""

import math
from typing import NamedTuple

import numpy as np

from vision_core.geometry import Bytes, Floats, frozen
from vision_core.models.field import accepted_half_extent, field_segments
from vision_core.models.from_settings import robots_of
from vision_core.native.kernels import kernel
from vision_core.settings.schema import Settings
from vision_core.types.edges import EdgeKind, edge_type_of
from vision_core.types.objects import Team
from vision_core.types.tables import DIRECTIONS, MAX_NUMBERS, TEAM_NUMBER, TEAMS, Table, WorldTable
from vision_core.types.views import BallView, RobotView
from vision_core.views.ball import visible_fraction
from vision_core.views.outlines import MAX_OUTLINES, OUTLINE, Integers, Row, collect_outlines
from vision_core.views.rays import Rays
from vision_core.views.splat import nearest_edges, turn_rays

VIEWERS = len(TEAMS) * MAX_NUMBERS
"""A viewer is a team's number; its index in the tables is 16 * its team's number + its own number - 1."""
GRIDS = (DIRECTIONS, 2 * DIRECTIONS, 4 * DIRECTIONS)
"""Possible numbers of rays of a view, evenly spaced; ray 0 is straight ahead."""
MAX_RAYS = GRIDS[-1]
FIRST_KIND = {Team.BLUE: EdgeKind.ROBOT_BLUE, Team.YELLOW: EdgeKind.ROBOT_YELLOW}

VIEWER = np.dtype(
    [
        ("robot", np.int32), ("overlap", np.int32), ("first_ray", np.int64), ("ball_visible", np.float64),
        ("ball_m", np.float64), ("ball_direction_deg", np.float64), ("ball_size_deg", np.float64),
    ]
)  # fmt: skip
"""What a viewer sees, apart from its rays. robot: its row in the world, -1: not there; overlap: another outline
contains its center; first_ray: index of its ray 0 in the arrays of ViewBuffers; ball_visible: fraction of the ball,
0: hidden or unknown; ball_m, ball_direction_deg, ball_size_deg: see ``BallView``."""


class StaticScene(NamedTuple):
    """What does not change between worlds: the field, and the robots' outlines and numbers."""

    segments_m: Floats
    """x1 y1 x2 y2, solid ones first, shape (s, 4)."""
    segment_kinds: Bytes
    """EdgeKind of each segment, shape (s,)."""
    solid: int
    """How many segments are solid."""
    limit_m: Floats
    """Half extent of the area from which virtual limits are seen, shape (2,)."""
    kind_of_id: Bytes
    """EdgeKind of a team's robot by 1 + its id, shape (2, 257)."""
    viewer_of_id: Integers
    """Viewer of a team's robot by its id, -1 for none, shape (2, 256)."""
    team_radius_m: Floats
    """Of each team's outline: radius, or half the side; shape (2,)."""
    team_square: Integers
    """Whether each team's outline is a square, shape (2,)."""
    r_min_m: Floats
    """Nearest distance reported to each team, shape (2,)."""
    ball_radius_m: float
    ray_x: Floats
    """Unit vectors of the rays of each grid in robot space, shape (3, MAX_RAYS)."""
    ray_y: Floats


class ViewBuffers(NamedTuple):
    """Memory of the views: ``rays`` is input, ``viewers``, ``distances_m`` and ``kinds`` are output."""

    rays: Integers
    """How many rays each viewer's view has, one of GRIDS; shape (VIEWERS,)."""
    viewers: Table
    """VIEWER, shape (VIEWERS,)."""
    distances_m: Floats
    """Nearest edge of each ray, inf for nothing: viewer after viewer, each from its first_ray on."""
    kinds: Bytes
    """EdgeKind of each ray, in the same order."""
    outlines: Table
    """Scratch: OUTLINE, shape (MAX_OUTLINES,)."""
    ux: Floats
    """Scratch: unit vectors of one view's rays, shape (MAX_RAYS,)."""
    uy: Floats
    hidden: Floats
    """Scratch of ``visible_fraction``."""


@kernel
def render_views(world: Table, scene: StaticScene, buffers: ViewBuffers) -> None:
    """Fill in the view of every robot of a world (WORLD, shape (1,)) that has a number.

    Of two robots with the same id the first one has the view; a robot without a finite pose has none.
    """
    outlines, viewers = buffers.outlines, buffers.viewers
    count = collect_outlines(world, scene.kind_of_id, scene.team_radius_m, scene.team_square, outlines)
    for index in range(VIEWERS):
        viewers[index].robot = -1
    first_ray = 0
    for own in range(world[0].counts[0]):
        # Whose view is it?
        robot = world[0].robots[own]
        marker = robot.id
        index = scene.viewer_of_id[robot.team, marker] if 0 <= marker < 256 else -1
        if index < 0 or viewers[index].robot >= 0 or not math.isfinite(robot.x_m + robot.y_m + robot.heading_rad):
            continue
        # Its rays, in field space, and their place in the arrays of all viewers.
        ray_count = buffers.rays[index]
        viewers[index].robot, viewers[index].first_ray = own, first_ray
        rays = Rays(
            robot.heading_rad,
            buffers.ux[:ray_count],
            buffers.uy[:ray_count],
            buffers.distances_m[first_ray : first_ray + ray_count],
            buffers.kinds[first_ray : first_ray + ray_count],
        )
        first_ray += ray_count
        grid = 0 if ray_count == 360 else 1 if ray_count == 720 else 2
        turn_rays(scene.ray_x[grid], scene.ray_y[grid], outlines[own].cos, outlines[own].sin, rays.ux, rays.uy)
        # Its edges: from outside of the limits, only solid segments are visible.
        inside = abs(robot.x_m) <= scene.limit_m[0] and abs(robot.y_m) <= scene.limit_m[1]
        viewers[index].overlap = nearest_edges(
            own, outlines, count, scene.segments_m, scene.segment_kinds,
            len(scene.segments_m) if inside else scene.solid, scene.r_min_m[robot.team], rays,
        )  # fmt: skip
        viewers[index].ball_visible = 0.0
        if world[0].counts[1] > 0:
            _see_ball(world, own, count, scene, buffers, viewers[index])


@kernel
def _see_ball(world: Table, own: int, count: int, scene: StaticScene, buffers: ViewBuffers, viewer: Row) -> None:
    """Fill in how a viewer sees the ball."""
    ball, robot = world[0].balls[0], world[0].robots[own]
    radius = scene.ball_radius_m
    viewer.ball_visible = visible_fraction(
        own, ball.x_m, ball.y_m, radius, buffers.outlines, count, scene.segments_m[: scene.solid], buffers.hidden
    )
    dx, dy = ball.x_m - robot.x_m, ball.y_m - robot.y_m
    distance = math.sqrt(dx * dx + dy * dy)
    viewer.ball_m = distance
    viewer.ball_size_deg = 180.0 if distance <= radius else math.degrees(2.0 * math.asin(radius / distance))
    direction = math.degrees(math.atan2(dy, dx) - robot.heading_rad) % 360.0
    viewer.ball_direction_deg = 0.0 if direction >= 360.0 else direction  # the remainder of -1e-17 rounds to 360


class ViewRenderer:
    """Computes the views of all robots of a field. Built once per settings; keeps no state between worlds."""

    def __init__(self, settings: Settings) -> None:
        self.scene = static_scene_from(settings)
        self.buffers = ViewBuffers(
            rays=np.full(VIEWERS, GRIDS[0]),
            viewers=np.zeros(VIEWERS, dtype=VIEWER),
            distances_m=np.empty(VIEWERS * MAX_RAYS),
            kinds=np.empty(VIEWERS * MAX_RAYS, dtype=np.uint8),
            outlines=np.zeros(MAX_OUTLINES, dtype=OUTLINE),
            ux=np.empty(MAX_RAYS),
            uy=np.empty(MAX_RAYS),
            hidden=np.empty((2, len(self.scene.segments_m) + 4 * MAX_OUTLINES)),
        )
        self.buffers.viewers["robot"] = -1

    def render(self, world: WorldTable) -> None:
        """Fill ``buffers`` with the views of a world's robots."""
        render_views(world.whole, self.scene, self.buffers)

    def view(self, world: WorldTable, team: Team, number: int) -> RobotView | None:
        """A robot's view of the world that was rendered last, as a record; None when the robot is not there."""
        if not 1 <= number <= MAX_NUMBERS:
            return None
        index = viewer_index(team, number)
        robot, overlap, start, visible, ball_m, direction_deg, size_deg = self.buffers.viewers[index].tolist()
        if robot < 0:
            return None
        rays = slice(start, start + int(self.buffers.rays[index]))
        row = world.whole[0]
        return RobotView(
            team=team,
            number=number,
            at=row["at"].item(),
            frame_number=row["frame_number"].item(),
            distances_m=frozen(self.buffers.distances_m[rays].copy()),
            kinds=frozen(self.buffers.kinds[rays].copy()),
            ball=BallView(ball_m, direction_deg, size_deg, visible < 1.0) if visible > 0.0 else None,
            overlap=bool(overlap),
        )


def viewer_index(team: Team, number: int) -> int:
    """Index of a team's number 1..16 in the tables."""
    return TEAM_NUMBER[team] * MAX_NUMBERS + number - 1


def nearest_m(settings: Settings, team: Team) -> float:
    """The nearest distance at which an edge is reported to a team's robots [m]; a nearer one is reported there."""
    return settings.views.r_min_m or robots_of(settings.robots, team).radius_m


def static_scene_from(settings: Settings) -> StaticScene:
    """Field, outlines and numbers as the settings describe them.

    Raises ValueError for an edge code that the table of edge types lacks.
    """
    match = settings.match
    segments = sorted(field_segments(settings.field, match.blue_defends), key=lambda segment: not segment.solid)
    shapes = [robots_of(settings.robots, team) for team in TEAMS]
    kinds = np.empty((len(TEAMS), 257), dtype=np.uint8)
    viewers = np.full((len(TEAMS), 256), -1)
    for team in TEAMS:
        kinds[TEAM_NUMBER[team]] = FIRST_KIND[team]
        for number, marker in enumerate(match.ids_of(team)[:MAX_NUMBERS], start=1):
            kinds[TEAM_NUMBER[team], marker + 1] = FIRST_KIND[team] + number
            if number <= match.numbers:
                viewers[TEAM_NUMBER[team], marker] = viewer_index(team, number)
    for code in (*(segment.kind for segment in segments), *np.unique(kinds).tolist()):
        edge_type_of(code)
    angles = [np.arange(MAX_RAYS) * (math.tau / rays) for rays in GRIDS]
    return StaticScene(
        segments_m=np.array([(s.x1_m, s.y1_m, s.x2_m, s.y2_m) for s in segments]).reshape(-1, 4),
        segment_kinds=np.array([s.kind for s in segments], dtype=np.uint8),
        solid=sum(segment.solid for segment in segments),
        limit_m=np.array(accepted_half_extent(settings.field)),
        kind_of_id=kinds,
        viewer_of_id=viewers,
        team_radius_m=np.array([shape.radius_m for shape in shapes]),
        team_square=np.array([int(shape.outline == "square") for shape in shapes]),
        r_min_m=np.array([nearest_m(settings, team) for team in TEAMS]),
        ball_radius_m=settings.ball.radius_m,
        ray_x=np.cos(angles),
        ray_y=np.sin(angles),
    )
