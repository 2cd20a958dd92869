"""Which color is what: reference colors of the things that an on-board camera sees, and the label of every color.

A color is labeled as the nearest reference in a space where light counts less than hue: (r - g) and (2b - r - g) as
shares of the sum, and the logarithm of the sum. Dark colors have little hue that noise leaves, so DARK_SUM is added to
the sum. Colors farther from every reference than the tolerance are OTHER: something stands there, and nobody knows
what.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from enum import IntEnum
from functools import lru_cache

import numpy as np

from vision_core.client.panorama import BALL, COLORS, FLOOR, RING
from vision_core.geometry import Bytes, Floats, frozen
from vision_core.types.edges import Rgb

DARK_SUM = 48.0
LIGHT_WEIGHT = 0.3
"""Of the logarithm of the sum; hues count 1."""
CELL_BITS = 5
"""Of each channel, for the table of labels."""


class Surface(IntEnum):
    """What a color shows: the labels of pixels."""

    FLOOR = 0
    BALL = 1
    WALL = 2
    """White: walls, and lines."""
    GOAL_BLUE = 3
    GOAL_YELLOW = 4
    BLUE = 5
    """The color of blue's robots."""
    YELLOW = 6
    DARK = 7
    """Robots' bodies."""
    OBSTACLE = 8
    OTHER = 9


@dataclass(frozen=True, slots=True)
class Palette:
    """The reference colors of a world."""

    colors: tuple[tuple[Surface, Rgb], ...]
    """References: any number per surface, none of OTHER."""
    tolerance: float
    """Largest distance from a reference, in the space of ``features``."""
    dark_feet: bool
    """Robots stand on a dark body and carry their team's color above it. What is blue or yellow from its foot on is
    then a goal. False: robots are blue or yellow from the floor on, and goals have colors of their own."""


def features(rgb: Floats) -> Floats:
    """The space in which colors are compared, of red green blue 0..255, shape (..., 3)."""
    red, green, blue = np.moveaxis(rgb, -1, 0)
    total = red + green + blue + DARK_SUM
    hues = (red - green) / total, (2.0 * blue - red - green) / total
    return np.stack([*hues, LIGHT_WEIGHT * np.log(total)], axis=-1)


@lru_cache(maxsize=8)
def labels_of(palette: Palette) -> Bytes:
    """The Surface of every color, shape (32, 32, 32), by the upper bits of blue, green and red."""
    side = 1 << CELL_BITS
    levels = (np.arange(side) + 0.5) * (256 / side)
    blue, green, red = np.meshgrid(levels, levels, levels, indexing="ij")
    cells = features(np.stack([red, green, blue], axis=-1))
    best = np.full(cells.shape[:-1], palette.tolerance**2)
    labels = np.full(cells.shape[:-1], Surface.OTHER, dtype=np.uint8)
    for surface, rgb in palette.colors:
        away = np.square(cells - features(np.array(rgb, dtype=np.float64))).sum(axis=-1)
        labels[away < best] = surface
        np.minimum(best, away, out=best)
    return frozen(labels)


def label_pixels(picture: Bytes, palette: Palette) -> Bytes:
    """The Surface of every pixel of a blue green red picture, shape (..., 3) -> (...)."""
    blue, green, red = np.moveaxis(picture >> (8 - CELL_BITS), -1, 0).astype(np.uint16)
    cells = (blue << (2 * CELL_BITS)) | (green << CELL_BITS) | red
    return np.asarray(labels_of(palette).reshape(-1)[cells])


def _palette(colors: Mapping[Surface, tuple[Rgb, ...]], tolerance: float, *, dark_feet: bool) -> Palette:
    return Palette(tuple((surface, rgb) for surface, many in colors.items() for rgb in many), tolerance, dark_feet)


RENDERED = _palette(
    {
        Surface.FLOOR: ((40, 105, 50), (24, 62, 30), (62, 150, 76)),
        Surface.BALL: ((250, 120, 30), (150, 66, 14)),
        Surface.WALL: ((232, 236, 228), (186, 184, 176), (130, 130, 124)),
        Surface.BLUE: ((20, 90, 200), (12, 54, 120)),
        Surface.YELLOW: ((235, 210, 40), (140, 124, 22)),
        Surface.DARK: ((30, 29, 30), (50, 50, 52), (14, 14, 14)),
    },
    0.3,
    dark_feet=True,
)
"""Of the rendered on-board camera: a green carpet, white lines and walls, goals and bands in the teams' colors."""

DRAWN = _palette(
    {
        Surface.FLOOR: (FLOOR, RING),
        Surface.BALL: (BALL,),
        Surface.WALL: (COLORS["w"],),
        Surface.GOAL_BLUE: (COLORS["u"],),
        Surface.GOAL_YELLOW: (COLORS["v"],),
        Surface.BLUE: (COLORS["x"],),
        Surface.YELLOW: (COLORS["y"],),
        Surface.DARK: (COLORS["r"],),
        Surface.OBSTACLE: (COLORS["q"],),
    },
    0.35,
    dark_feet=False,
)
"""Of the pictures that ``panorama.draw_panorama`` draws."""
