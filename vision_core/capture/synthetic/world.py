"""The simulated world: robots that play, a ball, people who walk beside the field."""

import math
from dataclasses import dataclass

import numpy as np

from vision_core.capture.synthetic.physics import FRONT_RADII, HEADING, STEP_S, TURN_RATE, VX, VY, X, Y, move, no_bodies
from vision_core.capture.synthetic.players import Player, Players
from vision_core.geometry import Floats, wrap_angle
from vision_core.models.field import accepted_half_extent, field_segments, goal_line_x, is_accepted
from vision_core.models.from_settings import robots_of
from vision_core.settings.schema import RobotSettings, Settings
from vision_core.types.objects import Team

DECIDE_EVERY = 8
"""Steps between two decisions of the players and the referee."""
PAUSE_S = 1.0
"""The referee puts back a ball that has been in a goal or off the field for so long."""
STUCK_S = 2.5
STUCK_M = 0.05
"""A ball that has moved by less than STUCK_M in STUCK_S is stuck."""
KICK_OFF_SPEED_M_S = 0.8
"""Speed of a ball that is put back, in a random direction."""
CANDIDATE_PLACES = 200
"""Random places that are tried for a robot or the ball."""
WALK_M_S = 0.5
STRIDE_S = 1.1
"""Mean speed of a person, and period of a foot's motion: it stops once per stride."""


@dataclass(frozen=True, slots=True)
class Snapshot:
    """Poses and velocities of all bodies at one instant: rows x, y, heading, vx, vy, turn rate."""

    robots: Floats
    """Shape (n, 6)."""
    ball: Floats
    """Shape (6,)."""
    feet: Floats
    """Shape (m, 6); the heading points from heel to toe."""


class World:
    """Simulates the match in fixed time steps. Equal seeds give equal matches, whatever the frame rate."""

    def __init__(self, settings: Settings) -> None:
        field = settings.field
        self._field = field
        self._rng = np.random.default_rng([settings.synthetic.seed, 1])
        self._radii = np.array([_disc_radius_m(settings.robots), settings.ball.radius_m])
        self._half = np.array(accepted_half_extent(field))
        self._goal_x = goal_line_x(field)
        self._moving = settings.synthetic.speed_m_s > 0.0
        segments = field_segments(field, settings.match.blue_defends)
        solids = [(part.x1_m, part.y1_m, part.x2_m, part.y2_m) for part in segments if part.solid]
        self._solids = np.array(solids, dtype=np.float64).reshape(-1, 4)
        self.robots_worn = _markers_worn(settings)
        """Team and marker id of each robot."""
        self._time_s = 0.0
        self._steps = 0
        self._robots = no_bodies(len(self.robots_worn))
        self._commands = np.zeros((len(self.robots_worn), 3))
        self._ball = no_bodies(1)[0]
        self._place_all()
        players = _players(self.robots_worn, settings.match.blue_defends)
        self._players = Players(settings, players, self._rng)
        self._feet = _feet_paths(settings)
        self._out_since_s: float | None = None
        self._last_move = (0.0, self._ball[:2].copy())

    def advance(self, duration_s: float) -> None:
        """Let time pass [s]."""
        self._time_s += duration_s
        target = math.floor(self._time_s / STEP_S)
        while self._steps < target:
            if self._steps % DECIDE_EVERY == 0:
                now = self._steps * STEP_S
                self._referee(now)
                in_play = self._out_since_s is None
                self._players.decide(self._robots, self._ball, now, self._commands, in_play=in_play)
            count = min(target - self._steps, DECIDE_EVERY - self._steps % DECIDE_EVERY)
            move(self._robots, self._commands, self._ball, self._solids, self._half, self._radii, count)
            self._steps += count

    def snapshot(self) -> Snapshot:
        """State at the present time: the last step's, extrapolated at constant velocity."""
        rest_s = self._time_s - self._steps * STEP_S
        return Snapshot(
            robots=_extrapolated(self._robots, rest_s),
            ball=_extrapolated(self._ball[None], rest_s)[0],
            feet=_feet_at(self._feet, self._time_s),
        )

    def _referee(self, now_s: float) -> None:
        """Put the ball back when it is out, in a goal or stuck."""
        x, y = float(self._ball[X]), float(self._ball[Y])
        moved = math.hypot(*(self._ball[:2] - self._last_move[1])) > STUCK_M
        if moved:
            self._last_move = (now_s, self._ball[:2].copy())
        out = abs(x) > self._goal_x or not is_accepted(self._field, x, y)
        if not out:
            self._out_since_s = None
        elif self._out_since_s is None:
            self._out_since_s = now_s
        over = self._out_since_s is not None and now_s - self._out_since_s >= PAUSE_S
        if self._moving and (over or now_s - self._last_move[0] > STUCK_S):
            self._place_ball()
            self._last_move = (now_s, self._ball[:2].copy())

    def _place_all(self) -> None:
        for i in range(len(self._robots)):
            self._robots[i, :2] = self._free_place(self._robots[:i], 3.0 * self._radii[0])
            self._robots[i, HEADING] = self._rng.uniform(-math.pi, math.pi)
        self._place_ball()

    def _place_ball(self) -> None:
        self._ball[:] = 0.0
        self._ball[:2] = self._free_place(self._robots, 1.5 * self._radii.sum())
        if self._moving:
            angle = self._rng.uniform(-math.pi, math.pi)
            self._ball[VX], self._ball[VY] = KICK_OFF_SPEED_M_S * math.cos(angle), KICK_OFF_SPEED_M_S * math.sin(angle)

    def _free_place(self, bodies: Floats, clearance_m: float) -> Floats:
        """A random place inside the lines with a clearance from all bodies; on a crowded field the clearest."""
        inside = np.array([self._field.length_m, self._field.width_m]) / 2.0 - 2.0 * self._radii[0]
        places = self._rng.uniform(-inside, inside, size=(CANDIDATE_PLACES, 2))
        offsets = places[:, None] - bodies[None, :, :2]
        gaps = np.hypot(offsets[..., 0], offsets[..., 1]).min(axis=1, initial=math.inf)
        clear = np.flatnonzero(gaps >= clearance_m)
        chosen: Floats = places[clear[0] if len(clear) else int(gaps.argmax())]
        return chosen


