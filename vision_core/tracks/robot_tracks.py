"""The tracks of robots.

Each frame, in this order:

1. Tracks unseen for longer than their validity are deleted.
2. A sighting with an id continues the track of that team and id, if it lies within the track's gate.
3. The remaining sightings (without an id, or outside the gate of the track with their id) continue the nearest track
   of the same team that step 2 left over. The track keeps its id: position decides before id.
4. Another id that is read eight times in a row on the same track is accepted: the track takes it over; a track without
   an id takes one that another track has when it is read twice, and a free one at once. The track that had it loses it,
   unless its own id was read in the same frame, too (two robots with one marker: the track that had the id keeps it,
   the other one stays without).
5. Every other sighting starts a track **at once**, so that a robot is served from its first frame and is an edge
   in the others' views. If its id belongs to another track, the new track has no id: one false reading moves no
   robot, a true jump is confirmed by the next frame (rule 4).
6. A track without an id that was seen only once is deleted by the first frame that does not show it.
7. Beyond MAX_ROBOTS, tracks without an id that were unseen for longest are deleted first, so that a flicker of false
   robots costs bounded time and memory.

Recall goes before precision here: a missing robot silences its client and is a collision for the others, a false one
is an edge too many for one frame. An id is evidence of its own (five dots in their places), so a robot with an
id is predicted for its whole validity even after a single sighting; one without an id must be seen twice.

A heading that was not seen is predicted; before its first sighting it has the variance of a uniform distribution.
"""

import math

from vision_core.clock import NS_PER_S
from vision_core.native.angles import wrap_angle
from vision_core.native.kernels import kernel
from vision_core.tracks.filters import corrected, predicted
from vision_core.tracks.pairing import pair_nearest
from vision_core.tracks.state import UNKNOWN_HEADING_VARIANCE, Row
from vision_core.types.tables import MAX_ROBOTS, NO_ID, Table

MIN_READINGS = 2
"""So many readings in a row give a track without an id that of another track."""
RENAMING_READINGS = 8
"""So many give a track with an id another one: in a light that has just changed ids are misread now and then, until the
colors have followed."""
ROBOTS = 0
"""Index of the robots in the counts of every table."""


@kernel
def update_robots(parameters: Row, state: Row, seen: Row, at: int) -> None:
    """Process the robots of one frame, grabbed at an instant later than all before.

    Rows of PARAMETERS, TRACKER_STATE and SIGHTINGS.
    """
    tracks, sightings, pairs, taken = state.robots, seen.robots, state.pairs, state.taken
    predict_all(parameters, state, at)
    count = state.counts[ROBOTS]
    found = seen.counts[ROBOTS]
    # Sightings without a finite position are never used.
    for column in range(found):
        sighting = sightings[column]
        taken[column] = not math.isfinite(sighting.x_m + sighting.y_m + sighting.position_sd_m)
    # Pairs by id, then by position alone; pairs 0..by_id agree in their ids.
    by_id = pair_nearest(parameters, state, count, sightings, found, 0, True)
    by_position = pair_nearest(parameters, state, count, sightings, found, by_id, False)
    for pair in range(by_position):
        correct_track(parameters, tracks[pairs[pair, 0]], sightings[pairs[pair, 1]], at)
    for pair in range(by_id):
        track = tracks[pairs[pair, 0]]
        track.id_read = 1
        track.candidate_id, track.candidate_readings = NO_ID, 0
    for pair in range(by_id, by_position):
        resolve_id(tracks, count, tracks[pairs[pair, 0]], sightings[pairs[pair, 1]].id, at)
    # The sightings that are left start tracks.
    for column in range(found):
        if not taken[column]:
            start_track(parameters, tracks, count, sightings[column], at)
            count += 1
    state.counts[ROBOTS] = delete_expired(tracks, count, at)


