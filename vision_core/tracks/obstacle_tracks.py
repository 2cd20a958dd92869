"""The lives of obstacles' tracks: things of robot size that nobody knows.

They are looked for at a lower rate than frames come, so between two *obstacle frames* they are predicted.

- An obstacle appears with its second sighting in a row, within ``tracks.gate_m`` of the first: what flickers is none.
  Later ones lie that near to where it is predicted.
- Most obstacles stand. A track starts at rest and is disturbed by next to nothing, so that a sighting's noise neither
  shakes it nor makes it drift. A sighting that lies farther away than noise explains frees its velocity: it follows at
  once, as it does when a thing turns or stops.
- The next obstacle frame tells where it is then, or that it is gone. Without one it is gone after its validity.
- A robot is no obstacle: what lies within the outline of a robot's track is left out, when it is taken in (at the
  instant of its own frame) and when the world is told.
"""

import math

from vision_core.clock import NS_PER_S
from vision_core.native.kernels import kernel
from vision_core.tracks.filters import corrected, density_from_acceleration, predicted
from vision_core.tracks.state import Row
from vision_core.types.tables import MAX_OBSTACLES, Table

CONFIRMING = 2
"""So many obstacle frames in a row make an obstacle."""
OBSTACLES = 2
"""Place of the obstacles in a table's counts."""
NOISE = 0.004**2
"""Variance of a sighting's place [m^2]: the middle of a handful of cells."""
CALM_DENSITY = density_from_acceleration(0.02)
"""Of the acceleration noise while nothing startles [m^2/s^3]."""
REST_VARIANCE = 0.02**2
"""Of a new track's velocity [m^2/s^2]."""
STARTLING_SIGMAS = 4.0
"""Deviations from the prediction, of one axis, beyond which it is the motion that changed."""
FASTEST_M_S = 3.0
"""What moves faster is a mistake of pairing."""


@kernel
def update_obstacles(rules: Row, state: Row, things: Table, count: int, at: int, world: Row) -> None:
    """Take in one obstacle frame, later than all before. Rows of RULES, STATE and WORLD (its robots at this instant).

    things: rows of OBSTACLE, of which count hold.
    """
    fresh, kept = state.fresh, 0
    for index in range(min(count, MAX_OBSTACLES)):
        thing = things[index]
        if not math.isfinite(thing.x_m + thing.y_m + thing.radius_m):
            continue
        if is_robot(rules, world, thing.x_m, thing.y_m):
            continue
        appear(fresh[kept], thing, at)
        kept += 1
    while continue_nearest(rules, state, kept, at):
        pass
    for index in range(kept):
        state.obstacles[index] = fresh[index]
    state.counts[OBSTACLES] = kept
    state.obstacles_at = at


@kernel
def appear(life: Row, thing: Row, at: int) -> None:
    """A new track, at rest, of a sighting: a row of OBSTACLE."""
    life.x_m, life.y_m, life.vx_m_s, life.vy_m_s = thing.x_m, thing.y_m, 0.0, 0.0
    life.variance, life.covariance, life.rate_variance = NOISE, 0.0, REST_VARIANCE
    life.radius_m, life.seen, life.sightings = thing.radius_m, at, 1


@kernel
def continue_nearest(rules: Row, state: Row, kept: int, at: int) -> bool:
    """Join the new sighting and the old track predicted nearest to it, when any are left within the gate."""
    nearest, new, old = rules.gate_m**2, -1, -1
    for index in range(kept):
        thing = state.fresh[index]
        if thing.sightings > 1:
            continue
        for row in range(state.counts[OBSTACLES]):
            life = state.obstacles[row]
            if life.sightings == 0 or at - life.seen > rules.obstacle_validity_ns:
                continue
            t = (at - life.seen) / NS_PER_S
            dx, dy = thing.x_m - life.x_m - life.vx_m_s * t, thing.y_m - life.y_m - life.vy_m_s * t
            distance = dx**2 + dy**2
            if distance <= nearest:
                nearest, new, old = distance, index, row
    if new < 0:
        return False
    go_on(rules, state.obstacles[old], state.fresh[new])
    state.obstacles[old].sightings = 0
    return True


@kernel
def go_on(rules: Row, old: Row, life: Row) -> None:
    """Make a track that has just appeared, at a sighting's place, the continuation of an old one."""
    t = (life.seen - old.seen) / NS_PER_S
    x, y = old.x_m + old.vx_m_s * t, old.y_m + old.vy_m_s * t
    dx, dy = life.x_m - x, life.y_m - y
    variance, covariance, rate_variance = predicted(old.variance, old.covariance, old.rate_variance, t, CALM_DENSITY)
    if dx**2 + dy**2 > STARTLING_SIGMAS**2 * (variance + NOISE):
        variance, covariance, rate_variance = predicted(old.variance, 0.0, rules.robot_start, t, CALM_DENSITY)
    gain, rate_gain, life.variance, life.covariance, life.rate_variance = corrected(
        variance, covariance, rate_variance, NOISE
    )
    life.x_m, life.y_m = x + gain * dx, y + gain * dy
    vx, vy = old.vx_m_s + rate_gain * dx, old.vy_m_s + rate_gain * dy
    slowed = FASTEST_M_S / max(math.hypot(vx, vy), FASTEST_M_S)
    life.vx_m_s, life.vy_m_s = slowed * vx, slowed * vy
    life.sightings = old.sightings + 1


@kernel
def is_robot(rules: Row, world: Row, x_m: float, y_m: float) -> bool:
    """Whether a place lies within the outline of a robot of a world."""
    for index in range(world.counts[0]):
        robot = world.robots[index]
        dx, dy = x_m - robot.x_m, y_m - robot.y_m
        radius = rules.radius_m[robot.team]
        if rules.square[robot.team]:
            c, s = math.cos(robot.heading_rad), math.sin(robot.heading_rad)
            if max(abs(c * dx + s * dy), abs(c * dy - s * dx)) <= radius:
                return True
        elif dx**2 + dy**2 <= radius**2:
            return True
    return False


@kernel
def write_obstacles(rules: Row, state: Row, at: int, world: Row) -> None:
    """The obstacles predicted to an instant of a world whose robots are written already."""
    count = 0
    for row in range(state.counts[OBSTACLES]):
        life = state.obstacles[row]
        if life.sightings < CONFIRMING or at - life.seen > rules.obstacle_validity_ns:
            continue
        t = (at - life.seen) / NS_PER_S
        x, y = life.x_m + life.vx_m_s * t, life.y_m + life.vy_m_s * t
        if is_robot(rules, world, x, y):
            continue
        track = world.obstacles[count]
        track.x_m, track.y_m, track.vx_m_s, track.vy_m_s = x, y, life.vx_m_s, life.vy_m_s
        track.radius_m, track.seen = life.radius_m, life.seen
        count += 1
    world.counts[OBSTACLES] = count
