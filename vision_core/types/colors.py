"""2. image -> color classes."""

from dataclasses import dataclass

import numpy as np

from vision_core.geometry import Bytes


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
