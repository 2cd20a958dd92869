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
7. Beyond MAX_ROBOTS the nameless that were unseen for longest go first, so that a flicker of false robots costs
   bounded time and room.

Recall goes before precision here: a missing robot silences its client and is a collision for the others, a false one
is an edge too many for one frame. An id is evidence of its own (five dots that fit), so a robot with an
id is predicted for its whole validity even when it was seen but once; a nameless one must be seen twice.

A heading that was not seen is predicted; before it was ever seen it may be any, and says so.
"""

import math

from vision_core.clock import NS_PER_S
from vision_core.native.kernels import kernel
from vision_core.tracks.filters import corrected, predicted
from vision_core.tracks.pairing import pair_nearest
from vision_core.tracks.state import UNKNOWN_HEADING_VARIANCE, Row
from vision_core.types.tables import MAX_ROBOTS, NO_ID, Table

CONFIRMING = 2
"""So many readings in a row give a track another id."""
ROBOTS = 0
"""Place of the robots in a table's counts."""


@kernel
def update_robots(rules: Row, state: Row, seen: Row, at: int) -> None:
    """Take in one frame's robots, grabbed at an instant later than all before. Rows of RULES, STATE and SIGHTINGS."""
    lives, sightings, pairs, taken = state.robots, seen.robots, state.pairs, state.taken
    foresee(rules, state, at)
    count = state.counts[ROBOTS]
    found = seen.counts[ROBOTS]
    for column in range(found):
        sighting = sightings[column]
        taken[column] = not math.isfinite(sighting.x_m + sighting.y_m + sighting.position_sd_m)
    by_name = pair_nearest(rules, state, count, sightings, found, 0, True)
    by_place = pair_nearest(rules, state, count, sightings, found, by_name, False)
    for pair in range(by_place):
        correct(rules, lives[pairs[pair, 0]], sightings[pairs[pair, 1]], at)
    for pair in range(by_name):
        life = lives[pairs[pair, 0]]
        life.read = 1
        life.claim, life.claims = NO_ID, 0
    for pair in range(by_name, by_place):
        weigh_id(lives, count, lives[pairs[pair, 0]], sightings[pairs[pair, 1]].id, at)
    for column in range(found):
        if not taken[column]:
            start(rules, lives, count, sightings[column], at)
            count += 1
    state.counts[ROBOTS] = bury(lives, count, at)


@kernel
def foresee(rules: Row, state: Row, at: int) -> None:
    """Rule 1, and every other track's place at an instant."""
    lives = state.robots
    kept = 0
    for row in range(state.counts[ROBOTS]):
        if at - lives[row].seen > rules.validity_ns:
            continue
        if kept != row:
            lives[kept] = lives[row]
        life = lives[kept]
        t = (at - life.seen) / NS_PER_S
        life.ahead_x_m = life.x_m + life.vx_m_s * t
        life.ahead_y_m = life.y_m + life.vy_m_s * t
        life.ahead_variance, life.ahead_covariance, life.ahead_rate_variance = predicted(
            life.variance, life.covariance, life.rate_variance, t, rules.robot_density
        )
        life.paired = life.read = life.gone = 0
        kept += 1
    state.counts[ROBOTS] = kept


@kernel
def correct(rules: Row, life: Row, sighting: Row, at: int) -> None:
    """Continue a track whose place was predicted to this frame with what the frame shows of it."""
    noise = rules.robot_noise + sighting.position_sd_m**2
    gain, rate_gain, life.variance, life.covariance, life.rate_variance = corrected(
        life.ahead_variance, life.ahead_covariance, life.ahead_rate_variance, noise
    )
    dx, dy = sighting.x_m - life.ahead_x_m, sighting.y_m - life.ahead_y_m
    life.x_m, life.y_m = life.ahead_x_m + gain * dx, life.ahead_y_m + gain * dy
    life.vx_m_s += rate_gain * dx
    life.vy_m_s += rate_gain * dy
    turn(rules, life, sighting, (at - life.seen) / NS_PER_S)
    life.confidence = sighting.confidence
    life.seen = at
    life.sightings += 1


@kernel
def turn(rules: Row, life: Row, sighting: Row, t: float) -> None:
    """Predict a track's heading over a time t [s] and correct it with a sighting's, where there is one."""
    shown = math.isfinite(sighting.heading_rad + sighting.heading_sd_rad)
    if not life.headed:
        if shown:
            face(rules, life, sighting)
        return
    life.heading_rad += life.turn_rad_s * t
    life.heading_variance, life.heading_covariance, life.turn_variance = predicted(
        life.heading_variance, life.heading_covariance, life.turn_variance, t, rules.turn_density
    )
    if not shown:
        return
    noise = rules.heading_noise + sighting.heading_sd_rad**2
    gain, rate_gain, life.heading_variance, life.heading_covariance, life.turn_variance = corrected(
        life.heading_variance, life.heading_covariance, life.turn_variance, noise
    )
    swing = wrapped(sighting.heading_rad - life.heading_rad)
    life.heading_rad = wrapped(life.heading_rad + gain * swing)
    life.turn_rad_s += rate_gain * swing


