"""Loads marker patterns from files (``config/patterns``, or one's own) and checks them.

Robot space: origin at the robot's center, x forward, y left; millimetres. Ambiguous patterns are refused: see
``docs/patterns.md``.
"""

import math
import re
from collections.abc import Iterator
from functools import lru_cache
from itertools import combinations
from pathlib import Path

import msgspec

from vision_core.errors import SettingsError
from vision_core.patterns.geometry import (
    SAME_MM,
    Polygon,
    crosses_itself,
    gap_mm,
    overlap_mm,
    reach_mm,
    turns_onto_itself,
    width_mm,
)
from vision_core.patterns.pattern import TEAM, Patch, Pattern, looks
from vision_core.settings.schema import RobotShape
from vision_core.venues.loader import Layer, find_file, read_layer

MAX_OVERLAP_MM = 0.6
"""Patches may overlap by this width: cutting by hand is no more exact."""
MAX_BEYOND_MM = 0.05
MIN_WIDTH_MM = 2.0
HIGHEST_ID = 255


def load_pattern(name: str) -> Pattern:
    """A pattern by its file's name in config/patterns, or by a path.

    A process parses and checks each file once, and again when the file has changed. Raises SettingsError.
    """
    path = find_file("patterns", name)
    try:
        changed_ns = path.stat().st_mtime_ns
    except (OSError, ValueError):  # ValueError: a NUL character in the name
        changed_ns = 0  # reading it says why
    return _loaded(path.absolute(), changed_ns)


@lru_cache(maxsize=32)
def _loaded(path: Path, _changed_ns: int) -> Pattern:
    layer = read_layer(path)
    try:
        pattern = msgspec.convert(layer.table, Pattern)
    except msgspec.ValidationError as error:
        raise SettingsError(f"pattern {layer.name}", found=str(error)) from None
    _check_teams(layer, pattern)
    pattern = _laid_over(layer, pattern)
    for number, patch in enumerate(pattern.patches, start=1):
        _check_patch(f"pattern {layer.name}: patch {number}", number, patch, pattern.robot)
    _check_overlaps(layer, pattern)
    _check_code(layer, pattern)
    _check_blobs(layer, pattern)
    _check_turns(layer, pattern)
    return pattern


def _laid_over(layer: Layer, pattern: Pattern) -> Pattern:
    """The pattern in which every patch knows what lies over it."""
    if any(patch.hidden_by for patch in pattern.patches):
        raise SettingsError(f"pattern {layer.name}: hidden_by", found="a list", accepted="lies_over = true above")
    patches = [
        msgspec.structs.replace(patch, hidden_by=tuple(_covers_of(patch, pattern.patches[number:])))
        for number, patch in enumerate(pattern.patches, start=1)
    ]
    return msgspec.structs.replace(pattern, patches=tuple(patches))


def _covers_of(patch: Patch, above: tuple[Patch, ...]) -> Iterator[Patch]:
    """Which of the patches above hide a part of a patch."""
    return (cover for cover in above if cover.lies_over and overlap_mm(patch, cover) > 0.0)


def _check_teams(layer: Layer, pattern: Pattern) -> None:
    teams = sum(patch.color == TEAM for patch in pattern.patches)
    if teams != 1:
        raise SettingsError(
            f"pattern {layer.name}: patches", found=f"{teams} of color team", accepted="one in the team's color"
        )


def _check_patch(asked: str, number: int, patch: Patch, robot: RobotShape) -> None:
    if (patch.circle_mm is None) == (patch.polygon_mm is None):
        raise SettingsError(asked, found="both or none", accepted="circle_mm or polygon_mm")
    numbers = patch.circle_mm or tuple(value for corner in patch.polygon_mm or () for value in corner)
    if not all(map(math.isfinite, numbers)):
        raise SettingsError(asked, found=str(list(numbers)), accepted="numbers")
    if patch.polygon_mm is not None:
        _check_polygon(asked, patch.polygon_mm)
    edge_mm = 1e3 * robot.radius_m
    if (reach := reach_mm(patch, robot.outline)) > edge_mm + MAX_BEYOND_MM:
        half = "half side" if robot.outline == "square" else "radius"
        found = f"patch {number} reaches {reach:.4g} mm from the center, the robot's {half} is {edge_mm:.4g} mm"
        raise SettingsError(asked, found=found, accepted="patches within the robot's outline")
    if (width := width_mm(patch)) < MIN_WIDTH_MM:
        raise SettingsError(asked, found=f"{width:.2g} mm wide", accepted=f"at least {MIN_WIDTH_MM:g} mm")