def _disc_radius_m(robots: RobotSettings) -> float:
    """Radius of the disc, cut flat in front, as which robots collide.

    For a square robot it is the disc whose flat front is the front of the square.
    """
    shapes = [robots_of(robots, team) for team in Team]
    return max(shape.radius_m / FRONT_RADII if shape.outline == "square" else shape.radius_m for shape in shapes)


def _markers_worn(settings: Settings) -> tuple[tuple[Team, int], ...]:
    """Team and marker id of each robot: the first ids of the match."""
    ids = {Team.BLUE: settings.match.blue_ids, Team.YELLOW: settings.match.yellow_ids}
    return tuple((team, worn) for team in Team for worn in ids[team][: settings.synthetic.robots_per_team])


def _attack_signs(blue_defends: str) -> dict[Team, float]:
    """Sign of x of the goal that each team attacks."""
    blue = 1.0 if blue_defends == "left" else -1.0
    return {Team.BLUE: blue, Team.YELLOW: -blue}


def _players(worn: tuple[tuple[Team, int], ...], blue_defends: str) -> tuple[Player, ...]:
    """The first robot of each team keeps its goal, unless it is the only one."""
    signs = _attack_signs(blue_defends)
    teams = [team for team, _ in worn]
    return tuple(
        Player(team, keeper=teams.index(team) == i and teams.count(team) > 1, attack_sign=signs[team])
        for i, team in enumerate(teams)
    )


def _extrapolated(bodies: Floats, duration_s: float) -> Floats:
    """Bodies after a duration at constant velocity."""
    moved_bodies = bodies.copy()
    moved_bodies[:, X : HEADING + 1] += bodies[:, VX : TURN_RATE + 1] * duration_s
    return moved_bodies


def _feet_paths(settings: Settings) -> Floats:
    """Straight paths beside the field on which people walk back and forth: x1, y1, x2, y2, phase [s]; shape (m, 5)."""
    rng = np.random.default_rng([settings.synthetic.seed, 2])
    half_x, half_y = accepted_half_extent(settings.field)
    goal = settings.field.goal.width_m / 2.0 + 0.25
    corner = max(half_y - 0.05, goal + 0.2)
    paths = []
    for i in range(settings.synthetic.walking_people):
        away = rng.uniform(0.10, 0.22)
        across = (-1.0 if i % 2 else 1.0) * (half_x + away)
        along = (-1.0 if i % 4 < 2 else 1.0) * (half_y + away)
        path = (across, goal, across, corner) if i % 3 < 2 else (-0.8 * half_x, along, 0.8 * half_x, along)
        paths.append((*path, rng.uniform(0.0, 20.0)))
    return np.array(paths).reshape(-1, 5)


def _feet_at(paths: Floats, time_s: float) -> Floats:
    """Feet on their paths at a time. Each foot stops once per stride; people turn round at the ends."""
    feet = no_bodies(len(paths))
    for i, (x1, y1, x2, y2, phase_s) in enumerate(paths):
        length = math.hypot(x2 - x1, y2 - y1)
        step_rate = math.tau / STRIDE_S
        now = time_s + phase_s
        walked_m = WALK_M_S * (now - math.sin(step_rate * now) / step_rate)
        speed = WALK_M_S * (1.0 - math.cos(step_rate * now))
        on_way_out = walked_m % (2.0 * length) < length
        fraction = walked_m % length / length
        angle = math.atan2(y2 - y1, x2 - x1)
        if not on_way_out:
            fraction, angle = 1.0 - fraction, wrap_angle(angle + math.pi)
        feet[i] = (
            x1 + fraction * (x2 - x1), y1 + fraction * (y2 - y1), angle,
            speed * math.cos(angle), speed * math.sin(angle), 0.0,
        )  # fmt: skip
    return feet
