"""A world in, the views of all its robots out: one compiled call, into memory that was taken once."""

import math
from typing import NamedTuple

import numpy as np

from vision_core.geometry import Bytes, Floats, frozen
from vision_core.models.field import accepted_half_extent, field_segments
from vision_core.models.from_settings import robots_of
from vision_core.native.kernels import kernel
from vision_core.settings.schema import Settings
from vision_core.types.field import EdgeKind
from vision_core.types.objects import Team
from vision_core.types.tables import DIRECTIONS, MAX_NUMBERS, TEAM_NUMBER, TEAMS, Table, WorldTable
from vision_core.types.views import BallView, RobotView
from vision_core.views.ball import share_in_view
from vision_core.views.outlines import BODY, MAX_BODIES, Integers, Row, lay_out
from vision_core.views.splat import nearest_edges, turn_rays

VIEWERS = len(TEAMS) * MAX_NUMBERS
"""A viewer's place in the tables: 16 * its team's number + its own number - 1."""
GRIDS = (DIRECTIONS, 2 * DIRECTIONS, 4 * DIRECTIONS)
"""So many rays a view can have, evenly spaced; ray 0 is straight ahead."""
MAX_RAYS = GRIDS[-1]
FIRST_KIND = {Team.BLUE: EdgeKind.ROBOT_BLUE, Team.YELLOW: EdgeKind.ROBOT_YELLOW}

SEEN = np.dtype(
    [
        ("body", np.int32), ("overlap", np.int32), ("start", np.int64), ("ball_share", np.float64),
        ("ball_m", np.float64), ("ball_deg", np.float64), ("ball_size_deg", np.float64),
    ]
)  # fmt: skip
"""A viewer's row in the world (-1: it is not there), is another outline over its center, where its rays begin in the
arrays of all, and the ball as ``BallView`` has it; share 0: hidden, or there is none."""


class Place(NamedTuple):
    """What stays: the field, the robots' outlines and numbers."""

    segments_m: Floats
    """x1 y1 x2 y2, solid ones first, shape (s, 4)."""
    segment_kinds: Bytes
    solid: int
    limit_m: Floats
    """Half extent of the area from which virtual limits are seen, shape (2,)."""
    kind_of_id: Bytes
    """EdgeKind of a team's robot by 1 + its id, shape (2, 257)."""
    viewer_of_id: Integers
    """Viewer that wears a team's id, -1 for nobody, shape (2, 256)."""
    team_radius_m: Floats
    team_square: Integers
    r_min_m: Floats
    """Of each team, shape (2,)."""
    ball_radius_m: float
    ray_x: Floats
    """Unit vectors of the rays of each grid from the heading, shape (3, MAX_RAYS)."""
    ray_y: Floats


class Sight(NamedTuple):
    """What every world fills in."""

    rays: Integers
    """Of each viewer: how many its view shall have, one of GRIDS; shape (VIEWERS,)."""
    seen: Table
    """SEEN, shape (VIEWERS,)."""
    distances_m: Floats
    """Nearest edge of each ray, inf for nothing: viewer after viewer, from SEEN's start on."""
    kinds: Bytes
    """EdgeKind of each ray, likewise."""
    bodies: Table
    ux: Floats
    uy: Floats
    hidden: Floats


@kernel
def look_all(world: Table, place: Place, sight: Sight) -> None:
    """Fill in what every robot that has a number sees of a world (WORLD, shape (1,)).

    Of two robots of the same id the first one has the view; one at no finite place has none.
    """
    bodies, seen = sight.bodies, sight.seen
    count = lay_out(world, place.kind_of_id, place.team_radius_m, place.team_square, bodies)
    for viewer in range(VIEWERS):
        seen[viewer].body = -1
    start = 0
    for own in range(world[0].counts[0]):
        robot = world[0].robots[own]
        marker = robot.id
        viewer = place.viewer_of_id[robot.team, marker] if 0 <= marker < 256 else -1
        if viewer < 0 or seen[viewer].body >= 0 or not math.isfinite(robot.x_m + robot.y_m + robot.heading_rad):
            continue
        rays = sight.rays[viewer]
        seen[viewer].body, seen[viewer].start = own, start
        distances, kinds = sight.distances_m[start : start + rays], sight.kinds[start : start + rays]
        start += rays
        grid = 0 if rays == 360 else 1 if rays == 720 else 2
        ux, uy = sight.ux[:rays], sight.uy[:rays]
        turn_rays(place.ray_x[grid], place.ray_y[grid], bodies[own].cos, bodies[own].sin, ux, uy)
        inside = abs(robot.x_m) <= place.limit_m[0] and abs(robot.y_m) <= place.limit_m[1]
        seen[viewer].overlap = nearest_edges(
            own, robot.heading_rad, bodies, count,
            place.segments_m, place.segment_kinds, len(place.segments_m) if inside else place.solid,
            place.r_min_m[robot.team], ux, uy, distances, kinds,
        )  # fmt: skip
        seen[viewer].ball_share = 0.0
        if world[0].counts[1] > 0:
            _look_at_ball(world, own, count, place, sight, seen[viewer])