@kernel
def predict_all(parameters: Row, state: Row, at: int) -> None:
    """Rule 1, and the position of every other track predicted to an instant."""
    tracks = state.robots
    kept = 0
    for row in range(state.counts[ROBOTS]):
        if at - tracks[row].seen > parameters.validity_ns:
            continue
        if kept != row:
            tracks[kept] = tracks[row]
        track = tracks[kept]
        t = (at - track.seen) / NS_PER_S
        track.predicted_x_m = track.x_m + track.vx_m_s * t
        track.predicted_y_m = track.y_m + track.vy_m_s * t
        track.predicted_variance, track.predicted_covariance, track.predicted_rate_variance = predicted(
            track.variance, track.covariance, track.rate_variance, t, parameters.robot_density
        )
        track.paired = track.id_read = track.expired = 0
        kept += 1
    state.counts[ROBOTS] = kept


@kernel
def correct_track(parameters: Row, track: Row, sighting: Row, at: int) -> None:
    """Correct a track that is predicted to this frame with its sighting."""
    noise = parameters.robot_noise + sighting.position_sd_m**2
    gain, rate_gain, track.variance, track.covariance, track.rate_variance = corrected(
        track.predicted_variance, track.predicted_covariance, track.predicted_rate_variance, noise
    )
    dx, dy = sighting.x_m - track.predicted_x_m, sighting.y_m - track.predicted_y_m
    track.x_m, track.y_m = track.predicted_x_m + gain * dx, track.predicted_y_m + gain * dy
    track.vx_m_s += rate_gain * dx
    track.vy_m_s += rate_gain * dy
    update_heading(parameters, track, sighting, (at - track.seen) / NS_PER_S)
    track.confidence = sighting.confidence
    track.seen = at
    track.sightings += 1


@kernel
def update_heading(parameters: Row, track: Row, sighting: Row, t: float) -> None:
    """Predict a track's heading over a time t [s], and correct it if the sighting has a heading."""
    seen = math.isfinite(sighting.heading_rad + sighting.heading_sd_rad)
    if not track.heading_known:
        if seen:
            start_heading(parameters, track, sighting)
        return
    track.heading_rad += track.turn_rad_s * t
    track.heading_variance, track.heading_covariance, track.turn_variance = predicted(
        track.heading_variance, track.heading_covariance, track.turn_variance, t, parameters.turn_density
    )
    if not seen:
        return
    noise = parameters.heading_noise + sighting.heading_sd_rad**2
    gain, rate_gain, track.heading_variance, track.heading_covariance, track.turn_variance = corrected(
        track.heading_variance, track.heading_covariance, track.turn_variance, noise
    )
    innovation = wrap_angle(sighting.heading_rad - track.heading_rad)
    track.heading_rad = wrap_angle(track.heading_rad + gain * innovation)
    track.turn_rad_s += rate_gain * innovation


@kernel
def start_heading(parameters: Row, track: Row, sighting: Row) -> None:
    """Set a track's first heading."""
    track.heading_known = 1
    track.heading_rad, track.turn_rad_s = sighting.heading_rad, 0.0
    track.heading_variance = parameters.heading_noise + sighting.heading_sd_rad**2
    track.heading_covariance, track.turn_variance = 0.0, parameters.turn_start


@kernel
def find_by_id(tracks: Table, count: int, team: int, marker: int) -> int:
    """Row of the track that has an id, -1 for none."""
    for row in range(count):
        if tracks[row].team == team and tracks[row].id == marker and not tracks[row].expired:
            return row
    return -1


@kernel
def resolve_id(tracks: Table, count: int, track: Row, reading: int, at: int) -> None:
    """Rule 4: a track that was continued by its position may take over the id that was read."""
    if reading == NO_ID:
        return
    owner = find_by_id(tracks, count, track.team, reading)
    if owner >= 0 and tracks[owner].id_read:
        track.candidate_id, track.candidate_readings = NO_ID, 0
        return
    track.candidate_readings = track.candidate_readings + 1 if track.candidate_id == reading else 1
    track.candidate_id = reading
    needed = RENAMING_READINGS if track.id != NO_ID else MIN_READINGS if owner >= 0 else 1
    if track.candidate_readings < needed:
        return
    # Accepted. The former owner goes on without an id, or is deleted if this frame did not show it.
    if owner >= 0:
        tracks[owner].id = NO_ID
        tracks[owner].expired = tracks[owner].seen != at
    track.id, track.candidate_id, track.candidate_readings = reading, NO_ID, 0


