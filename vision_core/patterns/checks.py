"""What a pattern must be to be read in one way only. Each check raises SettingsError; name: of the pattern's file."""

import math
import re
from itertools import combinations, product

from vision_core.errors import SettingsError
from vision_core.patterns.geometry import (
    SAME_MM,
    Polygon,
    crosses_itself,
    gap_mm,
    overlap_mm,
    reach_mm,
    turns_onto,
    width_mm,
)
from vision_core.patterns.pattern import TEAM, Patch, Pattern, looks
from vision_core.settings.schema import RobotShape

MAX_OVERLAP_MM = 0.6
"""Patches may overlap by this width: cutting by hand is no more exact."""
MAX_BEYOND_MM = 0.05
MIN_WIDTH_MM = 2.0
HIGHEST_ID = 255


def check_letters(name: str, pattern: Pattern) -> None:
    """One patch has the team's color, and ids are written in the letters that the patches have."""
    teams = sum(patch.color == TEAM for patch in pattern.patches)
    if teams != 1:
        raise SettingsError(
            f"pattern {name}: patches", found=f"{teams} of color team", accepted="one in the team's color"
        )
    _check_shaped(name, pattern)
    for key, names in (("colors", pattern.code.colors), ("shapes", [shape.name for shape in pattern.code.shapes])):
        initials = "".join(one[0].upper() for one in names)
        if len(set(initials)) < len(initials):
            raise SettingsError(f"pattern {name}: code.{key}", found=initials, accepted="different initials")
    alphabets = pattern.alphabets
    code = re.compile("".join(f"[{letters}]" if letters else "(?!)" for letters in alphabets))
    seen: dict[str, str] = {}
    for key, value in pattern.code.ids.items():
        if not _is_id(key) or not code.fullmatch(value):
            count = "a letter" if len(alphabets) == 1 else f"{len(alphabets)} letters"
            letters = f"{count} of {alphabets[0] if alphabets else ''}"
            if len(set(alphabets)) > 1:
                letters = f"{len(alphabets)} letters, {', then '.join(f'one of {one}' for one in alphabets)}"
            accepted = f"a number of 0 to {HIGHEST_ID} and {letters}"
            raise SettingsError(f"pattern {name}: code.ids", found=f'{key} = "{value}"', accepted=accepted)
        if value in seen:
            raise SettingsError(
                f"pattern {name}: code.ids",
                found=f"{seen[value]} and {key} both wear {value}",
                accepted="each code once",
            )
        seen[value] = key


def _check_shaped(name: str, pattern: Pattern) -> None:
    """Patches whose shape is a letter are beside the team's, and there are shapes for them."""
    shaped = [number for number, patch in enumerate(pattern.patches, start=1) if patch.shapes_at_mm is not None]
    if shaped and len(pattern.code.shapes) < 2:
        found = f"{len(pattern.code.shapes)} for patch {shaped[0]}"
        raise SettingsError(f"pattern {name}: code.shapes", found=found, accepted="two or more shapes")
    if pattern.code.shapes and not shaped:
        accepted = "shapes_at_mm in the patch that has one of the shapes"
        raise SettingsError(f"pattern {name}: code.shapes", found="no patch for them", accepted=accepted)
    for number in shaped:
        patch = pattern.patches[number - 1]
        asked = f"pattern {name}: patch {number}"
        if patch.circle_mm is not None or patch.polygon_mm is not None:
            raise SettingsError(asked, found="shapes_at_mm and a shape", accepted="one of them")
        if patch.lies_over:
            raise SettingsError(asked, found="shapes_at_mm and lies_over", accepted="a patch beside the others")
        if patch.color == TEAM:
            accepted = "another patch for the shapes, or a pattern for each shape (robots.pattern = [...])"
            raise SettingsError(asked, found="shapes_at_mm in the team's patch", accepted=accepted)


def _is_id(key: str) -> bool:
    return re.fullmatch("0|[1-9][0-9]{0,2}", key) is not None and int(key) <= HIGHEST_ID


def check_geometry(name: str, pattern: Pattern) -> None:
    """Each patch is a patch, and they lie beside each other."""
    for number, patch in enumerate(pattern.patches, start=1):
        check_patch(f"pattern {name}: patch {number}", number, patch, pattern.robot)
    for layout in pattern.layouts:
        for (i, patch), (j, other) in combinations(enumerate(layout, start=1), 2):
            if (wide := overlap_mm(patch, other)) > MAX_OVERLAP_MM:
                raise SettingsError(
                    f"pattern {name}: patches {i} and {j}",
                    found=f"they overlap, {wide:.2g} mm wide",
                    accepted="patches beside each other, or lies_over = true in the one that hides a part of the other",
                )


def check_patch(asked: str, number: int, patch: Patch, robot: RobotShape) -> None:
    """One patch: a circle or a polygon, within the robot, and wide enough. asked: what it is, for the error."""
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


def check_looks(name: str, pattern: Pattern) -> None:
    """Patches of one color do not touch, and no robot, turned, looks like another one or like itself."""
    _check_blobs(name, pattern)
    _check_turns(name, pattern)


def _check_blobs(name: str, pattern: Pattern) -> None:
    """Patches of one color that touch are one blob."""
    touching = {
        layout: [(i, j) for i, j in combinations(range(len(layout)), 2) if gap_mm(layout[i], layout[j]) < SAME_MM]
        for layout in pattern.layouts
    }
    for team, marker_id, colors in looks(pattern):
        for i, j in touching[pattern.layout(marker_id)]:
            if colors[i] == colors[j]:
                raise SettingsError(
                    f"pattern {name}: id {marker_id}, team {team}",
                    found=f"patches {i + 1} and {j + 1} touch and are both {colors[i]}: a camera sees one",
                    accepted=f"different colors, or a gap of at least {SAME_MM:g} mm",
                )


def _check_turns(name: str, pattern: Pattern) -> None:
    """No robot looks like another one, or like itself, when it is turned."""
    worn = [(team, marker_id, colors, pattern.layout(marker_id)) for team, marker_id, colors in looks(pattern)]
    names = {(colors, layout): (team, marker_id) for team, marker_id, colors, layout in worn}
    layouts = list(pattern.layouts)
    for layout, other_layout in product(layouts, layouts):
        for turn, places in turns_onto(layout, other_layout):
            for team, marker_id, colors, own in worn:
                seen = [""] * len(colors)
                for patch, place in enumerate(places):
                    seen[place] = colors[patch]
                other = names.get((tuple(seen), other_layout)) if own == layout else None
                if other is not None and (turn or other != (team, marker_id)):
                    by = f"turned by {math.degrees(turn):.0f} deg" if turn else "as it is"
                    raise SettingsError(
                        f"pattern {name}: ambiguous",
                        found=f"{team} {marker_id} {by} looks like {other[0]} {other[1]}",
                        accepted="ids and headings that look different however the robot stands",
                    )