@kernel
def _look_at_ball(world: Table, own: int, count: int, place: Place, sight: Sight, seen: Row) -> None:
    ball, robot = world[0].balls[0], world[0].robots[own]
    radius = place.ball_radius_m
    seen.ball_share = share_in_view(
        own, ball.x_m, ball.y_m, radius, sight.bodies, count, place.segments_m[: place.solid], sight.hidden
    )
    dx, dy = ball.x_m - robot.x_m, ball.y_m - robot.y_m
    away = math.sqrt(dx * dx + dy * dy)
    seen.ball_m = away
    seen.ball_size_deg = 180.0 if away <= radius else math.degrees(2.0 * math.asin(radius / away))
    turned = math.degrees(math.atan2(dy, dx) - robot.heading_rad) % 360.0
    seen.ball_deg = 0.0 if turned >= 360.0 else turned  # the remainder of -1e-17 rounds to 360


class Eyes:
    """Computes the views of all robots of a field. Built once per settings; keeps no state between worlds."""

    def __init__(self, settings: Settings) -> None:
        self.place = place_of(settings)
        self.sight = Sight(
            rays=np.full(VIEWERS, GRIDS[0]),
            seen=np.zeros(VIEWERS, dtype=SEEN),
            distances_m=np.empty(VIEWERS * MAX_RAYS),
            kinds=np.empty(VIEWERS * MAX_RAYS, dtype=np.uint8),
            bodies=np.zeros(MAX_BODIES, dtype=BODY),
            ux=np.empty(MAX_RAYS),
            uy=np.empty(MAX_RAYS),
            hidden=np.empty((2, len(self.place.segments_m) + 4 * MAX_BODIES)),
        )
        self.sight.seen["body"] = -1

    def look(self, world: WorldTable) -> None:
        """Fill in ``sight`` with what the robots of a world see."""
        look_all(world.whole, self.place, self.sight)

    def view(self, world: WorldTable, team: Team, number: int) -> RobotView | None:
        """A copy for people of what a robot of the world that was looked at sees; None when it is not there."""
        if not 1 <= number <= MAX_NUMBERS:
            return None
        viewer = viewer_of(team, number)
        body, overlap, start, share, ball_m, ball_deg, size_deg = self.sight.seen[viewer].tolist()
        if body < 0:
            return None
        rays = slice(start, start + int(self.sight.rays[viewer]))
        row = world.whole[0]
        return RobotView(
            team=team,
            number=number,
            at=row["at"].item(),
            frame_number=row["frame_number"].item(),
            distances_m=frozen(self.sight.distances_m[rays].copy()),
            kinds=frozen(self.sight.kinds[rays].copy()),
            ball=BallView(ball_m, ball_deg, size_deg, share < 1.0) if share > 0.0 else None,
            overlap=bool(overlap),
        )


def viewer_of(team: Team, number: int) -> int:
    """Place of a team's number 1..16 in the tables."""
    return TEAM_NUMBER[team] * MAX_NUMBERS + number - 1


def place_of(settings: Settings) -> Place:
    """What the settings say about field, outlines and numbers."""
    match = settings.match
    segments = sorted(field_segments(settings.field, match.blue_defends), key=lambda segment: not segment.solid)
    shapes = [robots_of(settings.robots, team) for team in TEAMS]
    kinds = np.empty((len(TEAMS), 257), dtype=np.uint8)
    viewers = np.full((len(TEAMS), 256), -1)
    for team, ids in ((Team.BLUE, match.blue_ids), (Team.YELLOW, match.yellow_ids)):
        kinds[TEAM_NUMBER[team]] = FIRST_KIND[team]
        for number, marker in enumerate(ids[:MAX_NUMBERS], start=1):
            kinds[TEAM_NUMBER[team], marker + 1] = FIRST_KIND[team] + number
            if number <= match.numbers:
                viewers[TEAM_NUMBER[team], marker] = viewer_of(team, number)
    angles = [np.arange(MAX_RAYS) * (math.tau / rays) for rays in GRIDS]
    return Place(
        segments_m=np.array([(s.x1_m, s.y1_m, s.x2_m, s.y2_m) for s in segments]).reshape(-1, 4),
        segment_kinds=np.array([s.kind for s in segments], dtype=np.uint8),
        solid=sum(segment.solid for segment in segments),
        limit_m=np.array(accepted_half_extent(settings.field)),
        kind_of_id=kinds,
        viewer_of_id=viewers,
        team_radius_m=np.array([shape.radius_m for shape in shapes]),
        team_square=np.array([int(shape.outline == "square") for shape in shapes]),
        r_min_m=np.array([settings.views.r_min_m or shape.radius_m for shape in shapes]),
        ball_radius_m=settings.ball.radius_m,
        ray_x=np.cos(angles),
        ray_y=np.sin(angles),
    )
