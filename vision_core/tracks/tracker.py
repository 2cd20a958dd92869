"""The state of the stage: one tracker per service."""

import math

from vision_core.clock import Instant
from vision_core.settings import TrackSettings
from vision_core.tracks.ball import BallLife
from vision_core.tracks.robots import RobotTracks
from vision_core.types.objects import Sightings
from vision_core.types.tracks import World


class Tracker:
    """Turns sightings, frame by frame, into the state of the field at any instant.

    A robot's track starts with its first sighting and is predicted for ``tracks.validity_ms`` past its last
    one; the ball's for ``tracks.ball_validity_ms``. An id (or a ball) that appears beyond its track's gate does
    not move it at once: the track starts over there only when a second sighting confirms the new place. The
    rules stand in ``vision_core.tracks.robots`` and ``vision_core.tracks.ball``.
    """

    def __init__(self, settings: TrackSettings) -> None:
        self._robots = RobotTracks(settings)
        self._ball = BallLife(settings)
        self._frame_number = 0
        self._grabbed: Instant | None = None
        self.refused = 0
        """Frames that came late or twice, and changed nothing."""

    def update(self, sightings: Sightings) -> World:
        """Take in one frame and return the world at its grab instant.

        A frame that is not newer than the last one is refused: it is counted in ``refused``, and the world of
        the last frame is returned (its ``at`` tells). Sightings at no finite place are ignored.
        """
        at = sightings.grabbed
        if self._grabbed is not None and at <= self._grabbed:
            self.refused += 1
            return self.predict(self._grabbed)
        self._grabbed = at
        self._frame_number = sightings.frame_number
        self._robots.update([s for s in sightings.robots if math.isfinite(s.x_m + s.y_m)], at)
        self._ball.update([s for s in sightings.balls if math.isfinite(s.x_m + s.y_m)], at)
        return self.predict(at)

    def predict(self, at: Instant) -> World:
        """The world at any instant, as the frames so far tell it. Changes no state.

        It carries the last frame's number; the ball is hidden if that frame did not show it.
        """
        frame = at if self._grabbed is None else self._grabbed
        return World(self._frame_number, at, self._robots.at(at), self._ball.at(at, frame), ())
