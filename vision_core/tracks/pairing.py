"""Gated one-to-one assignment of tracks and sightings, greedy: the nearest pair first.

Robots do not pass through each other, and between two frames a robot moves less than its own width
from its predicted position. So the nearest pair is a correct pair, and greedy assignment equals optimal
assignment. Where they differ (an object jumped), a minimal total distance would move a second,
well-tracked robot to make room for the first; greedy assignment leaves the well-tracked robot where it is.
"""

import math

from vision_core.native.kernels import kernel
from vision_core.tracks.state import GATE_SIGMAS, Row
from vision_core.types.tables import NO_ID, Table


@kernel
def squared_gate(variance: float, gate_m: float) -> float:
    """Largest squared distance of a sighting from its track's prediction [m^2]: of gate_m, or of three standard
    deviations where these are larger.

    variance: per axis, of prediction and sighting together [m^2].
    """
    return max(gate_m**2, GATE_SIGMAS**2 * variance)


@kernel
def pair_nearest(parameters: Row, state: Row, count: int, sightings: Table, found: int, pairs: int, by_id: bool) -> int:
    """Append pairs (track, sighting) to state.pairs, nearest first; returns how many pairs there are then.

    The team of a pair agrees, and the id when by_id. Tracks that are `paired` and sightings that are `taken` are
    skipped, and marked so when they form a pair.
    """
    tracks, taken = state.robots, state.taken
    for row in range(count):
        if not tracks[row].paired:
            find_nearest(parameters, tracks[row], sightings, found, taken, by_id)
    while True:
        # The free track with the smallest distance to its nearest sighting.
        best = -1
        for row in range(count):
            if tracks[row].paired or tracks[row].nearest < 0:
                continue
            if best < 0 or tracks[row].distance_m2 < tracks[best].distance_m2:
                best = row
        if best < 0:
            return pairs
        column = tracks[best].nearest
        if taken[column]:  # a nearer track has it: this one takes its next best sighting
            find_nearest(parameters, tracks[best], sightings, found, taken, by_id)
            continue
        tracks[best].paired = taken[column] = 1
        state.pairs[pairs, 0], state.pairs[pairs, 1] = best, column
        pairs += 1


@kernel
def find_nearest(parameters: Row, track: Row, sightings: Table, found: int, taken: Table, by_id: bool) -> None:
    """Set `nearest` and `distance_m2` of a track to the nearest free sighting within its gate; -1 and inf: none."""
    track.nearest, track.distance_m2 = -1, math.inf
    for column in range(found):
        sighting = sightings[column]
        if taken[column] or sighting.team != track.team:
            continue
        if by_id and (track.id == NO_ID or track.id != sighting.id):
            continue
        distance = (sighting.x_m - track.predicted_x_m) ** 2 + (sighting.y_m - track.predicted_y_m) ** 2
        variance = track.predicted_variance + parameters.robot_noise + sighting.position_sd_m**2
        if distance < track.distance_m2 and distance <= squared_gate(variance, parameters.gate_m):
            track.nearest, track.distance_m2 = column, distance
