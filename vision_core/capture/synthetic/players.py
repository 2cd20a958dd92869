"""Behavior of simulated robots: per team one keeper and one chaser, the others wander; all avoid each other."""

import math
from dataclasses import dataclass

import numpy as np

from vision_core.capture.synthetic.physics import HEADING, VX, VY, X, Y, holds_ball
from vision_core.geometry import Floats, wrap_angle
from vision_core.models.field import accepted_half_extent, goal_line_x
from vision_core.settings.schema import Settings
from vision_core.types.objects import Team

KEEPER_OUT_M = 0.14
APPROACH_GAIN_PER_S = 3.0
TURN_GAIN_PER_S = 7.0
MAX_TURN_RAD_S = 8.0
NEAR_ROBOT = 2.2
"""Robots start to give way when the gap between them is this many radii."""
BEHIND_M = 0.10
"""A chaser first goes this far behind where it will touch the ball."""
ALIGNED = 0.9
"""Cosine from which on it drives through the ball, and of the heading from which on it kicks."""
MAX_HOLD_S = 1.2
KICK_M_S = (1.2, 3.2)
WAYPOINT_NEAR_M = 0.12
WAYPOINT_S = (2.0, 6.0)


@dataclass(frozen=True, slots=True)
class Player:
    """One robot's place in its team."""

    team: Team
    keeper: bool
    attacks: float
    """Sign of x of the goal that it plays to."""


