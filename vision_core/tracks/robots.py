"""The lives of robots' tracks.

Each frame, in this order:

1. Tracks unseen for longer than their validity end.
2. A sighting with an id continues the track of that team and id, if it lies within the track's reach.
3. What is left over (sightings without an id, or whose id's track is elsewhere) continues the nearest track of
   the same team that step 2 left over. The track keeps its id: place decides before name.
4. A foreign id read twice in a row on the same track is believed: the track takes it over. Whoever held
   it loses it, unless it was read there, too, in the same frame (two robots with one marker: the one
   that had the id keeps it, the other one stays nameless). A nameless track takes a free id at once.
5. Every other sighting starts a track **at once**, so that a robot is served from its first frame and is an edge
   in the others' views. If its id is alive elsewhere, the new track is nameless: one false reading moves no
   robot, a true jump is confirmed by the next frame (rule 4).
6. A nameless track that was seen only once is dropped by the first frame that does not show it.
7. Beyond MOST_TRACKS the nameless that were unseen for longest go first, so that a flicker of false robots costs
   bounded time and room.

Recall goes before precision here: a missing robot silences its client and is a collision for the others, a false one
is an edge too many for one frame. An id is evidence of its own (five dots that fit), so a robot with an
id is predicted for its whole validity even when it was seen but once; a nameless one must be seen twice.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from vision_core.clock import NS_PER_MS, Instant, seconds_between
from vision_core.geometry import wrap_angle
from vision_core.settings import TrackSettings
from vision_core.tracks.assignment import assign, distances_between, gates
from vision_core.tracks.kalman import Motion, density_from_acceleration, started
from vision_core.types.objects import RobotSighting, Team
from vision_core.types.tracks import RobotTrack

CONFIRMING = 2
"""So many readings in a row give a track another id."""
MOST_TRACKS = 64
"""Twice two full teams."""
UNKNOWN_HEADING_VARIANCE = math.pi**2 / 3.0
"""Of an angle that may be any."""


@dataclass(slots=True, eq=False)
class _Track:
    """A robot as of its last sighting."""

    team: Team
    id: int | None
    place: Motion
    heading: Motion
    confidence: float
    seen: Instant
    sightings: int
    claim: int | None
    """A foreign id that was read here."""
    claims: int
    """How often in a row."""


class RobotTracks:
    """All robots' tracks."""

    def __init__(self, settings: TrackSettings) -> None:
        self._validity_ns = round(settings.validity_ms * NS_PER_MS)
        self._gate_m = settings.gate_m
        self._noise = settings.robot_noise_m**2
        self._heading_noise = settings.heading_noise_rad**2
        self._acceleration = settings.robot_acceleration_m_s2
        self._turn_acceleration = settings.robot_turn_acceleration_rad_s2
        self._density = density_from_acceleration(self._acceleration)
        self._turn_density = density_from_acceleration(self._turn_acceleration)
        self._tracks: list[_Track] = []

    def update(self, sightings: Sequence[RobotSighting], at: Instant) -> None:
        """Take in one frame's robots, grabbed at an instant later than all before."""
        self._tracks = [track for track in self._tracks if at - track.seen <= self._validity_ns]
        tracks = list(self._tracks)
        places = [track.place.predicted(seconds_between(track.seen, at), self._density) for track in tracks]
        by_name, by_place = self._pairs(tracks, places, sightings)
        for row, column in by_name + by_place:
            self._correct(tracks[row], places[row], sightings[column], at)
        read = {(tracks[row].team, tracks[row].id) for row, _ in by_name}
        for row, _ in by_name:
            tracks[row].claim, tracks[row].claims = None, 0
        for row, column in by_place:
            self._weigh_id(tracks[row], sightings[column].id, read, at)
        taken = {column for _, column in by_name + by_place}
        for column, sighting in enumerate(sightings):
            if column not in taken:
                self._start(sighting, read, at)
        alive = [track for track in self._tracks if track.seen == at or track.id is not None or track.sightings > 1]
        alive.sort(key=lambda track: (track.id is not None, track.seen), reverse=True)
        self._tracks = alive[:MOST_TRACKS]

    def at(self, at: Instant) -> tuple[RobotTrack, ...]:
        """All robots predicted to an instant, ordered by team and id, the nameless last."""
        living = [track for track in self._tracks if at - track.seen <= self._validity_ns]
        living.sort(key=lambda track: (track.team, track.id is None, track.id or 0))
        return tuple(self._record(track, at) for track in living)

    def _pairs(
        self, tracks: Sequence[_Track], places: Sequence[Motion], sightings: Sequence[RobotSighting]
    ) -> tuple[list[tuple[int, int]], list[tuple[int, int]]]:
        """Pairs (track, sighting) that agree in team and id, then pairs that agree in team and place only."""
        if not tracks or not sightings:
            return [], []
        distances = distances_between(
            np.array([place.value for place in places]), np.array([(s.x_m, s.y_m) for s in sightings])
        )
        reach = gates(np.array([place.variance + self._noise for place in places]), self._gate_m)
        kin = np.array([[track.team is s.team for s in sightings] for track in tracks])
        same = np.array([[track.id is not None and track.id == s.id for s in sightings] for track in tracks])
        by_name = assign(np.where(kin & same, distances, np.inf), reach)
        for row, column in by_name:
            kin[row, :] = False
            kin[:, column] = False
        return by_name, assign(np.where(kin, distances, np.inf), reach)

    def _correct(self, track: _Track, place: Motion, sighting: RobotSighting, at: Instant) -> None:
        track.place = place.corrected(np.array([sighting.x_m, sighting.y_m]) - place.value, self._noise)
        heading = track.heading.predicted(seconds_between(track.seen, at), self._turn_density)
        if sighting.heading_rad is not None:
            innovation = wrap_angle(sighting.heading_rad - heading.value[0])
            heading = heading.corrected(np.array([innovation]), self._heading_noise)
        track.heading = heading
        track.confidence = sighting.confidence
        track.seen = at
        track.sightings += 1

    def _weigh_id(self, track: _Track, reading: int | None, read: set[tuple[Team, int | None]], at: Instant) -> None:
        """Rule 4: a track that was continued by place, not by name, may take over the id that was read."""
        if reading is None:
            return
        if (track.team, reading) in read:
            track.claim, track.claims = None, 0
            return
        track.claims = track.claims + 1 if track.claim == reading else 1
        track.claim = reading
        holder = self._holder(track.team, reading)
        free = track.id is None and holder is None
        if track.claims < CONFIRMING and not free:
            return
        if holder is not None:
            holder.id = None
            if holder.seen != at:
                self._tracks.remove(holder)
        track.id, track.claim, track.claims = reading, None, 0

    def _start(self, sighting: RobotSighting, read: set[tuple[Team, int | None]], at: Instant) -> None:
        """Rule 5."""
        contested = sighting.id is not None and self._holder(sighting.team, sighting.id) is not None
        claims = int(contested and (sighting.team, sighting.id) not in read)
        angle, angle_noise = sighting.heading_rad, self._heading_noise
        if angle is None:
            angle, angle_noise = 0.0, UNKNOWN_HEADING_VARIANCE
        self._tracks.append(
            _Track(
                team=sighting.team,
                id=None if contested else sighting.id,
                place=started(np.array([sighting.x_m, sighting.y_m]), self._noise, self._acceleration),
                heading=started(np.array([angle]), angle_noise, self._turn_acceleration),
                confidence=sighting.confidence,
                seen=at,
                sightings=1,
                claim=sighting.id if claims else None,
                claims=claims,
            )
        )

    def _holder(self, team: Team, marker: int) -> _Track | None:
        for track in self._tracks:
            if track.team is team and track.id == marker:
                return track
        return None

    def _record(self, track: _Track, at: Instant) -> RobotTrack:
        duration = seconds_between(track.seen, at)
        place = track.place.predicted(duration, self._density)
        heading = track.heading.predicted(duration, self._turn_density)
        return RobotTrack(
            team=track.team,
            id=track.id,
            x_m=float(place.value[0]),
            y_m=float(place.value[1]),
            heading_rad=wrap_angle(float(heading.value[0])),
            vx_m_s=float(place.rate[0]),
            vy_m_s=float(place.rate[1]),
            turn_rad_s=float(heading.rate[0]),
            position_sd_m=place.sd,
            heading_sd_rad=heading.sd,
            confidence=track.confidence,
            seen=track.seen,
        )
