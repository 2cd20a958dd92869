"""Draws parts that add up to a whole, over time: layers one above the other."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from vision_core.geometry import Bytes, Floats
from vision_core.native.opencv import Color, draw_line, draw_text, text_size

BACKGROUND, FOREGROUND, GRID = 32, (255, 255, 255), (96, 96, 96)
LEFT, RIGHT, TOP, BOTTOM = 70, 24, 84, 62
"""Margins [px]."""
LEGEND_PX = 190
TITLE, TEXT, SMALL = 0.55, 0.45, 0.4
"""Font scales."""
HEADROOM = 1.15
MOST = 0.99
"""The axis reaches as far as this share of the sums; higher ones are cut off."""
MAX_TICKS = 6


@dataclass(frozen=True, slots=True)
class Layer:
    """One part of the whole."""

    name: str
    values: Floats
    """At each instant, shape (n,)."""
    color: Color


def draw_layers(
    at: Floats, layers: Sequence[Layer], title: str, axes: tuple[str, str], size_px: tuple[int, int]
) -> Bytes:
    """A picture of layers over time, the first one lowest.

    at: instants in rising order, shape (n,), n > 1; axes: labels of the lower and the left axis; size_px: width and
    height. Returns shape (height, width, 3), channels blue, green, red.
    """
    width, height = size_px
    image = np.full((height, width, 3), BACKGROUND, dtype=np.uint8)
    plot = image[TOP : height - BOTTOM, LEFT : width - RIGHT]
    tops = np.maximum(np.cumsum([layer.values for layer in layers], axis=0), 0.0)
    most = HEADROOM * max(float(np.quantile(tops[-1], MOST)), 1e-9)
    _fill(plot, _per_column(at, tops, plot.shape[1]) / most, [layer.color for layer in layers])
    _draw_axes(image, (float(at[0]), float(at[-1])), most, axes)
    draw_text(image, title, (LEFT, 28.0), FOREGROUND, TITLE)
    for place, layer in enumerate(layers):
        left = LEFT + LEGEND_PX * place
        image[46:58, left : left + 12] = layer.color
        draw_text(image, layer.name, (left + 20.0, 57.0), FOREGROUND, TEXT)
    return image


def _per_column(at: Floats, tops: Floats, columns: int) -> Floats:
    """Upper ends of the layers at each column, shape (layers, columns)."""
    columns_at = np.linspace(at[0], at[-1], columns)
    newest = np.clip(np.searchsorted(at, columns_at, side="right") - 1, 0, len(at) - 1)
    found: Floats = tops[:, newest]
    return found


def _fill(plot: Bytes, shares: Floats, colors: Sequence[Color]) -> None:
    """Fill each layer between the one below and its own upper end, a share 0..1 of the plot's height."""
    height = plot.shape[0]
    above = np.arange(height, 0, -1)[:, None] / height
    for share, color in zip(shares[::-1], reversed(colors), strict=True):
        plot[above <= share] = color


def _draw_axes(image: Bytes, ends: tuple[float, float], most: float, axes: tuple[str, str]) -> None:
    height, width = image.shape[:2]
    bottom, right = height - BOTTOM, width - RIGHT
    for value in _ticks(0.0, most):
        y = bottom - value / most * (bottom - TOP)
        draw_line(image, (LEFT, y), (right, y), GRID)
        word = f"{value:g}"
        draw_text(image, word, (LEFT - 8.0 - text_size(word, SMALL)[0], y + 4.0), FOREGROUND, SMALL)
    for value in _ticks(*ends):
        x = LEFT + (value - ends[0]) / max(ends[1] - ends[0], 1e-9) * (right - LEFT)
        draw_line(image, (x, bottom), (x, bottom + 4), FOREGROUND)
        word = f"{value:g}"
        draw_text(image, word, (x - text_size(word, SMALL)[0] / 2.0, bottom + 19.0), FOREGROUND, SMALL)
    draw_line(image, (LEFT, bottom), (right, bottom), FOREGROUND)
    draw_line(image, (LEFT, TOP), (LEFT, bottom), FOREGROUND)
    lower, left = axes
    draw_text(image, left, (8.0, TOP - 8.0), FOREGROUND, SMALL)
    draw_text(image, lower, ((LEFT + right - text_size(lower, TEXT)[0]) / 2.0, bottom + 42.0), FOREGROUND, TEXT)


def _ticks(low: float, high: float) -> list[float]:
    """Round numbers within two ends, at most MAX_TICKS + 1."""
    step = (high - low) / MAX_TICKS
    power = 10.0 ** math.floor(math.log10(max(step, 1e-12)))
    step = next((part * power for part in (1, 2, 5) if part * power >= step), 10 * power)
    first = math.ceil(low / step)
    return [round(number * step, 9) for number in range(first, math.floor(high / step) + 1)]
