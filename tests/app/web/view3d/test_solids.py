"""Solids are closed, and their triangles look outside."""

from collections import Counter

import numpy as np
import pytest

from app.web.view3d.solids import CIRCLE_STEPS, Solid, circle_m, flattened, square_m, upright
from vision_core.geometry import Floats


def volume_m3(solid: Solid) -> float:
    """Of a closed surface whose triangles are anticlockwise from outside."""
    a, b, c = (solid.vertices_m[solid.faces[:, corner]].astype(np.float64) for corner in range(3))
    return float(np.sum(a * np.cross(b, c)) / 6.0)


@pytest.mark.parametrize(
    ("outline", "area"),
    [
        (square_m(0.5), 1.0),
        (square_m(0.5)[::-1], 1.0),
        (circle_m(1.0, (3.0, 2.0)), 0.5 * CIRCLE_STEPS * np.sin(2.0 * np.pi / CIRCLE_STEPS)),
    ],
)
def test_the_volume_is_area_times_height(outline: Floats, area: float) -> None:
    assert volume_m3(upright(outline, 0.1, 0.35)) == pytest.approx(0.25 * area, rel=1e-5)


def test_every_edge_belongs_to_two_triangles() -> None:
    faces = upright(circle_m(1.0), 0.0, 1.0).faces.tolist()
    edges = Counter(frozenset(pair) for a, b, c in faces for pair in ((a, b), (b, c), (c, a)))
    assert set(edges.values()) == {2}


def test_a_flat_front_is_cut_off() -> None:
    assert flattened(circle_m(0.09), 0.055)[:, 0].max() == 0.055
