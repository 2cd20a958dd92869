"""The standard pattern: its table is unique, its geometry tells one heading."""

import math
from itertools import product

import numpy as np
import pytest

from tests.objects.drawing import CODES, MARKER
from vision_core.geometry import rotation


def test_all_sixteen_codes_are_worn_and_each_once() -> None:
    assert sorted(CODES) == list(range(16))
    assert set(CODES.values()) == {"".join(code) for code in product("GP", repeat=4)}
    assert {code: MARKER.id_by_code[code] for code in CODES.values()} == {c: n for n, c in CODES.items()}


def test_dots_lie_on_one_circle_and_are_apart() -> None:
    assert np.hypot(*MARKER.slots_m.T) == pytest.approx(np.full(4, 0.065), abs=1e-5)
    gaps = [math.dist(a, b) for i, a in enumerate(MARKER.slots_m) for b in MARKER.slots_m[:i]]
    assert min(gaps) > 0.04
    assert MARKER.dot_area_m2 == pytest.approx(math.pi * 0.02**2)
    assert MARKER.center_area_m2 == pytest.approx(math.pi * 0.025**2)


def test_no_turn_maps_three_dots_onto_others() -> None:
    """So three dots tell the heading, and no misread turn can make one id another."""
    for degrees in range(20, 341):
        turned = MARKER.slots_m @ rotation(math.radians(degrees)).T
        apart = np.linalg.norm(turned[:, None] - MARKER.slots_m, axis=2).min(axis=1)
        assert (apart < 0.009).sum() < 3, degrees


def test_slots_are_read_only() -> None:
    with pytest.raises(ValueError, match="read-only"):
        MARKER.slots_m[0, 0] = 0.0
