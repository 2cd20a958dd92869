"""Behavior of simulated robots. In each team one keeps the goal, one chases the ball, the others drive at random.

All avoid each other.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vision_core.capture.synthetic.bodies import HEADING, VX, VY, X, Y
from vision_core.capture.synthetic.contacts import holds_ball
from vision_core.geometry import Floats, wrap_angle
from vision_core.models.field import accepted_half_extent, goal_line_x
from vision_core.settings.schema import Settings
from vision_core.types.objects import Team

Mask = NDArray[np.bool_]

KEEPER_BEFORE_GOAL_M = 0.14
"""Distance of a keeper from its goal line."""
APPROACH_GAIN_PER_S = 3.0
TURN_GAIN_PER_S = 7.0
MAX_TURN_RAD_S = 8.0
AVOIDANCE_GAP_RADII = 2.2
"""A robot avoids another when the gap between them is less than so many radii."""
APPROACH_BEHIND_M = 0.10
"""A chaser first drives to a point behind the ball, so far from where it will touch it."""
MIN_ALIGNMENT = 0.9
"""A chaser drives at the ball, and kicks it, when the cosine of the angle to the goal's direction is greater."""
MAX_HOLD_S = 1.2
"""A robot that has held the ball so long kicks it in any direction."""
KICK_M_S = (1.2, 3.2)
WAYPOINT_NEAR_M = 0.12
WAYPOINT_S = (2.0, 6.0)


@dataclass(frozen=True, slots=True)
class Player:
    """One robot's role in its team."""

    team: Team
    keeper: bool
    attack_sign: float
    """Sign of x of the goal that its team attacks."""


