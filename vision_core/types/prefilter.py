"""A cheap test of colors, made from a color table: what it refuses is of no class."""

from typing import NamedTuple

from vision_core.geometry import Bytes

FORMS = 8
"""One channel stands out: 0 blue, 1 green, 2 red. One channel falls behind: 3 blue, 4 green, 5 red. 6 light, 7 dark."""


class Candidates(NamedTuple):
    """Eight forms of color; a color that passes none of them has class 0.

    Forms 0..2 pass where the channel exceeds the larger of the others, forms 3..5 where the smaller of the others
    exceeds the channel, by more than ``least_step``, and where that channel (that smaller one) is itself over
    ``least_level``. Form 6 passes where the smallest channel is over ``least_level[6]``, form 7 where the largest is
    under ``least_level[7]``. A compiled function can take it as an argument.
    """

    least_step: Bytes
    """Shape (8,), of which 6 are used; 255 is a form that nothing passes."""
    least_level: Bytes
    """Shape (8,)."""
