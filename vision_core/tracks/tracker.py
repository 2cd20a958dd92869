"""The tracker, and the two kernels that are the whole stage."""

from collections.abc import Iterator
from contextlib import contextmanager

import numpy as np

from vision_core.clock import Instant
from vision_core.native.kernels import kernel
from vision_core.native.rewind import Rewind
from vision_core.settings.schema import RobotSettings, TrackSettings
from vision_core.tracks.ball_tracks import update_ball, write_ball
from vision_core.tracks.obstacle_tracks import update_obstacles, write_obstacles
from vision_core.tracks.robot_tracks import update_robots, write_robots
from vision_core.tracks.state import NEVER, empty_state, parameters_from
from vision_core.types.tables import MAX_OBSTACLES, OBSTACLE, SightingsTable, Table, WorldTable


class Tracker:
    """Turns sightings, frame by frame, into the state of the field at any instant. A service has one tracker.

    A robot's track starts with its first sighting and is predicted for ``tracks.validity_ms`` after its last
    one; the ball's for ``tracks.ball_validity_ms``; an obstacle's for ``tracks.obstacle_validity_ms``. An id (or
    a ball) that appears outside its track's gate does not move the track at once: only a second sighting at the new
    position does. The rules stand in ``robot_tracks``, ``ball_tracks`` and ``obstacle_tracks``.

    Every call returns the same table, the tracker's own: the next call overwrites it.
    """

    def __init__(self, settings: TrackSettings, robots: RobotSettings) -> None:
        self._parameters = parameters_from(settings, robots)
        self._state = empty_state()
        self._obstacles: Table = np.zeros(MAX_OBSTACLES, dtype=OBSTACLE)
        self._obstacles_at = NEVER
        self._world = WorldTable()
        self._rewind = Rewind([self._state])
        self._frame: tuple[int, int] = 0, NEVER
        """How many obstacles the last frame had, and when they were seen."""

    def configure(self, settings: TrackSettings, robots: RobotSettings) -> None:
        """Go on with other settings from the next frame on; tracks stay."""
        self._parameters = parameters_from(settings, robots)

    @property
    def refused(self) -> int:
        """Frames that came late or twice, and changed nothing."""
        return int(self._state["refused"][0])

    def update(
        self, sightings: SightingsTable, obstacles: Table | None = None, obstacles_at: Instant | None = None
    ) -> WorldTable:
        """Process one frame and return the world at its grab instant.

        A frame that is not newer than the last one is refused: it is counted in ``refused``, and the world of
        the last frame is returned, with that frame's ``at``. Sightings without a finite position are ignored.

        obstacles: the newest rows of OBSTACLE, seen in the frame that was grabbed at obstacles_at (None: in this
        one). The obstacles of one frame may be passed again and again; they are processed once.
        """
        count = 0
        at = NEVER
        if obstacles is not None:
            at = int(sightings.whole["grabbed"][0]) if obstacles_at is None else obstacles_at
            count = min(len(obstacles), MAX_OBSTACLES)
            if at != self._obstacles_at:
                self._obstacles[:count] = obstacles[:count]
                self._obstacles_at = at
        self._frame = count, at
        self._rewind.keep()
        return self._update(sightings)

    @contextmanager
    def rehearsed(self, sightings: SightingsTable) -> Iterator[WorldTable | None]:
        """The world of the last frame, made once more from the state before it. Afterwards all is as it was.

        sightings: those of the last frame. None: there was no frame yet.
        """
        with self._rewind.rewound() as was_run:
            yield self._update(sightings) if was_run else None

    def _update(self, sightings: SightingsTable) -> WorldTable:
        count, at = self._frame
        update_tracks(self._parameters, self._state, sightings.whole, self._obstacles, count, at, self._world.whole)
        return self._world

    def predict(self, at: Instant) -> WorldTable:
        """The world at any instant, predicted from the frames so far. Changes no state.

        It has the last frame's number; the ball is hidden if that frame did not show it.
        """
        write_world(self._parameters, self._state, at, self._world.whole)
        return self._world


@kernel
def update_tracks(
    parameters: Table, state: Table, seen: Table, obstacles: Table, count: int, obstacles_at: int, world: Table
) -> bool:
    """`Tracker.update` on tables of one row (PARAMETERS, TRACKER_STATE, SIGHTINGS, WORLD); False: frame refused.

    obstacles: rows of OBSTACLE, of which the first count are valid, of the obstacle frame grabbed at obstacles_at
    (NEVER: there is none).
    """
    memory, frame = state[0], seen[0]
    at = frame.grabbed
    if memory.frames and at <= memory.grabbed:
        memory.refused += 1
        write_world(parameters, state, memory.grabbed, world)
        return False
    memory.frames += 1
    memory.grabbed, memory.frame_number = at, frame.frame_number
    update_robots(parameters[0], memory, frame, at)
    update_ball(parameters[0], memory, frame, at)
    # A new obstacle frame needs the robots at its own instant, which is earlier than this frame's.
    if obstacles_at > memory.obstacles_at:
        write_robots(parameters[0], memory, obstacles_at, world[0])
        update_obstacles(parameters[0], memory, obstacles, count, obstacles_at, world[0])
    write_world(parameters, state, at, world)
    return True


@kernel
def write_world(parameters: Table, state: Table, at: int, world: Table) -> None:
    """`Tracker.predict` on tables of one row (PARAMETERS, TRACKER_STATE, WORLD): fill the world."""
    memory, written = state[0], world[0]
    written.frame_number, written.at = memory.frame_number, at
    write_robots(parameters[0], memory, at, written)
    write_ball(parameters[0], memory, at, written)
    write_obstacles(parameters[0], memory, at, written)
