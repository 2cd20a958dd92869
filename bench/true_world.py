"""Where the robots of a running service's simulated camera truly are: the same match, played once more.

Equal seeds give equal matches whatever the frame rate, so a second world, played in steps of a frame, passes through
the same poses. How far it has come in the service is found by laying the tracks of some calm frames over it.
"""

import numpy as np
from numpy.typing import NDArray

from vision_core.capture.synthetic.world import World as SimulatedWorld
from vision_core.clock import Instant, seconds_between
from vision_core.geometry import Floats
from vision_core.settings.schema import Settings
from vision_core.types.tracks import RobotTrack, World

MATCH_M = 0.06
"""A robot is where it truly is when its track lies so near; a radius and a half."""
ALIGNED_M = 0.03
"""The match is found when half of the tracks lie so near."""
STEPS_PER_S = 30.0

Named = dict[tuple[str, int], RobotTrack]


class TrueWorld:
    """The true places of all robots at the instants of a service."""

    def __init__(self, settings: Settings) -> None:
        self._world = SimulatedWorld(settings)
        self.robots: list[tuple[str, int]] = [(str(team), number) for team, number in self._world.robots_worn]
        """Team and id of each."""
        self._played: list[Floats] = [self._world.snapshot().robots[:, :2]]
        self._start: Instant | None = None
        self._first_step = 0

    def align(self, worlds: list[World], most_s: float) -> bool:
        """Find the match's time at the first of some worlds, at most so long after its start; False when it is not
        found."""
        steps = [round(seconds_between(worlds[0].at, world.at) * STEPS_PER_S) for world in worlds]
        last = round(most_s * STEPS_PER_S)
        played = self._until(last + steps[-1])
        distances = []
        for step, world in zip(steps, worlds, strict=True):
            named = named_tracks(world)
            for row, robot in enumerate(self.robots):
                if robot in named:
                    track = named[robot]
                    place = np.array([track.x_m, track.y_m])
                    distances.append(np.hypot(*(played[step : step + last + 1, row] - place).T))
        if not distances:
            return False
        medians = np.median(distances, axis=0)
        self._start, self._first_step = worlds[0].at, int(medians.argmin())
        return bool(medians.min() <= ALIGNED_M)

    def at(self, instant: Instant) -> Floats:
        """Places of all robots, shape (n, 2), after ``align``."""
        assert self._start is not None
        step = self._first_step + seconds_between(self._start, instant) * STEPS_PER_S
        whole = int(step)
        before, after = self._until(whole + 1)[whole : whole + 2]
        places: Floats = before + (after - before) * (step - whole)
        return places

    def score(self, world: World) -> tuple[int, int]:
        """How many robots have their right ids in a world, and how many wear another robot's."""
        places, named = self.at(world.at), named_tracks(world)
        right = wrong = 0
        for row, robot in enumerate(self.robots):
            if robot not in named:
                continue
            away = np.hypot(*(places - (named[robot].x_m, named[robot].y_m)).T)
            right += bool(away[row] <= MATCH_M)
            wrong += bool(away[row] > MATCH_M and away.min() <= MATCH_M)
        return right, wrong

    def _until(self, step: int) -> NDArray[np.float64]:
        while len(self._played) <= step:
            self._world.advance(1.0 / STEPS_PER_S)
            self._played.append(self._world.snapshot().robots[:, :2])
        played: NDArray[np.float64] = np.array(self._played[: step + 1])
        return played


def named_tracks(world: World) -> Named:
    """The tracks with an id, by team and id."""
    return {(str(track.team), track.id): track for track in world.robots if track.id is not None}
