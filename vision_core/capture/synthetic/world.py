"""The simulated world: robots that play, a ball, people who walk beside the field."""

import math
from dataclasses import dataclass, replace

import numpy as np

from vision_core.capture.synthetic.bodies import FRONT_RADII, HEADING, STEP_S, TURN_RATE, VX, VY, X, Y, no_bodies
from vision_core.capture.synthetic.drivers import DriverDesk
from vision_core.capture.synthetic.game import GameCount
from vision_core.capture.synthetic.people import feet_at, feet_paths
from vision_core.capture.synthetic.physics import move
from vision_core.capture.synthetic.players import Player, Players
from vision_core.clock import Instant
from vision_core.geometry import Floats
from vision_core.models.field import accepted_half_extent, field_segments, goal_line_x, is_accepted
from vision_core.models.from_settings import robots_of
from vision_core.settings.schema import MatchSettings, RobotSettings, Settings
from vision_core.types.drives import Drives
from vision_core.types.game import DrivenRobot, Game
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
    """Simulates the match in fixed time steps.

    Equal seeds give equal matches, whatever the frame rate, unless clients drive robots.
    """

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
        self._desk = DriverDesk(settings.synthetic.drive, self.robots_worn)
        self._game = GameCount([team for team, _ in self.robots_worn])
        self._blue_defends = settings.match.blue_defends
        self._time_s = 0.0
        self._steps = 0
        self._robots = no_bodies(len(self.robots_worn))
        self._commands = np.zeros((len(self.robots_worn), 3))
        self._ball = no_bodies(1)[0]
        self._place_all()
        players = _players(self.robots_worn, settings.match.blue_defends)
        self._players = Players(settings, players, self._rng)
        self._feet = feet_paths(settings)
        self._out_since_s: float | None = None
        self._goal_at_s: float | None = None
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
                driven = self._desk.drivers.driven
                self._players.decide(self._robots, self._ball, now, self._commands, driven, in_play=in_play)
            count = min(target - self._steps, DECIDE_EVERY - self._steps % DECIDE_EVERY)
            move(
                self._robots, self._commands, self._desk.drivers, self._ball, self._solids, self._half, self._radii,
                self._game.tally, count,
            )  # fmt: skip
            self._game.pass_time(count * STEP_S)
            self._steps += count

    def drive(self, drives: Drives, match: MatchSettings, now: Instant) -> None:
        """Have robots follow the newest commands of their drivers from now on.

        match: who wears which marker, and which goal is whose.
        """
        self._blue_defends = match.blue_defends
        self._desk.take(drives, match, now)

    @property
    def game(self) -> Game:
        """What has happened since the game began."""
        desk = self._desk
        driven = (
            DrivenRobot(self.robots_worn[robot][0], int(desk.numbers[robot]), bool(desk.silent[robot]))
            for robot in np.flatnonzero(desk.drivers.driven)
        )
        return replace(self._game.report(), driven=tuple(driven))

    def begin_game(self) -> None:
        """Count anew, and put the ball down anew. The robots stay where they are."""
        self._game.begin()
        self._put_ball_down()

    def snapshot(self) -> Snapshot:
        """State at the present time: the last step's, extrapolated at constant velocity."""
        rest_s = self._time_s - self._steps * STEP_S
        return Snapshot(
            robots=_extrapolated(self._robots, rest_s),
            ball=_extrapolated(self._ball[None], rest_s)[0],
            feet=feet_at(self._feet, self._time_s),
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
            self._judge_goal(x, y, now_s)
        over = self._out_since_s is not None and now_s - self._out_since_s >= PAUSE_S
        scored = self._goal_at_s is not None and now_s - self._goal_at_s >= PAUSE_S
        driven = bool(self._desk.drivers.driven.any())
        if (self._moving or driven) and (over or (driven and scored) or now_s - self._last_move[0] > STUCK_S):
            self._put_ball_down()
        elif scored and not out:  # players without drivers play on with a ball that rolls out of the goal
            self._goal_at_s = None

    def _judge_goal(self, x: float, y: float, now_s: float) -> None:
        """Count a goal if the ball is in one; a ball that rolls out and in again does not count twice."""
        goal = self._field.goal
        if self._goal_at_s is None and goal.depth_m and abs(x) > self._goal_x and abs(y) < goal.width_m / 2.0:
            self._goal_at_s = now_s
            signs = _attack_signs(self._blue_defends)
            self._game.score(next(team for team in Team if signs[team] * x > 0.0))

    def _put_ball_down(self) -> None:
        self._place_ball()
        self._game.lose_ball()
        self._goal_at_s = None
        self._last_move = (self._steps * STEP_S, self._ball[:2].copy())

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
    count = settings.synthetic.robots_per_team
    return tuple((team, worn) for team in Team for worn in settings.match.ids_of(team)[:count])


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
