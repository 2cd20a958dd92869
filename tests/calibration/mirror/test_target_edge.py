"""Edges along rays are found to a part of a pixel, by a click or as the strongest one."""

import math

import numpy as np
import pytest

from tests.calibration.mirror.pictures import CENTER_PX, around
from vision_core.calibration.mirror.target_edge import (
    direction_of,
    edge_at_click,
    edges_along,
    middle_of,
    strongest_edge,
)

EDGE = 70.0 + 10.0 * np.sin(np.radians(np.arange(360.0)))
PICTURE = around(EDGE, line_px=45.0)


def place(direction_deg: float, radius_px: float) -> tuple[float, float]:
    angle = math.radians(direction_deg)
    return CENTER_PX[0] - radius_px * math.sin(angle), CENTER_PX[1] - radius_px * math.cos(angle)


def test_directions_are_anticlockwise_from_up() -> None:
    assert middle_of(PICTURE) == CENTER_PX
    assert direction_of((100.0, 100.0), (100.0, 60.0)) == 0.0
    assert direction_of((100.0, 100.0), (60.0, 100.0)) == pytest.approx(math.pi / 2.0)


@pytest.mark.parametrize("direction_deg", [0, 37, 90, 203, 311])
def test_a_click_finds_the_edge_near_to_it(direction_deg: int) -> None:
    edge = edge_at_click(PICTURE, CENTER_PX, place(direction_deg, EDGE[direction_deg] + 5.0))
    assert edge is not None
    assert edge.radius_px == pytest.approx(EDGE[direction_deg], abs=0.15)
    assert edge.place_px == pytest.approx(place(direction_deg, edge.radius_px))
    line = edge_at_click(PICTURE, CENTER_PX, place(direction_deg, 43.0))
    assert line is not None
    assert line.radius_px == pytest.approx(44.0, abs=0.5)


def test_the_strongest_edge_between_two_radii() -> None:
    edge = strongest_edge(PICTURE, CENTER_PX, math.radians(90.0), (50.0, 100.0))
    assert edge is not None
    assert edge.radius_px == pytest.approx(80.0, abs=0.15)
    assert strongest_edge(PICTURE, CENTER_PX, 0.0, (50.0, 60.0)) is None
    assert strongest_edge(PICTURE, CENTER_PX, 0.0, (60.0, 50.0)) is None
    found = [edge.radius_px for edge in edges_along(PICTURE, CENTER_PX, 0.0, (4.0, 400.0))]
    assert found == pytest.approx([20.0, 44.0, 46.0, 70.0, 115.0], abs=0.5)


def test_a_click_beside_everything_finds_nothing() -> None:
    assert edge_at_click(PICTURE, CENTER_PX, place(90.0, 60.0), reach_px=5.0) is None
    assert edge_at_click(PICTURE, CENTER_PX, (1e4, 1e4)) is None
    assert edge_at_click(PICTURE, CENTER_PX, CENTER_PX) is None
