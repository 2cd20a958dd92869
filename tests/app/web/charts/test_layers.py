"""Layers over time: each as high as its values, one above the other."""

import numpy as np
import pytest

from app.web.charts.layers import BOTTOM, HEADROOM, LEFT, RIGHT, TOP, Layer, draw_layers

LOW, HIGH = (200, 10, 10), (10, 200, 10)
SIZE = 600, 400


def drawn(low: list[float], high: list[float]) -> np.ndarray:
    at = np.arange(len(low), dtype=float)
    layers = [Layer("low", np.array(low), LOW), Layer("high", np.array(high), HIGH)]
    image = draw_layers(at, layers, "title", ("time [s]", "lag [ms]"), SIZE)
    assert image.shape == (SIZE[1], SIZE[0], 3)
    plot: np.ndarray = image[TOP : SIZE[1] - BOTTOM, LEFT : SIZE[0] - RIGHT]
    return plot


def heights(plot: np.ndarray, color: tuple[int, int, int]) -> np.ndarray:
    """Share of each column that has a color; lines of the grid are drawn over it."""
    found: np.ndarray = (plot == color).all(axis=2).mean(axis=0)
    return found


def test_heights_are_those_of_the_values() -> None:
    plot = drawn([3.0] * 10, [1.0] * 10)
    assert np.median(heights(plot, LOW)) == pytest.approx(0.75 / HEADROOM, abs=0.05)
    assert np.median(heights(plot, HIGH)) == pytest.approx(0.25 / HEADROOM, abs=0.05)
    column = (plot[:, 50] == LOW).all(axis=1)
    assert column[-5:-2].all()


def test_a_value_holds_until_the_next_one() -> None:
    plot = drawn([1.0, 4.0, 4.0], [0.0, 0.0, 0.0])
    early, late = heights(plot, LOW)[10], heights(plot, LOW)[-10]
    assert late > 3.0 * early


@pytest.mark.parametrize("values", [[0.0, 0.0], [-1.0, -2.0], [1e-6, 1e6]])
def test_odd_values_are_drawn(values: list[float]) -> None:
    drawn(values, values)
