"""Gated one-to-one assignment of tracks and sightings, greedy: the nearest pair first.

Robots do not pass through each other, and between two frames a robot moves less than its own width
from where it is predicted. So the nearest pair is a true pair, and greedy gives what an optimal
assignment gives; where it does not (something jumped), a minimal total distance would move a second,
well-tracked robot to make room for the first. Greedy leaves the sure ones alone.
"""

import math

from vision_core.native.kernels import kernel
from vision_core.tracks.state import GATE_SIGMAS, Row
from vision_core.types.tables import NO_ID, Table


@kernel
def reach_m2(variance: float, gate_m: float) -> float:
    """How far from its prediction a sighting may lie, squared [m^2]: gate_m, or three standard deviations of the
    distance where the two are less sure than that. variance: per axis, of prediction and sighting together [m^2]."""
    return max(gate_m**2, GATE_SIGMAS**2 * variance)


@kernel
def pair_nearest(rules: Row, state: Row, count: int, sightings: Table, found: int, pairs: int, by_name: bool) -> int:
    """Append pairs (track, sighting) to state.pairs, nearest first; how many there are then.

    Pairs agree in team, and in id when by_name. Neither side may have been paired before (`paired`, `taken`).
    """
    lives, taken = state.robots, state.taken
    for row in range(count):
        if not lives[row].paired:
            find_nearest(rules, lives[row], sightings, found, taken, by_name)
    while True:
        best = -1
        for row in range(count):
            if lives[row].paired or lives[row].nearest < 0:
                continue
            if best < 0 or lives[row].distance_m2 < lives[best].distance_m2:
                best = row
        if best < 0:
            return pairs
        column = lives[best].nearest
        if taken[column]:  # by a track that is nearer to it
            find_nearest(rules, lives[best], sightings, found, taken, by_name)
            continue
        lives[best].paired = taken[column] = 1
        state.pairs[pairs, 0], state.pairs[pairs, 1] = best, column
        pairs += 1


@kernel
def find_nearest(rules: Row, life: Row, sightings: Table, found: int, taken: Table, by_name: bool) -> None:
    """Note the free sighting within reach that lies nearest to a track's prediction: -1 where there is none."""
    life.nearest, life.distance_m2 = -1, math.inf
    for column in range(found):
        sighting = sightings[column]
        if taken[column] or sighting.team != life.team:
            continue
        if by_name and (life.id == NO_ID or life.id != sighting.id):
            continue
        distance = (sighting.x_m - life.ahead_x_m) ** 2 + (sighting.y_m - life.ahead_y_m) ** 2
        variance = life.ahead_variance + rules.robot_noise + sighting.position_sd_m**2
        if distance < life.distance_m2 and distance <= reach_m2(variance, rules.gate_m):
            life.nearest, life.distance_m2 = column, distance
