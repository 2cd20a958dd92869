"""Pairs: within the gate, one to one, nearest first."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays

from vision_core.geometry import Floats
from vision_core.tracks.assignment import assign, distances_between, gates

PLACES = arrays.arrays(np.float64, st.tuples(st.integers(0, 8), st.just(2)), elements=st.floats(-3.0, 3.0))


@given(PLACES, PLACES)
def test_pairs_are_one_to_one_within_reach_and_none_is_missed(places: Floats, found: Floats) -> None:
    distances, reach = distances_between(places, found), np.full(len(places), 0.7)
    pairs = assign(distances, reach)
    rows, columns = {row for row, _ in pairs}, {column for _, column in pairs}
    assert len(rows) == len(columns) == len(pairs)
    assert all(distances[pair] <= 0.7 for pair in pairs)
    left = [(i, j) for i in range(len(places)) for j in range(len(found)) if i not in rows and j not in columns]
    assert all(distances[pair] > 0.7 for pair in left)
    lengths = [distances[pair] for pair in pairs]
    assert lengths == sorted(lengths)


def test_a_sure_pair_is_not_moved_to_make_room() -> None:
    # predictions at 0 and 1, sightings at 1 and 1.9: the least total distance would be 1 + 0.9, greedy takes 1 - 1
    distances = distances_between(np.array([[0.0, 0.0], [1.0, 0.0]]), np.array([[1.0, 0.0], [1.9, 0.0]]))
    assert assign(distances, np.array([1.5, 1.5])) == [(1, 0)]


def test_what_is_impossible_is_no_pair_however_wide_the_gate() -> None:
    assert assign(np.array([[np.inf]]), np.array([np.inf])) == []


def test_gates_are_metric_where_sure_and_statistical_where_not() -> None:
    np.testing.assert_allclose(gates(np.array([1e-6, 0.04]), 0.25), [0.25, 0.6])