class Players:
    """Decides for all robots. Keeps waypoints, chasers, and since when each robot has held the ball."""

    def __init__(self, settings: Settings, players: tuple[Player, ...], rng: np.random.Generator) -> None:
        self._players = players
        self._rng = rng
        self._max_speed_m_s = settings.synthetic.speed_m_s
        self._radius_m = settings.robots.radius_m
        self._ball_radius_m = settings.ball.radius_m
        half_x, half_y = accepted_half_extent(settings.field)
        self._roam_half_extent = np.array([half_x, half_y]) - 1.5 * self._radius_m
        self._goal_x = goal_line_x(settings.field)
        self._goal_half = settings.field.goal.width_m / 2.0
        self._waypoints = np.zeros((len(players), 2))
        self._waypoint_until_s = np.zeros(len(players))
        self._held_since_s: dict[int, float] = {}
        self._chasers: dict[Team, int] = {}

    def decide(
        self, robots: Floats, ball: Floats, time_s: float, commands: Floats, driven: Mask, *, in_play: bool
    ) -> None:
        """Write each robot's command, rows vx, vy, turn rate, shape (n, 3), and let robots kick the ball.

        driven: the robots for which somebody else decides, shape (n,).
        """
        if not self._max_speed_m_s:
            return
        self._choose_chasers(robots, ball, driven)
        for i, player in enumerate(self._players):
            if driven[i]:
                continue
            if in_play and i in self._chasers.values():
                target, facing = self._chase(robots[i], ball, player)
                self._kick_when_ready(i, robots[i], ball, time_s)
            elif player.keeper:
                target, facing = (
                    self._guard_goal(ball, player),
                    math.atan2(ball[Y] - robots[i, Y], ball[X] - robots[i, X]),
                )
            else:
                target = self._wander(i, robots[i], time_s)
                facing = math.atan2(target[1] - robots[i, Y], target[0] - robots[i, X])
            velocity = self._avoid_robots(i, robots, self._velocity_towards(robots[i], target))
            turn = TURN_GAIN_PER_S * wrap_angle(facing - robots[i, HEADING])
            commands[i] = (*velocity, min(max(turn, -MAX_TURN_RAD_S), MAX_TURN_RAD_S))

    def _choose_chasers(self, robots: Floats, ball: Floats, driven: Mask) -> None:
        """Choose each team's robot nearest to the ball. The present chaser stays unless another is clearly nearer."""
        for team in Team:
            members = [i for i, player in enumerate(self._players) if player.team == team and not driven[i]]
            fielders = [i for i in members if not self._players[i].keeper] or members
            present = self._chasers.get(team)
            if fielders:
                distance = {
                    i: math.hypot(*(robots[i, :2] - ball[:2])) * (0.7 if i == present else 1.0) for i in fielders
                }
                self._chasers[team] = min(distance, key=distance.__getitem__)
            else:
                self._chasers.pop(team, None)

    def _chase(self, robot: Floats, ball: Floats, player: Player) -> tuple[Floats, float]:
        """Target and facing of a chaser: a point behind the ball, round the ball if need be, then the ball itself."""
        goal = np.array([player.attack_sign * self._goal_x, 0.0])
        aim = _unit(goal - ball[:2])
        offset = ball[:2] - robot[:2]
        facing = math.atan2(offset[1], offset[0])
        contact = self._radius_m + self._ball_radius_m
        if holds_ball(robot, ball, self._radius_m, self._ball_radius_m):
            return robot[:2] + 0.3 * aim, math.atan2(aim[1], aim[0])
        if float(_unit(offset) @ aim) > MIN_ALIGNMENT:
            return ball[:2] + 0.05 * aim, facing
        behind = ball[:2] - (contact + APPROACH_BEHIND_M) * aim
        if float(offset @ aim) < 0.0:
            side = np.array([-aim[1], aim[0]])
            behind += math.copysign(1.6 * contact, float(-offset @ side)) * side
        return behind, facing

    def _kick_when_ready(self, i: int, robot: Floats, ball: Floats, time_s: float) -> None:
        """Let a robot that holds the ball kick it when it faces the goal, or has held it too long."""
        if not holds_ball(robot, ball, self._radius_m, self._ball_radius_m):
            self._held_since_s.pop(i, None)
            return
        since = self._held_since_s.setdefault(i, time_s)
        heading = np.array([math.cos(robot[HEADING]), math.sin(robot[HEADING])])
        goal = np.array([self._players[i].attack_sign * self._goal_x, 0.0])
        if float(_unit(goal - robot[:2]) @ heading) > MIN_ALIGNMENT or time_s - since > MAX_HOLD_S:
            speed = self._rng.uniform(*KICK_M_S)
            ball[VX : VY + 1] = robot[VX : VY + 1] + speed * heading
            del self._held_since_s[i]

    def _guard_goal(self, ball: Floats, player: Player) -> Floats:
        """The keeper's target: before its goal, at 0.6 times the ball's y, between the posts."""
        x = -player.attack_sign * (self._goal_x - KEEPER_BEFORE_GOAL_M)
        return np.array([x, min(max(0.6 * ball[Y], -self._goal_half), self._goal_half)])

    def _wander(self, i: int, robot: Floats, time_s: float) -> Floats:
        """A robot's random waypoint; a new one when it is reached or its time is over."""
        near = math.hypot(*(self._waypoints[i] - robot[:2])) < WAYPOINT_NEAR_M
        if near or time_s >= self._waypoint_until_s[i]:
            self._waypoints[i] = self._rng.uniform(-self._roam_half_extent, self._roam_half_extent)
            self._waypoint_until_s[i] = time_s + self._rng.uniform(*WAYPOINT_S)
        waypoint: Floats = self._waypoints[i]
        return waypoint

    def _velocity_towards(self, robot: Floats, target: Floats) -> Floats:
        """Velocity towards a target: proportional to the distance, up to the highest speed."""
        offset = target - robot[:2]
        distance = math.hypot(*offset)
        velocity: Floats = _unit(offset) * min(self._max_speed_m_s, APPROACH_GAIN_PER_S * distance)
        return velocity

    def _avoid_robots(self, i: int, robots: Floats, velocity: Floats) -> Floats:
        """The velocity, turned away from near robots that it approaches, to the side on which it passes them."""
        offsets = robots[i, :2] - robots[:, :2]
        distances = np.hypot(offsets[:, 0], offsets[:, 1])
        gaps = np.maximum(distances / self._radius_m - 2.0, 0.0)
        for j in np.flatnonzero(gaps < AVOIDANCE_GAP_RADII):
            if j == i or distances[j] == 0.0:
                continue
            away = offsets[j] / distances[j]
            if (closing := -float(velocity @ away)) > 0.0:
                side = np.array([-away[1], away[0]])
                bend = closing * (1.0 - gaps[j] / AVOIDANCE_GAP_RADII)
                velocity = velocity + bend * (away + math.copysign(0.8, float(velocity @ side)) * side)
        speed = math.hypot(*velocity)
        return velocity * min(1.0, self._max_speed_m_s / speed) if speed else velocity


def _unit(offset: Floats) -> Floats:
    unit: Floats = offset / max(math.hypot(*offset), 1e-9)
    return unit
