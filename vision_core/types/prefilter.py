"""A cheap test of colors, made from a color table: a color that it rejects has no class."""

from typing import NamedTuple

from vision_core.geometry import Bytes

CONDITIONS = 8
"""One channel stands out: 0 blue, 1 green, 2 red. One channel falls behind: 3 blue, 4 green, 5 red. 6 light, 7 dark."""


class ColorPrefilter(NamedTuple):
    """Eight conditions on a color; a color that meets none of them has class 0. Kernels take it as an argument.

    Conditions 0..2: the channel exceeds the larger of the other two by more than ``margin_limit``, and is itself above
    ``level_limit``. Conditions 3..5: the smaller of the other two exceeds the channel by more than ``margin_limit``,
    and is itself above ``level_limit``. Condition 6: the smallest channel is above ``level_limit[6]``. Condition 7: the
    largest channel is below ``level_limit[7]``.
    """

    margin_limit: Bytes
    """Shape (8,), of which 6 are used; 255: no color meets the condition."""
    level_limit: Bytes
    """Shape (8,)."""
