"""Draws histograms into one picture: a grid of panels, each with one or several series over the same bins."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from vision_core.geometry import Bytes, Floats
from vision_core.native.opencv import Color, draw_line, draw_text, text_size

BACKGROUND, FOREGROUND, GRID = 32, (255, 255, 255), (96, 96, 96)
BLUE: Color = (230, 150, 60)
ORANGE: Color = (70, 150, 250)
LEFT, RIGHT, TOP, BOTTOM = 70, 24, 40, 62
"""Margins of a panel [px]."""
LEGEND_PX = 20
"""Height of one line of the legend [px]."""
TITLE, TEXT, SMALL = 0.55, 0.45, 0.4
"""Font scales."""
HEADROOM = 1.08
MAX_TICKS = 10


@dataclass(frozen=True, slots=True)
class Series:
    """The counts of one data set, drawn in one color."""

    name: str
    counts: tuple[int, ...]
    """One count for each bin."""
    color: Color


@dataclass(frozen=True, slots=True)
class Panel:
    """One histogram."""

    title: str
    axis: str
    """Label of the lower axis, with its unit."""
    edges: tuple[float, ...]
    """Lower edge of every bin and the upper edge of the last, which may be infinity."""
    series: tuple[Series, ...]
    logarithmic: bool = False
    """Draw the logarithm of the counts."""
    numbered: bool = False
    """Write the count above each bar."""
    counted: str = "count"
    """Label of the left axis."""


def counts_of(values: Floats | Sequence[float], edges: Sequence[float]) -> tuple[int, ...]:
    """How many values lie in each bin. Values beyond the outer edges count in the outer bins."""
    inner = np.asarray(edges[1:-1], dtype=np.float64)
    bins = np.searchsorted(inner, np.asarray(values, dtype=np.float64), side="right")
    return tuple(np.bincount(bins, minlength=len(edges) - 1).tolist())


def draw_panels(panels: Sequence[Panel], title: str, columns: int, size_px: tuple[int, int]) -> Bytes:
    """A picture of all panels, row by row; size_px: width and height of each.

    Returns shape (height, width, 3), channels blue, green, red.
    """
    width, height = size_px
    rows = math.ceil(len(panels) / columns)
    image = np.full((TOP + rows * height, columns * width, 3), BACKGROUND, dtype=np.uint8)
    draw_text(image, title, (LEFT, 28.0), FOREGROUND, TITLE)
    for place, panel in enumerate(panels):
        row, column = divmod(place, columns)
        top, left = TOP + row * height, column * width
        _draw(image[top : top + height, left : left + width], panel)
    return image


def _draw(image: Bytes, panel: Panel) -> None:
    """Draw one panel over the whole of an image."""
    height, width = image.shape[:2]
    top = TOP + LEGEND_PX * (len(panel.series) + 1)
    box = (LEFT, top, width - RIGHT, height - BOTTOM)
    draw_text(image, panel.title, (LEFT, 24.0), FOREGROUND, TEXT + 0.05)
    for line, series in enumerate(panel.series):
        y = TOP + LEGEND_PX * line
        image[y - 4 : y + 8, LEFT : LEFT + 12] = series.color
        draw_text(image, series.name, (LEFT + 20, y + 7.0), FOREGROUND, TEXT)
    _draw_counts(image, panel, box)
    _draw_bars(image, panel, box)
    _draw_bins(image, panel, box)


def _draw_bars(image: Bytes, panel: Panel, box: tuple[int, int, int, int]) -> None:
    left, top, right, bottom = box
    pitch = (right - left) / (len(panel.edges) - 1)
    bar = 0.86 * pitch / len(panel.series)
    for number, series in enumerate(panel.series):
        for place, count in enumerate(series.counts):
            if not count:
                continue
            x = left + pitch * (place + 0.07) + bar * number
            y = bottom - _share(panel, count) * (bottom - top)
            image[min(round(y), bottom - 2) : bottom, round(x) : max(round(x + bar), round(x) + 1)] = series.color
            if panel.numbered:
                draw_text(
                    image,
                    str(count),
                    (x + bar / 2.0 - text_size(str(count), SMALL)[0] / 2.0, y - 5.0),
                    FOREGROUND,
                    SMALL,
                )


def _draw_bins(image: Bytes, panel: Panel, box: tuple[int, int, int, int]) -> None:
    """Draw the lower axis with the bins' edges."""
    left, _, right, bottom = box
    draw_line(image, (left, bottom), (right, bottom), FOREGROUND)
    bins = len(panel.edges) - 1
    step = math.ceil(bins / MAX_TICKS) if not panel.numbered else 1
    for place in range(0, len(panel.edges), step):
        if math.isfinite(panel.edges[place]):
            x = left + (right - left) * place / bins
            draw_line(image, (x, bottom), (x, bottom + 4), FOREGROUND)
            word = f"{panel.edges[place]:g}"
            draw_text(image, word, (x - text_size(word, SMALL)[0] / 2.0, bottom + 19.0), FOREGROUND, SMALL)
    draw_text(
        image, panel.axis, ((left + right - text_size(panel.axis, TEXT)[0]) / 2.0, bottom + 42.0), FOREGROUND, TEXT
    )


def _draw_counts(image: Bytes, panel: Panel, box: tuple[int, int, int, int]) -> None:
    """Draw the left axis with its grid."""
    left, top, right, bottom = box
    for count in _ticks(panel):
        y = bottom - _share(panel, count) * (bottom - top)
        draw_line(image, (left, y), (right, y), GRID)
        word = str(count)
        draw_text(image, word, (left - 8.0 - text_size(word, SMALL)[0], y + 4.0), FOREGROUND, SMALL)
    draw_line(image, (left, top), (left, bottom), FOREGROUND)
    draw_text(image, panel.counted, (8.0, top - 8.0), FOREGROUND, SMALL)


def _ticks(panel: Panel) -> list[int]:
    maximum = _max_count(panel)
    decade = 10 ** math.floor(math.log10(maximum))
    if panel.logarithmic:
        return [10**power for power in range(math.floor(math.log10(maximum)) + 1)]
    step = max(next(part for part in (decade, decade // 2, decade // 5) if part == 0 or maximum / part >= 3), 1)
    return list(range(0, maximum + 1, step))


def _share(panel: Panel, count: int) -> float:
    """Height of a bar as a share of the panel's, 0..1."""
    maximum = _max_count(panel)
    share = math.log10(1.0 + count) / math.log10(1.0 + maximum) if panel.logarithmic else count / maximum
    return share / HEADROOM


def _max_count(panel: Panel) -> int:
    return max(1, *(count for series in panel.series for count in series.counts))
