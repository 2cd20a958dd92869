"""How far two reports agree, direction by direction, within a direction and a pixel."""

from dataclasses import dataclass

import numpy as np

from vision_core.fidelity.reports import NOTHING, Report
from vision_core.geometry import Floats, Mask

REACH = 1
"""Directions: an edge may be so far aside."""
MAX_ERROR_PX = 1.0


@dataclass(frozen=True, slots=True)
class Agreement:
    """Of each direction, shape (n,)."""

    same_type: Mask
    """The other side has this type here or in a neighboring direction."""
    error_px: Floats
    """R of the first minus that of the other, of the neighbor of the same type with the smallest error; nan without
    one, 0 where both see nothing."""

    @property
    def agrees(self) -> Mask:
        """The type is the same and the distance is, within a pixel."""
        with np.errstate(invalid="ignore"):
            return self.same_type & (np.abs(self.error_px) <= MAX_ERROR_PX)


def compare(first: Report, other: Report, reach: int = REACH) -> Agreement:
    """Compare two reports of equally many directions; one of more: each of the first meets one in `finer` of them.

    reach: in directions of the other one.
    """
    n = len(first.letters)
    finer = len(other.letters) // n
    here = np.arange(n) * finer
    best = np.full(n, np.nan)
    same = np.zeros(n, dtype=np.bool_)
    px, other_px = first.px, other.px
    for shift in sorted(range(-reach, reach + 1), key=abs):
        there = (here + shift) % len(other.letters)
        alike = first.letters == other.letters[there]
        with np.errstate(invalid="ignore"):
            error = np.where(first.letters == NOTHING, 0.0, px - other_px[there])
            closer = alike & ~(np.abs(error) >= np.abs(best))
        best[closer] = error[closer]
        same |= alike
    return Agreement(same, best)
