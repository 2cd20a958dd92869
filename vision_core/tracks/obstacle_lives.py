"""The lives of obstacles' tracks: things of robot size that nobody knows.

They are looked for at a lower rate than frames come, so between two *obstacle frames* they stay where they were.

- An obstacle appears with its second sighting in a row, within ``tracks.gate_m`` of the first: what flickers is none.
- The next obstacle frame tells where it is then, or that it is gone. Without one it is gone after its validity.
- A robot is no obstacle: what lies within the outline of a robot's track is left out, when it is taken in (at the
  instant of its own frame) and when the world is told.
"""

import math

from vision_core.kernels import kernel
from vision_core.tracks.state import Row
from vision_core.types.tables import MOST_OBSTACLES, Table

CONFIRMING = 2
"""So many obstacle frames in a row make an obstacle."""
OBSTACLES = 2
"""Place of the obstacles in a table's counts."""


@kernel
def update_obstacles(rules: Row, state: Row, things: Table, count: int, at: int, world: Row) -> None:
    """Take in one obstacle frame, later than all before. Rows of RULES, STATE and WORLD (its robots at this instant).

    things: rows of OBSTACLE, of which count hold.
    """
    fresh, kept = state.fresh, 0
    for index in range(min(count, MOST_OBSTACLES)):
        thing = things[index]
        if not math.isfinite(thing.x_m + thing.y_m + thing.radius_m):
            continue
        if is_robot(rules, world, thing.x_m, thing.y_m):
            continue
        fresh[kept].x_m, fresh[kept].y_m, fresh[kept].radius_m = thing.x_m, thing.y_m, thing.radius_m
        fresh[kept].seen, fresh[kept].sightings = at, 1
        kept += 1
    while continue_nearest(rules, state, kept, at):
        pass
    for index in range(kept):
        state.obstacles[index] = fresh[index]
    state.counts[OBSTACLES] = kept
    state.obstacles_at = at


@kernel
def continue_nearest(rules: Row, state: Row, kept: int, at: int) -> bool:
    """Join the new sighting and the old track that lie nearest to each other, when any are left within the gate."""
    nearest, new, old = rules.gate_m**2, -1, -1
    for index in range(kept):
        thing = state.fresh[index]
        if thing.sightings > 1:
            continue
        for row in range(state.counts[OBSTACLES]):
            life = state.obstacles[row]
            if life.sightings == 0 or at - life.seen > rules.obstacle_validity_ns:
                continue
            distance = (thing.x_m - life.x_m) ** 2 + (thing.y_m - life.y_m) ** 2
            if distance <= nearest:
                nearest, new, old = distance, index, row
    if new < 0:
        return False
    state.fresh[new].sightings = state.obstacles[old].sightings + 1
    state.obstacles[old].sightings = 0
    return True


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
    """The obstacles as the world at an instant has them, whose robots are written already."""
    count = 0
    for row in range(state.counts[OBSTACLES]):
        life = state.obstacles[row]
        if life.sightings < CONFIRMING or at - life.seen > rules.obstacle_validity_ns:
            continue
        if is_robot(rules, world, life.x_m, life.y_m):
            continue
        track = world.obstacles[count]
        track.x_m, track.y_m, track.radius_m, track.seen = life.x_m, life.y_m, life.radius_m, life.seen
        count += 1
    world.counts[OBSTACLES] = count