class Players:
    """Decides for all robots together; remembers waypoints, chasers and how long the ball has been held."""

    def __init__(self, settings: Settings, players: tuple[Player, ...], rng: np.random.Generator) -> None:
        self._players = players
        self._rng = rng
        self._most_m_s = settings.synthetic.speed_m_s
        self._radius_m = settings.robots.radius_m
        self._ball_radius_m = settings.ball.radius_m
        half_x, half_y = accepted_half_extent(settings.field)
        self._roam = np.array([half_x, half_y]) - 1.5 * self._radius_m
        self._goal_x = goal_line_x(settings.field)
        self._goal_half = settings.field.goal.width_m / 2.0
        self._waypoints = np.zeros((len(players), 2))
        self._waypoint_until_s = np.zeros(len(players))
        self._held_since_s: dict[int, float] = {}
        self._chasers: dict[Team, int] = {}

    def decide(self, robots: Floats, ball: Floats, time_s: float, wishes: Floats, *, in_play: bool) -> None:
        """Write the wanted velocity of each robot, rows vx, vy, turn, shape (n, 3), and let robots kick the ball."""
        if not self._most_m_s:
            return
        self._choose_chasers(robots, ball)
        for i, player in enumerate(self._players):
            if in_play and i in self._chasers.values():
                target, facing = self._chase(robots[i], ball, player)
                self._maybe_kick(i, robots[i], ball, time_s)
            elif player.keeper:
                target, facing = self._keep(ball, player), math.atan2(ball[Y] - robots[i, Y], ball[X] - robots[i, X])
            else:
                target = self._wander(i, robots[i], time_s)
                facing = math.atan2(target[1] - robots[i, Y], target[0] - robots[i, X])
            velocity = self._avoided(i, robots, self._towards(robots[i], target))
            turn = TURN_GAIN_PER_S * wrap_angle(facing - robots[i, HEADING])
            wishes[i] = (*velocity, min(max(turn, -MAX_TURN_RAD_S), MAX_TURN_RAD_S))

    def _choose_chasers(self, robots: Floats, ball: Floats) -> None:
        """Of each team the robot nearest to the ball; the present one stays unless another is clearly nearer."""
        for team in Team:
            members = [i for i, player in enumerate(self._players) if player.team == team]
            fielders = [i for i in members if not self._players[i].keeper] or members
            present = self._chasers.get(team)
            if fielders:
                distance = {
                    i: math.hypot(*(robots[i, :2] - ball[:2])) * (0.7 if i == present else 1.0) for i in fielders
                }
                self._chasers[team] = min(distance, key=distance.__getitem__)

    def _chase(self, robot: Floats, ball: Floats, player: Player) -> tuple[Floats, float]:
        """Go behind the ball as seen from the goal, round it if need be, then through it."""
        goal = np.array([player.attacks * self._goal_x, 0.0])
        aim = _unit(goal - ball[:2])
        arm = ball[:2] - robot[:2]
        facing = math.atan2(arm[1], arm[0])
        contact = self._radius_m + self._ball_radius_m
        if holds_ball(robot, ball, self._radius_m, self._ball_radius_m):
            return robot[:2] + 0.3 * aim, math.atan2(aim[1], aim[0])
        if float(_unit(arm) @ aim) > ALIGNED:
            return ball[:2] + 0.05 * aim, facing
        behind = ball[:2] - (contact + BEHIND_M) * aim
        if float(arm @ aim) < 0.0:
            side = np.array([-aim[1], aim[0]])
            behind += math.copysign(1.6 * contact, float(-arm @ side)) * side
        return behind, facing

    def _maybe_kick(self, i: int, robot: Floats, ball: Floats, time_s: float) -> None:
        if not holds_ball(robot, ball, self._radius_m, self._ball_radius_m):
            self._held_since_s.pop(i, None)
            return
        since = self._held_since_s.setdefault(i, time_s)
        heading = np.array([math.cos(robot[HEADING]), math.sin(robot[HEADING])])
        goal = np.array([self._players[i].attacks * self._goal_x, 0.0])
        if float(_unit(goal - robot[:2]) @ heading) > ALIGNED or time_s - since > MAX_HOLD_S:
            speed = self._rng.uniform(*KICK_M_S)
            ball[VX : VY + 1] = robot[VX : VY + 1] + speed * heading
            del self._held_since_s[i]

    def _keep(self, ball: Floats, player: Player) -> Floats:
        """Before the own goal, on the line from the ball to its middle."""
        x = -player.attacks * (self._goal_x - KEEPER_OUT_M)
        return np.array([x, min(max(0.6 * ball[Y], -self._goal_half), self._goal_half)])

    def _wander(self, i: int, robot: Floats, time_s: float) -> Floats:
        near = math.hypot(*(self._waypoints[i] - robot[:2])) < WAYPOINT_NEAR_M
        if near or time_s >= self._waypoint_until_s[i]:
            self._waypoints[i] = self._rng.uniform(-self._roam, self._roam)
            self._waypoint_until_s[i] = time_s + self._rng.uniform(*WAYPOINT_S)
        waypoint: Floats = self._waypoints[i]
        return waypoint

    def _towards(self, robot: Floats, target: Floats) -> Floats:
        arm = target - robot[:2]
        distance = math.hypot(*arm)
        speed: Floats = _unit(arm) * min(self._most_m_s, APPROACH_GAIN_PER_S * distance)
        return speed

    def _avoided(self, i: int, robots: Floats, velocity: Floats) -> Floats:
        """The velocity bent away from robots that are near and ahead, to the side on which they are passed."""
        arms = robots[i, :2] - robots[:, :2]
        distances = np.hypot(arms[:, 0], arms[:, 1])
        gaps = np.maximum(distances / self._radius_m - 2.0, 0.0)
        for j in np.flatnonzero(gaps < NEAR_ROBOT):
            if j == i or distances[j] == 0.0:
                continue
            away = arms[j] / distances[j]
            if (closing := -float(velocity @ away)) > 0.0:
                side = np.array([-away[1], away[0]])
                bend = closing * (1.0 - gaps[j] / NEAR_ROBOT)
                velocity = velocity + bend * (away + math.copysign(0.8, float(velocity @ side)) * side)
        speed = math.hypot(*velocity)
        return velocity * min(1.0, self._most_m_s / speed) if speed else velocity


def _unit(arm: Floats) -> Floats:
    unit: Floats = arm / max(math.hypot(*arm), 1e-9)
    return unit