@kernel
def start_track(parameters: Row, tracks: Table, count: int, sighting: Row, at: int) -> None:
    """Rule 5: fill in a new track in row count."""
    track = tracks[count]
    track.team, track.id = sighting.team, sighting.id
    track.candidate_id, track.candidate_readings = NO_ID, 0
    owner = find_by_id(tracks, count, sighting.team, sighting.id) if sighting.id != NO_ID else -1
    if owner >= 0:
        track.id = NO_ID
        if not tracks[owner].id_read:
            track.candidate_id, track.candidate_readings = sighting.id, 1
    track.x_m, track.y_m, track.vx_m_s, track.vy_m_s = sighting.x_m, sighting.y_m, 0.0, 0.0
    track.variance = parameters.robot_noise + sighting.position_sd_m**2
    track.covariance, track.rate_variance = 0.0, parameters.robot_start
    track.heading_known, track.heading_rad, track.turn_rad_s = 0, 0.0, 0.0
    track.heading_variance, track.heading_covariance, track.turn_variance = UNKNOWN_HEADING_VARIANCE, 0.0, 0.0
    if math.isfinite(sighting.heading_rad + sighting.heading_sd_rad):
        start_heading(parameters, track, sighting)
    track.confidence, track.seen, track.sightings = sighting.confidence, at, 1
    track.paired = track.id_read = track.expired = 0


@kernel
def delete_expired(tracks: Table, count: int, at: int) -> int:
    """Rules 6 and 7; returns how many tracks are left. Their order does not change."""
    # Rule 6, and tracks whose id another track took over.
    kept = 0
    for row in range(count):
        track = tracks[row]
        if track.expired or (track.seen != at and track.id == NO_ID and track.sightings == 1):
            continue
        if kept != row:
            tracks[kept] = tracks[row]
        kept += 1
    # Rule 7: one by one, the least useful track goes.
    while kept > MAX_ROBOTS:
        least = 0
        for row in range(1, kept):
            has_id, least_has_id = tracks[row].id != NO_ID, tracks[least].id != NO_ID
            if has_id < least_has_id or (has_id == least_has_id and tracks[row].seen <= tracks[least].seen):
                least = row
        kept -= 1
        for row in range(least, kept):
            tracks[row] = tracks[row + 1]
    return kept


@kernel
def write_robots(parameters: Row, state: Row, at: int, world: Row) -> None:
    """Write all robots predicted to an instant, sorted by team and id, without an id last. world: a row of WORLD."""
    tracks, rows = state.robots, state.sorted
    count = 0
    for row in range(state.counts[ROBOTS]):
        if at - tracks[row].seen > parameters.validity_ns:
            continue
        # Insertion sort: there are few robots, and they are almost sorted.
        place = count
        while place > 0 and _sort_key(tracks[rows[place - 1]]) > _sort_key(tracks[row]):
            rows[place] = rows[place - 1]
            place -= 1
        rows[place] = row
        count += 1
    world.counts[ROBOTS] = count
    for index in range(count):
        _write_robot(parameters, tracks[rows[index]], at, world.robots[index])


@kernel
def _sort_key(track: Row) -> int:
    key: int = (track.team << 40) + (track.id if track.id != NO_ID else 1 << 32)
    return key


@kernel
def _write_robot(parameters: Row, track: Row, at: int, written: Row) -> None:
    """Predict one track into a row of ROBOT_TRACK."""
    t = (at - track.seen) / NS_PER_S
    written.team, written.id = track.team, track.id
    written.x_m, written.y_m = track.x_m + track.vx_m_s * t, track.y_m + track.vy_m_s * t
    written.vx_m_s, written.vy_m_s = track.vx_m_s, track.vy_m_s
    written.heading_rad, written.turn_rad_s = wrap_angle(track.heading_rad + track.turn_rad_s * t), track.turn_rad_s
    variance, _, _ = predicted(track.variance, track.covariance, track.rate_variance, t, parameters.robot_density)
    written.position_sd_m = math.sqrt(variance)
    variance, _, _ = predicted(
        track.heading_variance, track.heading_covariance, track.turn_variance, t, parameters.turn_density
    )
    written.heading_sd_rad = math.sqrt(min(variance, UNKNOWN_HEADING_VARIANCE))
    written.confidence, written.seen = track.confidence, track.seen
