"""The life of the ball's track. There is one ball.

- No track: the sighting with the highest confidence starts one at once.
- A track: the sighting **nearest to the prediction** within its reach continues it, however confident others
  farther away are.
- None within reach: the ball is predicted and called hidden. What was seen elsewhere is remembered, and a
  sighting near such a place in the next frame moves the ball there. So a false orange spot moves nothing, and
  a ball that was carried, kicked hard or uncovered elsewhere is found in its second frame.
- Unseen for longer than its validity: it is gone.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from vision_core.clock import NS_PER_MS, Instant, seconds_between
from vision_core.settings import TrackSettings
from vision_core.tracks.assignment import assign, distances_between, gates
from vision_core.tracks.kalman import Motion, density_from_acceleration, started
from vision_core.types.objects import BallSighting
from vision_core.types.tracks import BallTrack


@dataclass(frozen=True, slots=True)
class _Track:
    """A ball as of its last sighting."""

    place: Motion
    seen: Instant


class BallLife:
    """The ball's track, and the places where it may have jumped to."""

    def __init__(self, settings: TrackSettings) -> None:
        self._validity_ns = round(settings.ball_validity_ms * NS_PER_MS)
        self._gate_m = settings.gate_m
        self._noise = settings.ball_noise_m**2
        self._acceleration = settings.ball_acceleration_m_s2
        self._density = density_from_acceleration(self._acceleration)
        self._track: _Track | None = None
        self._elsewhere: list[_Track] = []

    def update(self, balls: Sequence[BallSighting], at: Instant) -> None:
        """Take in one frame's balls, best first, grabbed at an instant later than all before."""
        if self._track is not None and at - self._track.seen > self._validity_ns:
            self._track = None
        fresh = [self._started(ball, at) for ball in balls]
        if self._track is None:
            self._track, self._elsewhere = (fresh[0] if fresh else None), fresh[1:]
            return
        found = self._continued([self._track], balls, at) or self._continued(self._elsewhere, balls, at)
        if found is not None:
            self._track, self._elsewhere = found, []
        else:
            self._elsewhere = fresh

    def at(self, at: Instant, frame: Instant) -> BallTrack | None:
        """The ball predicted to an instant; hidden if the frame of another instant did not show it."""
        track = self._track
        if track is None or at - track.seen > self._validity_ns:
            return None
        place = track.place.predicted(seconds_between(track.seen, at), self._density)
        return BallTrack(
            x_m=float(place.value[0]),
            y_m=float(place.value[1]),
            vx_m_s=float(place.rate[0]),
            vy_m_s=float(place.rate[1]),
            position_sd_m=place.sd,
            hidden=track.seen != frame,
            seen=track.seen,
        )

    def _started(self, ball: BallSighting, at: Instant) -> _Track:
        return _Track(started(np.array([ball.x_m, ball.y_m]), self._noise, self._acceleration), at)

    def _continued(self, tracks: Sequence[_Track], balls: Sequence[BallSighting], at: Instant) -> _Track | None:
        """The pair of a track and a sighting that lie nearest to each other within reach, as a track."""
        if not tracks or not balls:
            return None
        places = [track.place.predicted(seconds_between(track.seen, at), self._density) for track in tracks]
        reach = gates(np.array([place.variance + self._noise for place in places]), self._gate_m)
        found = np.array([(ball.x_m, ball.y_m) for ball in balls])
        pairs = assign(distances_between(np.array([place.value for place in places]), found), reach)
        if not pairs:
            return None
        row, column = pairs[0]
        return _Track(places[row].corrected(found[column] - places[row].value, self._noise), at)