@kernel
def face(rules: Row, life: Row, sighting: Row) -> None:
    """A track's first heading."""
    life.headed = 1
    life.heading_rad, life.turn_rad_s = sighting.heading_rad, 0.0
    life.heading_variance = rules.heading_noise + sighting.heading_sd_rad**2
    life.heading_covariance, life.turn_variance = 0.0, rules.turn_start


@kernel
def wrapped(angle_rad: float) -> float:
    """The same angle in [-pi, pi) [rad]."""
    return (angle_rad + math.pi) % (2.0 * math.pi) - math.pi


@kernel
def holder_of(lives: Table, count: int, team: int, marker: int) -> int:
    """The track that has an id: its row, or -1."""
    for row in range(count):
        if lives[row].team == team and lives[row].id == marker and not lives[row].gone:
            return row
    return -1


@kernel
def weigh_id(lives: Table, count: int, life: Row, reading: int, at: int) -> None:
    """Rule 4: a track that was continued by place, not by name, may take over the id that was read."""
    if reading == NO_ID:
        return
    holder = holder_of(lives, count, life.team, reading)
    if holder >= 0 and lives[holder].read:
        life.claim, life.claims = NO_ID, 0
        return
    life.claims = life.claims + 1 if life.claim == reading else 1
    life.claim = reading
    if life.claims < CONFIRMING and (life.id != NO_ID or holder >= 0):
        return
    if holder >= 0:
        lives[holder].id = NO_ID
        lives[holder].gone = lives[holder].seen != at
    life.id, life.claim, life.claims = reading, NO_ID, 0


@kernel
def start(rules: Row, lives: Table, count: int, sighting: Row, at: int) -> None:
    """Rule 5: write a new track behind the last one."""
    life = lives[count]
    life.team, life.id = sighting.team, sighting.id
    life.claim, life.claims = NO_ID, 0
    holder = holder_of(lives, count, sighting.team, sighting.id) if sighting.id != NO_ID else -1
    if holder >= 0:
        life.id = NO_ID
        if not lives[holder].read:
            life.claim, life.claims = sighting.id, 1
    life.x_m, life.y_m, life.vx_m_s, life.vy_m_s = sighting.x_m, sighting.y_m, 0.0, 0.0
    life.variance = rules.robot_noise + sighting.position_sd_m**2
    life.covariance, life.rate_variance = 0.0, rules.robot_start
    life.headed, life.heading_rad, life.turn_rad_s = 0, 0.0, 0.0
    life.heading_variance, life.heading_covariance, life.turn_variance = UNKNOWN_HEADING_VARIANCE, 0.0, 0.0
    if math.isfinite(sighting.heading_rad + sighting.heading_sd_rad):
        face(rules, life, sighting)
    life.confidence, life.seen, life.sightings = sighting.confidence, at, 1
    life.paired = life.read = life.gone = 0


@kernel
def bury(lives: Table, count: int, at: int) -> int:
    """Rules 6 and 7; how many tracks are left, in the order of their starts."""
    kept = 0
    for row in range(count):
        life = lives[row]
        if life.gone or (life.seen != at and life.id == NO_ID and life.sightings == 1):
            continue
        if kept != row:
            lives[kept] = lives[row]
        kept += 1
    while kept > MAX_ROBOTS:
        least = 0
        for row in range(1, kept):
            named, least_named = lives[row].id != NO_ID, lives[least].id != NO_ID
            if named < least_named or (named == least_named and lives[row].seen <= lives[least].seen):
                least = row
        kept -= 1
        for row in range(least, kept):
            lives[row] = lives[row + 1]
    return kept


@kernel
def write_robots(rules: Row, state: Row, at: int, world: Row) -> None:
    """All robots predicted to an instant, ordered by team and id, the nameless last. world: a row of WORLD."""
    lives, order = state.robots, state.order
    living = 0
    for row in range(state.counts[ROBOTS]):
        if at - lives[row].seen > rules.validity_ns:
            continue
        place = living
        while place > 0 and _rank(lives[order[place - 1]]) > _rank(lives[row]):
            order[place] = order[place - 1]
            place -= 1
        order[place] = row
        living += 1
    world.counts[ROBOTS] = living
    for index in range(living):
        _write(rules, lives[order[index]], at, world.robots[index])


@kernel
def _rank(life: Row) -> int:
    rank: int = (life.team << 40) + (life.id if life.id != NO_ID else 1 << 32)
    return rank


@kernel
def _write(rules: Row, life: Row, at: int, track: Row) -> None:
    t = (at - life.seen) / NS_PER_S
    track.team, track.id = life.team, life.id
    track.x_m, track.y_m = life.x_m + life.vx_m_s * t, life.y_m + life.vy_m_s * t
    track.vx_m_s, track.vy_m_s = life.vx_m_s, life.vy_m_s
    track.heading_rad, track.turn_rad_s = wrapped(life.heading_rad + life.turn_rad_s * t), life.turn_rad_s
    variance, _, _ = predicted(life.variance, life.covariance, life.rate_variance, t, rules.robot_density)
    track.position_sd_m = math.sqrt(variance)
    variance, _, _ = predicted(
        life.heading_variance, life.heading_covariance, life.turn_variance, t, rules.turn_density
    )
    track.heading_sd_rad = math.sqrt(min(variance, UNKNOWN_HEADING_VARIANCE))
    track.confidence, track.seen = life.confidence, life.seen
