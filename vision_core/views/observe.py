"""A world and a robot in, a view out."""

import math

import numpy as np

from vision_core.field_model import accepted_half_extent, field_segments
from vision_core.geometry import Bytes, Floats, frozen
from vision_core.settings import BallSettings, FieldSettings, MatchSettings, RobotSettings, ViewSettings
from vision_core.types.field import EdgeKind
from vision_core.types.objects import Team
from vision_core.types.tracks import BallTrack, RobotTrack, World
from vision_core.types.views import BallView, RobotView
from vision_core.views.ball import visible_share
from vision_core.views.edges import nearest_edges

ALL_ROUND_DEG: Floats = frozen(np.arange(360.0))
"""Every whole degree, anticlockwise from the heading."""
FIRST_KIND = {Team.BLUE: EdgeKind.ROBOT_BLUE, Team.YELLOW: EdgeKind.ROBOT_YELLOW}


class Observer:
    """Computes views of one field's robots. Built once per settings; keeps no state between worlds."""

    def __init__(
        self,
        field: FieldSettings,
        robots: RobotSettings,
        ball: BallSettings,
        views: ViewSettings,
        match: MatchSettings,
    ) -> None:
        segments = sorted(field_segments(field, match.blue_defends), key=lambda segment: not segment.solid)
        self._segments: Floats = np.array([(s.x1_m, s.y1_m, s.x2_m, s.y2_m) for s in segments]).reshape(-1, 4)
        self._segment_kinds: Bytes = np.array([s.kind for s in segments], dtype=np.uint8)
        self._solid = sum(segment.solid for segment in segments)
        self._limit_m = accepted_half_extent(field)
        self._radius_m = robots.radius_m
        self._ball_radius_m = ball.radius_m
        self._r_min_m = views.r_min_m or robots.radius_m
        self._ids = {Team.BLUE: match.blue_ids, Team.YELLOW: match.yellow_ids}
        self._kinds: dict[tuple[Team, int | None], int] = {
            (team, marker): FIRST_KIND[team] + number
            for team, ids in self._ids.items()
            for number, marker in enumerate(ids[:16], start=1)
        }

    def observe(
        self, world: World, team: Team, number: int, directions_deg: Floats = ALL_ROUND_DEG
    ) -> RobotView | None:
        """What the robot that wears a team's number sees; None when it is not in the world.

        directions_deg: the rays, anticlockwise from the heading, shape (n,). The view's kinds are
        ROBOT_BLUE or ROBOT_YELLOW + number for the others, + 0 when their id is not known or is nobody's.
        """
        own = self._robot(world, team, number)
        if own is None:
            return None
        others = [robot for robot in world.robots if robot is not own]
        circles = np.array([(robot.x_m, robot.y_m) for robot in others]).reshape(-1, 2)
        kinds = np.array([self._kinds.get((r.team, r.id), FIRST_KIND[r.team]) for r in others], dtype=np.uint8)
        inside = abs(own.x_m) <= self._limit_m[0] and abs(own.y_m) <= self._limit_m[1]
        seen = len(self._segments) if inside else self._solid
        distances = np.empty(len(directions_deg))
        edge_kinds = np.empty(len(directions_deg), dtype=np.uint8)
        overlap = nearest_edges(
            np.radians(directions_deg) + own.heading_rad,
            own.x_m,
            own.y_m,
            self._segments[:seen],
            self._segment_kinds[:seen],
            circles,
            kinds,
            self._radius_m,
            self._r_min_m,
            distances,
            edge_kinds,
        )
        ball = None if world.ball is None else self._ball_view(own, world.ball, circles)
        return RobotView(
            team, number, world.at, world.frame_number, frozen(distances), frozen(edge_kinds), ball, overlap
        )

    def _robot(self, world: World, team: Team, number: int) -> RobotTrack | None:
        markers = self._ids[team][number - 1 : number] if number > 0 else ()
        return next((robot for robot in world.robots if robot.team is team and robot.id in markers), None)

    def _ball_view(self, own: RobotTrack, ball: BallTrack, circles: Floats) -> BallView | None:
        share = visible_share(
            own.x_m,
            own.y_m,
            ball.x_m,
            ball.y_m,
            self._ball_radius_m,
            self._segments[: self._solid],
            circles,
            self._radius_m,
        )
        if share == 0.0:
            return None
        dx, dy = ball.x_m - own.x_m, ball.y_m - own.y_m
        distance = math.hypot(dx, dy)
        size = (
            180.0 if distance <= self._ball_radius_m else math.degrees(2.0 * math.asin(self._ball_radius_m / distance))
        )
        turned = math.degrees(math.atan2(dy, dx) - own.heading_rad) % 360.0
        return BallView(
            distance_m=distance,
            direction_deg=0.0 if turned >= 360.0 else turned,  # the remainder of -1e-17 rounds to 360
            size_deg=size,
            partial=share < 1.0,
        )
