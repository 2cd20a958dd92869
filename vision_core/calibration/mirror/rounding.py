"""Were radii cut to whole numbers?

Equation 1 cuts R to a whole number, and so is everything that was read from a ``see`` message: the true
radius lies in [R, R + 1). Half a pixel is added to such radii, which makes the mean error 0 and leaves 1/sqrt(12) px.
Without a word from the user, pairs count as cut when all of their radii are whole numbers; the verdict says so.
"""

from enum import StrEnum


class Rounding(StrEnum):
    """What the radii of pairs are."""

    AUTO = "auto"
    """Cut when all of them are whole numbers, else exact."""
    CUT = "int"
    """Cut to whole numbers, as in ``see``: half a pixel is added."""
    EXACT = "exact"
    """As they were measured."""
