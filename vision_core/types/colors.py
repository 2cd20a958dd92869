"""2. image -> color classes."""

from dataclasses import dataclass
from typing import Any, NamedTuple, TypeAlias

import numpy as np

from vision_core.geometry import Bytes, Floats, frozen
from vision_core.types.reasons import Reason

Levels: TypeAlias = tuple[float, float, float]
"""Blue, green, red in grey levels, or a factor for each of them."""

LUMA_BGR = frozen(np.array([0.114, 0.587, 0.299]))
"""Weights of blue, green and red in the luma (ITU-R BT.601)."""

CELL_COUNT = 1 << 16
"""Cells of the color table: 5 bits of blue, 6 of green, 5 of red."""
CELL_SIZE_BGR = (8, 4, 8)
"""Grey levels that share a cell, per channel."""
CELL_BITS_BGR = ((3, 11), (2, 5), (3, 0))
"""Per channel: how many low bits are dropped, and at which bit of the cell's index the rest is placed."""


(_BLUE_DROP, _BLUE_PLACE), (_GREEN_DROP, _GREEN_PLACE), (_RED_DROP, _RED_PLACE) = CELL_BITS_BGR


def cell_index(blue: Any, green: Any, red: Any) -> Any:
    """Index of the cell that a color falls into, for integers or integer arrays; levels 0..255 of at least 32 bits."""
    return blue >> _BLUE_DROP << _BLUE_PLACE | green >> _GREEN_DROP << _GREEN_PLACE | red >> _RED_DROP << _RED_PLACE


def cell_corner(index: Any) -> tuple[Any, Any, Any]:
    """The smallest blue, green and red of a cell, for integers or integer arrays."""
    return (index >> 11) * 8, (index >> 5 & 63) * 4, (index & 31) * 8


DARK_LEVEL = 24.0
"""Added to every channel before ratios are taken [grey levels]: near black they are noise."""


def chromaticity(bgr: Floats) -> Floats:
    """log B/G and log R/G of colors: shape (..., 3) -> (..., 2).

    Half the light leaves it as it is, and another color of the light adds the same vector to every paint (von Kries),
    so that what differs between two papers of one marker stays.
    """
    logs = np.log(np.asarray(bgr, dtype=np.float64) + DARK_LEVEL)
    return np.stack([logs[..., 0] - logs[..., 1], logs[..., 2] - logs[..., 1]], axis=-1)


class References(NamedTuple):
    """What each class of a color table looks like. Kernels take it as one argument."""

    means: Floats
    """Chromaticity of every class, shape (classes, 2)."""
    spreads: Floats
    """Its covariance: xx, xy, yy; shape (classes, 3)."""


@dataclass(frozen=True, slots=True)
class Light:
    """How a picture's light differs from the light of the venue's colors: venue = (pixel - black) * gain."""

    black_bgr: Levels
    """What the sensor delivers in the dark [grey levels]."""
    gain_bgr: Levels
    """1 for each channel where the light could not be measured."""
    reason: Reason | None = None
    """Why it could not be measured; None when it could."""

    @property
    def neutral(self) -> bool:
        """Does it leave pictures as they are?"""
        return self.black_bgr == (0.0, 0.0, 0.0) and self.gain_bgr == (1.0, 1.0, 1.0)


@dataclass(frozen=True, slots=True)
class ColorTable:
    """Class of every quantized color. Class 0 is no class; class k is ``names[k]``."""

    names: tuple[str, ...]
    """names[0] is the empty string."""
    classes: Bytes
    """Class of each cell, by ``cell_index``; shape (65536,)."""
    mean_bgr: Bytes
    """A typical color of each class, to draw it; shape (len(names), 3)."""
    disputed: tuple[tuple[str, str, int], ...]
    """Pairs of classes that claim the same cells, and how many cells; the class named first gets them."""
    references: References

    def index(self, name: str) -> int:
        """Number of a class by its name."""
        return self.names.index(name)

    def classes_of(self, bgr: Bytes) -> Bytes:
        """Class of each color: shape (..., 3) -> shape (...)."""
        classes: Bytes = self.classes[cell_index(*np.moveaxis(bgr.astype(np.intp), -1, 0))]
        return classes
