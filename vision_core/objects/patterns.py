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
    circles = np.array([patch.circle_mm for patch in pattern.patches], dtype=np.float64)
    return Marker(
        center_area_m2=_disc_area_m2(circles[0, 2]),
        dot_area_m2=_disc_area_m2(circles[1, 2]),
        slots_m=frozen(circles[1:, :2].copy() / 1000.0),
        dot_colors=pattern.code.colors,
        id_by_code={code: number for number, code in pattern.code_by_id.items()},
    )


def _disc_area_m2(diameter_mm: float) -> float:
    return math.pi * (diameter_mm / 2000.0) ** 2
