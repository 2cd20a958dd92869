"""Moments of a patch: free of place and size, turned by a turn, and what shows a heading."""

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from vision_core.geometry import Floats, rotation
from vision_core.objects.robots.shapes import (
    aspect_score,
    heading_from_shape,
    heading_score,
    measured_from,
    shape_from,
)
from vision_core.patterns.geometry import inner_points_mm
from vision_core.patterns.loader import load_pattern

POINTS = {
    name: inner_points_mm(load_pattern(name).patches[0]) / 1000.0
    for name in ("t-plate", "mirosot-diagonal", "vsss-corner-patch", "vsss-three-patch", "ssl-standard")
}
ANGLES = st.floats(-math.pi, math.pi)


def seen(points: Floats) -> Any:
    """A measured shape, from points."""
    return measured_from(shape_from(points))[0]


def turned(points: Floats, angle: float) -> Floats:
    return np.asarray(points @ rotation(angle).T * 1.3 + [0.4, -0.2])


@pytest.mark.parametrize("name", ["t-plate", "mirosot-diagonal", "vsss-corner-patch"])
@settings(deadline=None)
@given(angle=ANGLES)
def test_a_turn_is_read_back(name: str, angle: float) -> None:
    drawn = shape_from(POINTS[name])
    heading, best, other = heading_from_shape(drawn, seen(turned(POINTS[name], angle)))
    assert math.remainder(heading - angle, math.tau) == pytest.approx(0.0, abs=1e-6)
    assert best == pytest.approx(1.0)
    assert other < 0.75


@settings(deadline=None)
@given(angle=ANGLES)
def test_a_rectangle_tells_its_axis_only_and_a_circle_nothing(angle: float) -> None:
    bar = shape_from(POINTS["vsss-three-patch"])
    there = seen(turned(POINTS["vsss-three-patch"], angle))
    assert heading_score(bar, there, angle) == pytest.approx(1.0)
    assert heading_score(bar, there, angle + math.pi) == pytest.approx(1.0)
    assert heading_score(bar, there, angle + math.pi / 2.0) == pytest.approx(0.0, abs=1e-9)
    disc = shape_from(POINTS["ssl-standard"])
    assert disc.weights.sum() == 0.0
    assert heading_score(disc, there, angle) == 1.0


def test_a_patch_is_like_itself_and_unlike_others() -> None:
    for name, points in POINTS.items():
        for other, others in POINTS.items():
            like = aspect_score(shape_from(points), seen(turned(others, 1.0)))
            assert (like == pytest.approx(1.0)) if name == other else (like < 1.0)


def test_a_round_blob_agrees_with_no_heading_of_a_t() -> None:
    tee, disc = shape_from(POINTS["t-plate"]), seen(POINTS["ssl-standard"])
    assert heading_score(tee, disc, 0.3) < 0.6
