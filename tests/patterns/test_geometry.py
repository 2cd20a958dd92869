"""Areas, depths and turns of patches."""

import math
from dataclasses import dataclass

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from vision_core.patterns.geometry import (
    GRID_MM,
    Polygon,
    area_mm2,
    centroid_mm,
    contains,
    crosses_itself,
    depth_mm,
    gap_mm,
    inner_points_mm,
    middle_mm,
    overlap_mm,
    reach_mm,
    rim_mm,
    turned_mm,
    turns_onto,
    width_mm,
)


@dataclass(frozen=True)
class Piece:
    """A patch without its color."""

    circle_mm: tuple[float, float, float] | None = None
    polygon_mm: Polygon | None = None
    hidden_by: tuple["Piece", ...] = ()


def disc(x: float, y: float, diameter: float) -> Piece:
    return Piece(circle_mm=(x, y, diameter))


def polygon(*corners: tuple[float, float]) -> Piece:
    return Piece(polygon_mm=(*corners, corners[0]))


def box(x1: float, y1: float, x2: float, y2: float) -> Piece:
    return polygon((x1, y1), (x2, y1), (x2, y2), (x1, y2))


ELL = polygon((-30, -30), (30, -30), (30, 5), (5, 5), (5, 30), (-30, 30))
SSL = [disc(x, y, 40) for x, y in ((35, 54.8), (-54.8, 35), (-54.8, -35), (35, -54.8))]

places = st.floats(-50, 50)
sizes = st.floats(8, 60)
stars = st.lists(st.floats(10, 60), min_size=3, max_size=9).map(
    lambda radii: polygon(
        *(
            (r * math.cos(math.tau * i / len(radii)), r * math.sin(math.tau * i / len(radii)))
            for i, r in enumerate(radii)
        )
    )
)
pieces = st.one_of(st.builds(disc, places, places, sizes), stars)


@given(pieces)
def test_area_and_centroid_are_those_of_its_points(piece: Piece) -> None:
    points = inner_points_mm(piece)
    assert len(points) * GRID_MM**2 == pytest.approx(area_mm2(piece), rel=0.05)
    assert points.mean(axis=0) == pytest.approx(centroid_mm(piece), abs=0.5)
    assert contains(piece, points).all()


@given(pieces)
def test_the_rim_has_no_depth_and_the_widest_disc_fits(piece: Piece) -> None:
    rim = rim_mm(piece)
    assert depth_mm(piece, rim) == pytest.approx(0.0, abs=1e-6)
    assert math.pi * (width_mm(piece) / 2) ** 2 <= area_mm2(piece) * 1.001
    assert reach_mm(piece, "circle") >= reach_mm(piece, "square") - 1e-9
    assert reach_mm(piece, "circle") >= np.hypot(*rim.T).max() - 1e-6


def test_depth_is_the_distance_to_the_nearest_edge() -> None:
    assert depth_mm(ELL, np.array([[-20.0, 0.0], [7.0, 7.0], [40.0, 0.0]])) == pytest.approx([10, -2, -10])
    assert area_mm2(ELL) == 60 * 60 - 25 * 25
    assert middle_mm([ELL, box(5, 5, 30, 30)]) == pytest.approx((0, 0))


def test_touching_is_no_overlap() -> None:
    corner = box(5, 5, 30, 30)
    assert overlap_mm(ELL, corner) < 0.01
    assert gap_mm(ELL, corner) == 0
    assert overlap_mm(ELL, box(0, 0, 30, 30)) == pytest.approx(5.5, abs=0.5)
    assert gap_mm(box(0, 0, 10, 10), box(13, 14, 20, 20)) == pytest.approx(5)
    assert gap_mm(disc(0, 0, 10), disc(20, 0, 10)) == pytest.approx(10, abs=0.1)
    assert overlap_mm(disc(0, 0, 60), disc(5, 0, 10)) == pytest.approx(10, abs=1)


@pytest.mark.parametrize(
    ("corners", "crossing"),
    [
        ([(0, 0), (9, 0), (9, 9), (0, 9), (0, 0)], False),
        ([(0, 0), (9, 9), (9, 0), (0, 9), (0, 0)], True),
        ([(0, 0), (9, 0), (4, 0), (0, 9), (0, 0)], True),
        ([(0, 0), (9, 0), (9, 9), (4, 0), (0, 9), (0, 0)], True),
        ([(0, 0), (4, 0), (9, 0), (0, 9), (0, 0)], False),
        ([(0, 0), (0, 0), (9, 0), (0, 9), (0, 0)], True),
    ],
)
def test_crossing_sides(corners: list[tuple[float, float]], *, crossing: bool) -> None:
    assert crosses_itself(corners) is crossing


@given(st.floats(-math.pi, math.pi), st.integers(2, 6))
def test_a_ring_of_patches_has_as_many_turns(first: float, count: int) -> None:
    bearings = first + math.tau * np.arange(count) / count
    ring = [disc(50 * math.cos(b) + 7, 50 * math.sin(b) - 3, 15) for b in bearings]
    turns = turns_onto(ring, ring)
    assert [turn for turn, _ in turns] == pytest.approx([math.tau * i / count for i in range(count)], abs=1e-4)
    assert [places[0] for _, places in turns] == list(range(count))


def test_turns_of_other_sets() -> None:
    diagonal = [box(0, 0, 20, 20), box(-20, -20, 0, 0)]
    assert len(turns_onto(SSL, SSL)) == 1
    assert len(turns_onto([disc(0, 0, 50)], [disc(0, 0, 50)])) == 2
    assert len(turns_onto([box(-20, -20, 20, 20)], [box(-20, -20, 20, 20)])) == 4
    assert len(turns_onto([box(-20, -10, 20, 10)], [box(-20, -10, 20, 10)])) == 2
    assert len(turns_onto([ELL], [ELL])) == 1
    assert [places for _, places in turns_onto(diagonal, diagonal)] == [[0, 1], [1, 0]]


def test_turning_keeps_the_middle() -> None:
    middle = np.array([3.0, 4.0])
    assert turned_mm(np.array([[4.0, 4.0], [3.0, 4.0]]), math.pi / 2, middle) == pytest.approx(
        np.array([[3, 5], [3, 4]])
    )
