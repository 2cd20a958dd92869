"""What must not be found: colors of floor, lines, bodies and surroundings, taken from a picture without a click."""

from itertools import pairwise

import numpy as np

from vision_core.color.samples import hex_from_bgr
from vision_core.geometry import Bytes, Floats

STEP = 3
"""Each so manieth pixel is looked at."""
CELL = 32
"""Colors are counted in cells of so many levels a channel."""
MIN_FLOOR, MAX_FLOOR = 0.01, 16
"""A color that covers this share of the picture is no paper; and how many of them are kept."""
GREY_BANDS = (0.0, 40.0, 80.0, 130.0, 190.0, 256.0)
"""Borders of brightness between which greys are taken: bodies, shadows, walls, lines."""
MAX_GREY, MIN_GREY = 0.22, 0.002
"""Largest difference of a grey's channels, as a share of the brightest; a band counts from so large a share on."""


def floor_colors(pixels: Bytes) -> tuple[str, ...]:
    """The colors that cover much of a picture, and its greys, as "#rrggbb"; pixels: shape (height, width, 3)."""
    colors = pixels[::STEP, ::STEP].reshape(-1, 3).astype(np.float64)
    found = [*_floors(colors), *_greys(colors)]
    return tuple(dict.fromkeys(hex_from_bgr(color.tolist()) for color in found))


def _floors(colors: Floats) -> list[Floats]:
    cells = (colors // CELL).astype(np.int64) @ np.array([1, 16, 256])
    names, counts = np.unique(cells, return_counts=True)
    large = np.argsort(-counts)[:MAX_FLOOR]
    return [
        np.median(colors[cells == names[each]], axis=0) for each in large if counts[each] >= MIN_FLOOR * len(colors)
    ]


def _greys(colors: Floats) -> list[Floats]:
    brightest = colors.max(axis=1)
    is_grey = np.ptp(colors, axis=1) <= MAX_GREY * np.maximum(brightest, 1.0)
    bands = pairwise(GREY_BANDS)
    chosen = (colors[is_grey & (brightest >= low) & (brightest < high)] for low, high in bands)
    return [np.median(band, axis=0) for band in chosen if len(band) >= MIN_GREY * len(colors)]
