"""The state of the stage, one tracker per service; and the whole stage as two kernels."""

import numpy as np

from vision_core.clock import Instant
from vision_core.native.kernels import kernel
from vision_core.settings.schema import RobotSettings, TrackSettings
from vision_core.tracks.ball_tracks import update_ball, write_ball
from vision_core.tracks.obstacle_tracks import update_obstacles, write_obstacles
from vision_core.tracks.robot_tracks import update_robots, write_robots
from vision_core.tracks.state import NEVER, rules_from, state_of_nothing
from vision_core.types.tables import MAX_OBSTACLES, OBSTACLE, SightingsTable, Table, WorldTable


class Tracker:
    """Turns sightings, frame by frame, into the state of the field at any instant.

    A robot's track starts with its first sighting and is predicted for ``tracks.validity_ms`` past its last
    one; the ball's for ``tracks.ball_validity_ms``; an obstacle's for ``tracks.obstacle_validity_ms``. An id (or
    a ball) that appears beyond its track's gate does not move it at once: the track starts over there only when a
    second sighting confirms the new place. The rules stand in ``vision_core.tracks.robot_tracks``, ``ball_lives`` and
    ``obstacle_lives``.

    Every call returns the same table, the tracker's own: the next call overwrites it.
    """

    def __init__(self, settings: TrackSettings, robots: RobotSettings) -> None:
        self._rules = rules_from(settings, robots)
        self._state = state_of_nothing()
        self._things: Table = np.zeros(MAX_OBSTACLES, dtype=OBSTACLE)
        self._things_at = NEVER
        self._world = WorldTable()

    @property
    def refused(self) -> int:
        """Frames that came late or twice, and changed nothing."""
        return int(self._state["refused"][0])

    def update(
        self, sightings: SightingsTable, obstacles: Table | None = None, obstacles_at: Instant | None = None
    ) -> WorldTable:
        """Take in one frame and return the world at its grab instant.

        A frame that is not newer than the last one is refused: it is counted in ``refused``, and the world of
        the last frame is returned (its ``at`` tells). Sightings at no finite place are ignored.

        obstacles: rows of OBSTACLE as last told, seen in the frame that was grabbed at obstacles_at (None: in this
        one). The same frame's may be given again and again: they count once.
        """
        count = 0
        things_at = NEVER
        if obstacles is not None:
            things_at = int(sightings.whole["grabbed"][0]) if obstacles_at is None else obstacles_at
            count = min(len(obstacles), MAX_OBSTACLES)
            if things_at != self._things_at:
                self._things[:count] = obstacles[:count]
                self._things_at = things_at
        follow(self._rules, self._state, sightings.whole, self._things, count, things_at, self._world.whole)
        return self._world

    def predict(self, at: Instant) -> WorldTable:
        """The world at any instant, as the frames so far tell it. Changes no state.

        It carries the last frame's number; the ball is hidden if that frame did not show it.
        """
        tell(self._rules, self._state, at, self._world.whole)
        return self._world


@kernel
def follow(rules: Table, state: Table, seen: Table, things: Table, count: int, things_at: int, world: Table) -> bool:
    """`Tracker.update` on tables of one row (RULES, STATE, SIGHTINGS and WORLD); False: the frame was refused.

    things: rows of OBSTACLE, of which count hold, of the obstacle frame things_at (NEVER: there is none).
    """
    memory, frame = state[0], seen[0]
    at = frame.grabbed
    if memory.frames and at <= memory.grabbed:
        memory.refused += 1
        tell(rules, state, memory.grabbed, world)
        return False
    memory.frames += 1
    memory.grabbed, memory.frame_number = at, frame.frame_number
    update_robots(rules[0], memory, frame, at)
    update_ball(rules[0], memory, frame, at)
    if things_at > memory.obstacles_at:
        write_robots(rules[0], memory, things_at, world[0])
        update_obstacles(rules[0], memory, things, count, things_at, world[0])
    tell(rules, state, at, world)
    return True


@kernel
def tell(rules: Table, state: Table, at: int, world: Table) -> None:
    """`Tracker.predict` on tables of one row: fill a world's table."""
    memory, told = state[0], world[0]
    told.frame_number, told.at = memory.frame_number, at
    write_robots(rules[0], memory, at, told)
    write_ball(rules[0], memory, at, told)
    write_obstacles(rules[0], memory, at, told)
