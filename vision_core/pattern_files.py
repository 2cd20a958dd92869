"""Loads marker patterns from ``config/patterns``: what robots wear, as data."""

import re
from typing import Annotated

import msgspec
from msgspec import Meta

from vision_core.errors import SettingsError
from vision_core.settings import Positive, Record
from vision_core.settings_files import find_file, read_layer


class Pattern(Record, frozen=True):
    """A marker of one dot in the team's color at the robot's center, and further dots that tell the id.

    Robot space: origin at the center dot, x forward, y left.
    """

    name: str
    center_diameter_mm: Positive
    dot_diameter_mm: Positive
    dots_mm: Annotated[tuple[tuple[float, float], ...], Meta(min_length=2, max_length=8)]
    dot_colors: Annotated[tuple[str, ...], Meta(min_length=2, max_length=8, description="color classes")]
    ids: Annotated[dict[str, str], Meta(min_length=1, description="id: initials of the dots' colors, in order")]

    @property
    def code_by_id(self) -> dict[int, str]:
        """Initials of the dots' colors, in capitals, by marker id."""
        return {int(key): code for key, code in self.ids.items()}


def load_pattern(name: str) -> Pattern:
    """A pattern by its file's name in config/patterns, or by a path. Raises SettingsError."""
    layer = read_layer(find_file("patterns", name))
    try:
        pattern = msgspec.convert(layer.table, Pattern)
    except msgspec.ValidationError as error:
        raise SettingsError(f"pattern {layer.name}", found=str(error)) from None
    initials = "".join(color[0].upper() for color in pattern.dot_colors)
    if len(set(initials)) < len(initials):
        raise SettingsError(f"pattern {layer.name}: dot_colors", found=initials, accepted="different initials")
    code = re.compile(f"[{initials}]{{{len(pattern.dots_mm)}}}")
    seen: dict[str, str] = {}
    for key, value in pattern.ids.items():
        if not key.isdecimal() or not code.fullmatch(value):
            accepted = f"a number and {len(pattern.dots_mm)} letters of {initials}"
            raise SettingsError(f"pattern {layer.name}: ids", found=f'{key} = "{value}"', accepted=accepted)
        if value in seen:
            raise SettingsError(
                f"pattern {layer.name}: ids",
                found=f"{seen[value]} and {key} both wear {value}",
                accepted="each code once",
            )
        seen[value] = key
    return pattern
