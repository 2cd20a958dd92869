"""Does a venue's palette have the colors of a pattern, and does it separate them?"""

from collections.abc import Collection
from dataclasses import dataclass

from vision_core.color.lookup_table import compile_color_table
from vision_core.settings.schema import Settings


@dataclass(frozen=True, slots=True)
class ColorReport:
    """Missing and overlapping classes of a palette, for a set of colors."""

    missing: tuple[str, ...]
    disputed: tuple[tuple[str, str, int], ...]
    """Pairs of needed classes with the number of colors that both contain; the first of the pair gets them."""


def report_on_colors(colors: Collection[str], settings: Settings) -> ColorReport:
    """Judge the classes that robots of some colors and the venue's ball need."""
    table = compile_color_table(settings.colors)
    missing = tuple(color for color in colors if color not in table.names)
    needed = {*colors, settings.ball.color}
    disputed = tuple(found for found in table.disputed if found[0] in needed and found[1] in needed)
    return ColorReport(missing, disputed)
