"""What recognition needs of a marker pattern, derived once from its file."""

import math
from dataclasses import dataclass

import numpy as np

from vision_core.geometry import Floats, frozen
from vision_core.pattern_files import Pattern


@dataclass(frozen=True, slots=True)
class Marker:
    """A pattern in metres, and its codes the other way round."""

    center_area_m2: float
    dot_area_m2: float
    slots_m: Floats
    """Where the dots are in robot space, x forward, y left, shape (n, 2)."""
    dot_colors: tuple[str, ...]
    id_by_code: dict[str, int]
    """The id that wears a code: the initials of its dots' colors in the order of the slots."""


def marker_from(pattern: Pattern) -> Marker:
    """Derive areas, metres and the decoding table."""
    return Marker(
        center_area_m2=_disc_area_m2(pattern.center_diameter_mm),
        dot_area_m2=_disc_area_m2(pattern.dot_diameter_mm),
        slots_m=frozen(np.array(pattern.dots_mm, dtype=np.float64) / 1000.0),
        dot_colors=pattern.dot_colors,
        id_by_code={code: number for number, code in pattern.code_by_id.items()},
    )


def _disc_area_m2(diameter_mm: float) -> float:
    return math.pi * (diameter_mm / 2000.0) ** 2
