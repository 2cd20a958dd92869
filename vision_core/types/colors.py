"""2. image -> color classes."""

from dataclasses import dataclass

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
