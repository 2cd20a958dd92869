"""Edges of painted lines are found to a small part of a pixel, of lines thinner than one too."""

import numpy as np
import pytest

from vision_core.calibration.painted import Placed
from vision_core.calibration.profiles import FloatImage, find_edges

HEIGHT, WIDTH, FINE = 40, 60, 50


def vertical_line(middle_px: float, width_px: float, right: float = 60.0) -> FloatImage:
    """A line of level 200 on carpet of level 60; right: the level on its right."""
    x = (np.arange(WIDTH * FINE) + 0.5) / FINE - 0.5
    sharp = np.where(x < middle_px, 60.0, right)
    sharp[np.abs(x - middle_px) <= width_px / 2.0] = 200.0
    blurred = np.convolve(sharp, np.ones(FINE) / FINE, mode="same").reshape(WIDTH, FINE).mean(axis=1)
    return np.tile(blurred.astype(np.float32), (HEIGHT, 1))


def several(section: Placed, count: int) -> Placed:
    """The same section again and again."""
    points, normals = np.repeat(section.points_px, count, axis=0), np.repeat(section.normals, count, axis=0)
    return Placed(points, normals, np.repeat(section.half_px, count), np.repeat(section.inward, count))


def across(x_px: float, width_px: float, inward: int = 0) -> Placed:
    """One section of a vertical line."""
    points = np.column_stack([np.full(8, x_px), np.linspace(10.0, 25.0, 8)])
    return Placed(points[None], np.array([[1.0, 0.0]]), np.array([width_px / 2.0]), np.array([inward], dtype=np.int8))


@pytest.mark.parametrize("width_px", [0.6, 1.0, 2.0, 3.3, 9.0])
@pytest.mark.parametrize("middle_px", [30.0, 30.27, 30.5, 31.4])
def test_the_middle_of_a_line(width_px: float, middle_px: float) -> None:
    edges = find_edges(vertical_line(middle_px, width_px), across(30.0, width_px), 3.0)
    assert edges.offset_px[0] == pytest.approx(middle_px - 30.0, abs=0.1)
    assert edges.single[0] == 0


def test_a_step_is_no_line() -> None:
    assert not find_edges(vertical_line(30.0, 3.0, right=198.0), across(30.0, 3.0), 3.0).found.any()


def test_a_line_along_a_wall_is_measured_by_its_free_edge() -> None:
    edges = find_edges(vertical_line(30.3, 3.0, right=170.0), across(30.0, 3.0), 3.0)
    assert edges.single[0] == -1
    assert edges.offset_px[0] == pytest.approx(0.3, abs=0.15)


def test_a_wall_as_bright_as_its_line_leaves_a_step() -> None:
    picture, section = vertical_line(30.3, 3.0, right=200.0), across(30.0, 3.0, inward=-1)
    assert not find_edges(picture, section, 3.0).found.any()
    assert find_edges(picture, section, 3.0, steps=True).offset_px[0] == pytest.approx(0.3, abs=0.1)


def test_lines_that_are_all_wider_than_said_are_found() -> None:
    picture = vertical_line(30.3, 4.5)
    assert not find_edges(picture, across(30.0, 1.3), 3.0).found.any()
    edges = find_edges(picture, several(across(30.0, 1.3), 20), 3.0)
    assert edges.offset_px == pytest.approx(np.full(20, 0.3), abs=0.1)
    assert edges.excess_px == pytest.approx(1.6, abs=0.3)


def test_bare_carpet_shows_none() -> None:
    assert not find_edges(np.full((HEIGHT, WIDTH), 60.0, dtype=np.float32), across(30.0, 3.0), 3.0).found.any()


@pytest.mark.parametrize("width_px", [1e4, 1e15, np.inf, np.nan])
def test_a_lens_that_has_gone_astray_finds_nothing(width_px: float) -> None:
    edges = find_edges(vertical_line(30.0, 3.0), across(30.0, width_px), 3.0, steps=True)
    assert np.isnan(edges.offset_px).all()