def _check_polygon(asked: str, corners: Polygon) -> None:
    if len(corners) > 64:
        raise SettingsError(asked, found=f"{len(corners)} corners", accepted="at most 64")
    if len(corners) < 4 or corners[0] != corners[-1]:
        ends = ", ".join(f"[{x:g}, {y:g}]" for x, y in (corners[0], corners[-1])) if corners else "nothing"
        found = f"{len(corners)} corners, first and last {ends}: not closed"
        raise SettingsError(asked, found=found, accepted="three or more corners, then the first again")
    if crosses_itself(corners):
        raise SettingsError(asked, found="sides that cross or touch each other", accepted="a simple polygon")


def _check_overlaps(layer: Layer, pattern: Pattern) -> None:
    for (i, patch), (j, other) in combinations(enumerate(pattern.patches, start=1), 2):
        if (wide := overlap_mm(patch, other)) > MAX_OVERLAP_MM:
            raise SettingsError(
                f"pattern {layer.name}: patches {i} and {j}",
                found=f"they overlap, {wide:.2g} mm wide",
                accepted="patches beside each other, or lies_over = true in the one that hides a part of the other",
            )


def _check_code(layer: Layer, pattern: Pattern) -> None:
    initials = "".join(color[0].upper() for color in pattern.code.colors)
    if len(set(initials)) < len(initials):
        raise SettingsError(f"pattern {layer.name}: code.colors", found=initials, accepted="different initials")
    code = re.compile(f"[{initials}]{{{pattern.digits}}}" if initials and pattern.digits else "")
    seen: dict[str, str] = {}
    for key, value in pattern.code.ids.items():
        if not _is_id(key) or len(value) != pattern.digits or not code.fullmatch(value):
            accepted = f"a number of 0 to {HIGHEST_ID} and {pattern.digits} letters of {initials}"
            raise SettingsError(f"pattern {layer.name}: code.ids", found=f'{key} = "{value}"', accepted=accepted)
        if value in seen:
            raise SettingsError(
                f"pattern {layer.name}: code.ids",
                found=f"{seen[value]} and {key} both wear {value}",
                accepted="each code once",
            )
        seen[value] = key


def _is_id(key: str) -> bool:
    return re.fullmatch("0|[1-9][0-9]{0,2}", key) is not None and int(key) <= HIGHEST_ID


def _check_blobs(layer: Layer, pattern: Pattern) -> None:
    """Patches of one color that touch are one blob."""
    numbered = list(enumerate(pattern.patches))
    touching = [(i, j) for (i, a), (j, b) in combinations(numbered, 2) if gap_mm(a, b) < SAME_MM]
    for team, marker_id, colors in looks(pattern):
        for i, j in touching:
            if colors[i] == colors[j]:
                raise SettingsError(
                    f"pattern {layer.name}: id {marker_id}, team {team}",
                    found=f"patches {i + 1} and {j + 1} touch and are both {colors[i]}: a camera sees one",
                    accepted=f"different colors, or a gap of at least {SAME_MM:g} mm",
                )


def _check_turns(layer: Layer, pattern: Pattern) -> None:
    """No robot looks like another one, or like itself, when it is turned."""
    worn = list(looks(pattern))
    names = {colors: (team, marker_id) for team, marker_id, colors in worn}
    for turn, places in turns_onto_itself(pattern.patches):
        for team, marker_id, colors in worn:
            seen = [""] * len(colors)
            for patch, place in enumerate(places):
                seen[place] = colors[patch]
            other = names.get(tuple(seen))
            if other is not None and (turn or other != (team, marker_id)):
                by = f"turned by {math.degrees(turn):.0f} deg" if turn else "as it is"
                raise SettingsError(
                    f"pattern {layer.name}: ambiguous",
                    found=f"{team} {marker_id} {by} looks like {other[0]} {other[1]}",
                    accepted="ids and headings that look different however the robot stands",
                )
