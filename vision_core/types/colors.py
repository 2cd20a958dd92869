"""2. image -> color classes."""

from dataclasses import dataclass
from typing import TypeAlias

import numpy as np

from vision_core.geometry import Bytes

Levels: TypeAlias = tuple[float, float, float]
"""Blue, green, red in grey levels, or a factor for each of them."""


@dataclass(frozen=True, slots=True)
class Light:
    """How a picture's light differs from the one the colors were tuned in: venue = (pixel - black) * gain."""

    black_bgr: Levels
    """What the sensor says in the dark."""
    gain_bgr: Levels
    """1 for each channel where the light could not be judged."""
    reason: str = ""
    """Why it could not be judged; empty when it could."""

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
    """Shape (65536,): class at index (b >> 3) << 11 | (g >> 2) << 5 | (r >> 3)."""
    mean_bgr: Bytes
    """Shape (len(names), 3): a typical color of each class, to draw it."""
    disputed: tuple[tuple[str, str, int], ...]
    """Pairs of classes that claim the same cells, and how many; the class named first keeps them."""

    def index(self, name: str) -> int:
        """Number of a class by its name."""
        return self.names.index(name)

    def classes_of(self, bgr: Bytes) -> Bytes:
        """Class of each color: shape (..., 3) -> shape (...)."""
        blue, green, red = (bgr[..., channel].astype(np.intp) for channel in range(3))
        classes: Bytes = self.classes[(blue >> 3) << 11 | (green >> 2) << 5 | red >> 3]
        return classes
