"""Worlds to render: made by hand, or at random with every case that ``vision_core.views`` has a rule for."""

import dataclasses
import math

import numpy as np
from msgspec.structs import replace

from vision_core.clock import Instant
from vision_core.settings.schema import FieldSettings, Settings, TeamRobotSettings
from vision_core.types.objects import Team
from vision_core.types.tables import WorldTable
from vision_core.types.tracks import BallTrack, ObstacleTrack, RobotTrack, World
from vision_core.types.views import RobotView
from vision_core.venues.loader import load_settings
from vision_core.views.renderer import ViewRenderer, viewer_index

SETTINGS = load_settings()
AT = Instant(1_000_000_000)
RADIUS = SETTINGS.robots.radius_m
BALL_RADIUS = SETTINGS.ball.radius_m


def fields() -> dict[str, FieldSettings]:
    """With walls, with walls and cut corners, and without walls."""
    walled = SETTINGS.field
    open_field = load_settings(options={"field_preset": "ssl-division-b"}).field
    return {
        "walls": walled,
        "corners": replace(walled, corner_cut_m=0.12, margin_m=0.05),
        "open": replace(open_field, length_m=3.0, width_m=2.0),
    }


def robot(
    team: Team, marker: int | None, x_m: float, y_m: float, heading_rad: float = 0.0, *, seen: Instant = AT
) -> RobotTrack:
    """A robot at rest."""
    return RobotTrack(team, marker, x_m, y_m, heading_rad, 0.0, 0.0, 0.0, 0.001, 0.01, 1.0, seen)


def ball(x_m: float, y_m: float) -> BallTrack:
    """A ball at rest."""
    return BallTrack(x_m, y_m, 0.0, 0.0, 0.001, hidden=False, seen=AT)


def world(*robots: RobotTrack, ball: BallTrack | None = None) -> World:
    """A world of frame 7."""
    return World(7, AT, robots, ball, ())


def obstacle(x_m: float, y_m: float, radius_m: float) -> ObstacleTrack:
    """An obstacle at rest."""
    return ObstacleTrack(x_m, y_m, 0.0, 0.0, radius_m, AT)


class Observer:
    """Renders the views of one world after the other."""

    def __init__(self, field: FieldSettings, settings: Settings = SETTINGS) -> None:
        self.renderer = ViewRenderer(replace(settings, field=field))

    def observe(self, world: World, team: Team, number: int, rays: int = 360) -> RobotView | None:
        """The view of a team's number with so many rays; None when it is not in the world."""
        self.renderer.buffers.rays[:] = 360
        if 1 <= number <= 16:
            self.renderer.buffers.rays[viewer_index(team, number)] = rays
        table = WorldTable.of(world)
        self.renderer.render(table)
        return self.renderer.view(table, team, number)


def with_squares(settings: Settings = SETTINGS) -> Settings:
    """Yellow robots are squares, larger than the blue circles."""
    robots = settings.robots
    yellow = TeamRobotSettings(pattern=robots.pattern, outline="square", radius_m=0.11, height_m=robots.height_m)
    return replace(settings, robots=replace(robots, yellow=yellow))


def random_world(rng: np.random.Generator, field: FieldSettings) -> World:
    """Blue 1 and up to 11 others: some in contact with it, overlapping it, outside, without an id, of unknown heading;
    up to 3 obstacles; a ball anywhere, near, under it, behind or beside another robot."""
    reach = (field.length_m / 2.0 + 0.4, field.width_m / 2.0 + 0.4)
    own = robot(Team.BLUE, 1, *_place(rng, reach), rng.uniform(-math.pi, math.pi))
    robots = [own]
    for marker in range(2, 2 + int(rng.integers(0, 12))):
        x, y = _place(rng, reach)
        if rng.random() < 0.15:
            x, y = _beside(rng, own.x_m, own.y_m, RADIUS * rng.uniform(0.0, 2.1))
        team = Team.BLUE if rng.random() < 0.5 else Team.YELLOW
        other = robot(team, None if rng.random() < 0.2 else marker, x, y, rng.uniform(-math.pi, math.pi))
        robots.append(dataclasses.replace(other, heading_sd_rad=3.0) if rng.random() < 0.2 else other)
    things = [obstacle(*_place(rng, reach), rng.uniform(0.02, 0.2)) for _ in range(int(rng.integers(0, 4)))]
    return World(7, AT, tuple(robots), _random_ball(rng, robots, reach), tuple(things))


def _random_ball(rng: np.random.Generator, robots: list[RobotTrack], reach: tuple[float, float]) -> BallTrack | None:
    choice = rng.random()
    if choice < 0.05:
        return None
    if choice < 0.4:
        return ball(*_place(rng, reach))
    if choice < 0.5:
        return ball(*_beside(rng, robots[0].x_m, robots[0].y_m, rng.uniform(0.0, 0.12)))
    near = robots[int(rng.integers(len(robots)))]
    return ball(*_beside(rng, near.x_m, near.y_m, RADIUS + BALL_RADIUS + rng.exponential(0.03)))


def _place(rng: np.random.Generator, reach: tuple[float, float]) -> tuple[float, float]:
    return float(rng.uniform(-reach[0], reach[0])), float(rng.uniform(-reach[1], reach[1]))


def _beside(rng: np.random.Generator, x: float, y: float, distance: float) -> tuple[float, float]:
    angle = rng.uniform(-math.pi, math.pi)
    return float(x + distance * math.cos(angle)), float(y + distance * math.sin(angle))
