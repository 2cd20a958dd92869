"""Loads marker patterns from ``config/patterns``: what robots wear, as data.

Robot space: origin at the robot's center, x forward, y left; millimetres.
"""

import re
from typing import Annotated

import msgspec
from msgspec import Meta

from vision_core.errors import SettingsError
from vision_core.settings import Point2, Record, RobotShape
from vision_core.settings_files import Layer, find_file, read_layer

TEAM, CODE = "team", "code"
"""Colors of patches that differ from robot to robot; any other color is a color class that all wear."""


class Patch(Record, frozen=True):
    """A piece of colored paper: a circle, or a polygon whose last corner is its first."""

    color: Annotated[str, Meta(description="team: the team's color; code: a digit of the id; or a color class")]
    circle_mm: Annotated[tuple[float, float, float] | None, Meta(description="center x, y, diameter")] = None
    polygon_mm: tuple[Point2, ...] | None = None


class Code(Record, frozen=True):
    """How ids are written."""

    colors: Annotated[tuple[str, ...], Meta(max_length=8, description="color classes of different initials")]
    ids: Annotated[dict[str, str], Meta(min_length=1, description="id: initials of the code patches, in order")]


class Pattern(Record, frozen=True):
    """A marker: one patch in the team's color, and further ones that tell heading and id."""

    name: str
    robot: RobotShape
    patches: Annotated[tuple[Patch, ...], Meta(min_length=1, max_length=9)]
    code: Code

    @property
    def code_by_id(self) -> dict[int, str]:
        """Initials of the code patches' colors, in capitals, by marker id."""
        return {int(key): code for key, code in self.code.ids.items()}

    @property
    def digits(self) -> int:
        """How many code patches there are."""
        return sum(patch.color == CODE for patch in self.patches)


def load_pattern(name: str) -> Pattern:
    """A pattern by its file's name in config/patterns, or by a path. Raises SettingsError."""
    layer = read_layer(find_file("patterns", name))
    try:
        pattern = msgspec.convert(layer.table, Pattern)
    except msgspec.ValidationError as error:
        raise SettingsError(f"pattern {layer.name}", found=str(error)) from None
    _check_patches(layer, pattern)
    _check_code(layer, pattern)
    return pattern


def _check_patches(layer: Layer, pattern: Pattern) -> None:
    teams = sum(patch.color == TEAM for patch in pattern.patches)
    if teams != 1:
        raise SettingsError(
            f"pattern {layer.name}: patches", found=f"{teams} of color team", accepted="one in the team's color"
        )
    for number, patch in enumerate(pattern.patches, start=1):
        if (patch.circle_mm is None) == (patch.polygon_mm is None):
            raise SettingsError(
                f"pattern {layer.name}: patch {number}", found="both or none", accepted="circle_mm or polygon_mm"
            )


def _check_code(layer: Layer, pattern: Pattern) -> None:
    initials = "".join(color[0].upper() for color in pattern.code.colors)
    if len(set(initials)) < len(initials):
        raise SettingsError(f"pattern {layer.name}: code.colors", found=initials, accepted="different initials")
    code = re.compile(f"[{initials}]{{{pattern.digits}}}" if pattern.digits else "")
    seen: dict[str, str] = {}
    for key, value in pattern.code.ids.items():
        if not key.isdecimal() or not code.fullmatch(value):
            accepted = f"a number and {pattern.digits} letters of {initials}"
            raise SettingsError(f"pattern {layer.name}: code.ids", found=f'{key} = "{value}"', accepted=accepted)
        if value in seen:
            raise SettingsError(
                f"pattern {layer.name}: code.ids",
                found=f"{seen[value]} and {key} both wear {value}",
                accepted="each code once",
            )
        seen[value] = key
