"""The tracks of obstacles: objects of robot size that are not known robots.

Obstacles are detected at a lower rate than frames come, so they are predicted between two *obstacle frames*.

- An obstacle appears with its second sighting in a row, within ``tracks.gate_m`` of the first, so that flicker makes
  no obstacle. Later sightings must lie within the same gate of the prediction.
- Most obstacles stand still. A track starts at rest with very little process noise, so that the noise of sightings
  neither moves it nor makes it drift. A sighting farther from the prediction than noise explains is a maneuver: the
  velocity becomes uncertain again, and the track follows at once, as when an object starts, turns or stops.
- Each obstacle frame continues a track or ends it. Without obstacle frames a track ends after its validity.
- A robot is not an obstacle: positions within the outline of a robot's track are left out, both when an obstacle frame
  is processed (at its instant) and when a world is written.
"""

import math

from vision_core.clock import NS_PER_S
from vision_core.native.kernels import kernel
from vision_core.tracks.filters import corrected, density_from_acceleration, predicted
from vision_core.tracks.state import Row
from vision_core.types.tables import MAX_OBSTACLES, Table

MIN_SIGHTINGS = 2
"""An object must be in so many obstacle frames in a row to be an obstacle."""
OBSTACLES = 2
"""Index of the obstacles in the counts of WORLD and TRACKER_STATE."""
NOISE = 0.004**2
"""Variance of a sighting's position [m^2]: the center of a few cells of the detector's grid."""
CALM_DENSITY = density_from_acceleration(0.02)
"""Spectral density of the acceleration noise while there is no maneuver [m^2/s^3]."""
REST_VARIANCE = 0.02**2
"""Variance of a new track's velocity [m^2/s^2]."""
MANEUVER_SIGMAS = 4.0
"""A sighting that deviates from the prediction by more standard deviations (of one axis) is a maneuver."""
MAX_SPEED_M_S = 3.0
"""A higher speed comes from a wrong pair of sightings, and is cut to this."""


@kernel
def update_obstacles(parameters: Row, state: Row, obstacles: Table, count: int, at: int, world: Row) -> None:
    """Process one obstacle frame, later than all before.

    Rows of PARAMETERS, TRACKER_STATE and WORLD (its robots at this instant). obstacles: rows of OBSTACLE, of which the
    first count are valid.
    """
    # Every sighting that is not on a robot starts a track.
    new, kept = state.new_obstacles, 0
    for index in range(min(count, MAX_OBSTACLES)):
        obstacle = obstacles[index]
        if not math.isfinite(obstacle.x_m + obstacle.y_m + obstacle.radius_m):
            continue
        if is_robot(parameters, world, obstacle.x_m, obstacle.y_m):
            continue
        start_obstacle(new[kept], obstacle, at)
        kept += 1
    # New tracks near an old one inherit its velocity and its number of sightings; then they replace the old ones.
    while continue_nearest(parameters, state, kept, at):
        pass
    for index in range(kept):
        state.obstacles[index] = new[index]
    state.counts[OBSTACLES] = kept
    state.obstacles_at = at


@kernel
def start_obstacle(track: Row, sighting: Row, at: int) -> None:
    """Fill in a new track, at rest, from a sighting: a row of OBSTACLE."""
    track.x_m, track.y_m, track.vx_m_s, track.vy_m_s = sighting.x_m, sighting.y_m, 0.0, 0.0
    track.variance, track.covariance, track.rate_variance = NOISE, 0.0, REST_VARIANCE
    track.radius_m, track.seen, track.sightings = sighting.radius_m, at, 1


@kernel
def continue_nearest(parameters: Row, state: Row, kept: int, at: int) -> bool:
    """Join the new track and the old track whose prediction is nearest to it; False: no pair within the gate."""
    nearest, new, old = parameters.gate_m**2, -1, -1
    for index in range(kept):
        sighted = state.new_obstacles[index]
        if sighted.sightings > 1:
            continue
        for row in range(state.counts[OBSTACLES]):
            track = state.obstacles[row]
            if track.sightings == 0 or at - track.seen > parameters.obstacle_validity_ns:
                continue
            t = (at - track.seen) / NS_PER_S
            dx, dy = sighted.x_m - track.x_m - track.vx_m_s * t, sighted.y_m - track.y_m - track.vy_m_s * t
            distance = dx**2 + dy**2
            if distance <= nearest:
                nearest, new, old = distance, index, row
    if new < 0:
        return False
    continue_track(parameters, state.obstacles[old], state.new_obstacles[new])
    state.obstacles[old].sightings = 0
    return True


@kernel
def continue_track(parameters: Row, old: Row, new: Row) -> None:
    """Make a track that was just started at a sighting's position the continuation of an old one."""
    t = (new.seen - old.seen) / NS_PER_S
    x, y = old.x_m + old.vx_m_s * t, old.y_m + old.vy_m_s * t
    dx, dy = new.x_m - x, new.y_m - y
    variance, covariance, rate_variance = predicted(old.variance, old.covariance, old.rate_variance, t, CALM_DENSITY)
    # Maneuver detected: predict again, with the velocity as uncertain as a robot's after its first sighting.
    if dx**2 + dy**2 > MANEUVER_SIGMAS**2 * (variance + NOISE):
        variance, covariance, rate_variance = predicted(old.variance, 0.0, parameters.robot_start, t, CALM_DENSITY)
    gain, rate_gain, new.variance, new.covariance, new.rate_variance = corrected(
        variance, covariance, rate_variance, NOISE
    )
    new.x_m, new.y_m = x + gain * dx, y + gain * dy
    vx, vy = old.vx_m_s + rate_gain * dx, old.vy_m_s + rate_gain * dy
    slowed = MAX_SPEED_M_S / max(math.hypot(vx, vy), MAX_SPEED_M_S)
    new.vx_m_s, new.vy_m_s = slowed * vx, slowed * vy
    new.sightings = old.sightings + 1


@kernel
def is_robot(parameters: Row, world: Row, x_m: float, y_m: float) -> bool:
    """Whether a position lies within the outline of a robot of a world."""
    for index in range(world.counts[0]):
        robot = world.robots[index]
        dx, dy = x_m - robot.x_m, y_m - robot.y_m
        radius = parameters.radius_m[robot.team]
        if parameters.square[robot.team]:
            c, s = math.cos(robot.heading_rad), math.sin(robot.heading_rad)
            if max(abs(c * dx + s * dy), abs(c * dy - s * dx)) <= radius:
                return True
        elif dx**2 + dy**2 <= radius**2:
            return True
    return False


@kernel
def write_obstacles(parameters: Row, state: Row, at: int, world: Row) -> None:
    """Write the obstacles predicted to an instant into a world whose robots are written already."""
    count = 0
    for row in range(state.counts[OBSTACLES]):
        track = state.obstacles[row]
        if track.sightings < MIN_SIGHTINGS or at - track.seen > parameters.obstacle_validity_ns:
            continue
        t = (at - track.seen) / NS_PER_S
        x, y = track.x_m + track.vx_m_s * t, track.y_m + track.vy_m_s * t
        if is_robot(parameters, world, x, y):
            continue
        written = world.obstacles[count]
        written.x_m, written.y_m, written.vx_m_s, written.vy_m_s = x, y, track.vx_m_s, track.vy_m_s
        written.radius_m, written.seen = track.radius_m, track.seen
        count += 1
    world.counts[OBSTACLES] = count
