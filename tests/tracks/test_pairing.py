"""Pairs: within the gate, one to one, nearest first."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from vision_core.tracks.pairing import pair_nearest, squared_gate
from vision_core.tracks.state import empty_state, parameters_from
from vision_core.types.tables import NO_ID, SightingsTable
from vision_core.venues.loader import load_settings

SETTINGS = load_settings()
PARAMETERS = parameters_from(SETTINGS.tracks, SETTINGS.robots)
GATE_M = SETTINGS.tracks.gate_m
STATE, SEEN = empty_state(), SightingsTable()

Places = list[tuple[float, float, int, int]]
PLACES = st.lists(
    st.tuples(st.floats(-1.0, 1.0), st.floats(-1.0, 1.0), st.integers(0, 1), st.integers(NO_ID, 2)), max_size=8
)


def pairs_of(places: Places, found: Places, *, by_id: bool) -> list[tuple[int, int]]:
    """Of predictions and sightings (x, y, team, id), all without variance."""
    tracks, sightings = STATE[0]["robots"], SEEN.robots
    tracks[:] = 0
    for row, (x, y, team, marker) in enumerate(places):
        tracks[row]["predicted_x_m"], tracks[row]["predicted_y_m"], tracks[row]["team"], tracks[row]["id"] = (
            x,
            y,
            team,
            marker,
        )
    for column, (x, y, team, marker) in enumerate(found):
        sightings[column]["x_m"], sightings[column]["y_m"] = x, y
        sightings[column]["team"], sightings[column]["id"] = team, marker
    STATE["taken"] = 0
    count = pair_nearest(PARAMETERS[0], STATE[0], len(places), sightings, len(found), 0, by_id)
    return [(row, column) for row, column in STATE[0]["pairs"][:count].tolist()]


@settings(deadline=None)  # the first call loads or compiles the kernel
@given(PLACES, PLACES, st.booleans())
def test_pairs_are_one_to_one_within_the_gate_and_none_is_missed(places: Places, found: Places, by_id: bool) -> None:
    pairs = pairs_of(places, found, by_id=by_id)

    def fits(i: int, j: int) -> bool:
        same = places[i][3] == found[j][3] != NO_ID or not by_id
        return same and places[i][2] == found[j][2] and math.dist(places[i][:2], found[j][:2]) <= GATE_M * (1.0 - 1e-9)

    rows, columns = {row for row, _ in pairs}, {column for _, column in pairs}
    assert len(rows) == len(columns) == len(pairs)
    lengths = [math.dist(places[i][:2], found[j][:2]) for i, j in pairs]
    assert all(length <= GATE_M * (1.0 + 1e-9) for length in lengths)
    assert lengths == pytest.approx(sorted(lengths))
    left = [(i, j) for i in range(len(places)) for j in range(len(found)) if i not in rows and j not in columns]
    assert not any(fits(i, j) for i, j in left)


def test_a_sure_pair_is_not_moved_to_make_room() -> None:
    # predictions at 0 and 0.2, sightings at 0.2 and 0.38: the least total distance would be 0.2 + 0.18
    places, found = [(0.0, 0.0, 0, 0), (0.2, 0.0, 0, 0)], [(0.2, 0.0, 0, 0), (0.38, 0.0, 0, 0)]
    assert pairs_of(places, found, by_id=False) == [(1, 0)]


def test_gates_are_metric_where_sure_and_statistical_where_not() -> None:
    assert math.sqrt(squared_gate(1e-6, 0.25)) == pytest.approx(0.25)
    assert math.sqrt(squared_gate(0.04, 0.25)) == pytest.approx(0.6)


def test_the_nearest_pairs_are_those_of_a_sorted_list() -> None:
    rng = np.random.default_rng(5)
    for _ in range(50):
        places = [(x, y, 0, 0) for x, y in rng.uniform(-0.3, 0.3, (20, 2)).tolist()]
        found = [(x, y, 0, 0) for x, y in rng.uniform(-0.3, 0.3, (20, 2)).tolist()]
        expected: list[tuple[int, int]] = []
        distances = {(i, j): math.dist(p[:2], f[:2]) for i, p in enumerate(places) for j, f in enumerate(found)}
        for (i, j), distance in sorted(distances.items(), key=lambda item: item[1]):
            if distance <= GATE_M and all(i != row and j != column for row, column in expected):
                expected.append((i, j))
        assert pairs_of(places, found, by_id=False) == expected
