"""A marker as its file describes it: patches of colored paper, and how ids are written with them.

Robot space: origin at the robot's center, x forward, y left; millimetres.
"""

from collections.abc import Iterator
from typing import Annotated

import msgspec
from msgspec import Meta

from vision_core.settings.schema import Point2, Record, RobotShape
from vision_core.types.objects import Team

TEAM, CODE = "team", "code"
"""Names for the colors of patches that differ from robot to robot; any other color is a class that all robots wear."""

ColorName = Annotated[str, Meta(pattern="^[A-Za-z][A-Za-z0-9_-]*$")]


class Patch(Record, frozen=True):
    """A piece of colored paper: a circle, or a polygon whose last corner is its first."""

    color: Annotated[ColorName, Meta(description="team: the team's color; code: a digit of the id; or a color class")]
    circle_mm: Annotated[tuple[float, float, float] | None, Meta(description="center x, y, diameter")] = None
    polygon_mm: Annotated[tuple[Point2, ...] | None, Meta(description="corners; the first closes it")] = None
    lies_over: Annotated[bool, Meta(description="it lies over the patches before it and hides what it covers")] = False
    hidden_by: Annotated[tuple["Patch", ...], Meta(description="follows from lies_over; in no file")] = ()


class Code(Record, frozen=True):
    """How ids are written."""

    colors: Annotated[tuple[ColorName, ...], Meta(max_length=8, description="color classes of different initials")]
    ids: Annotated[dict[str, str], Meta(min_length=1, description="id: initials of the code patches, in order")]


class Pattern(Record, frozen=True):
    """A marker: one patch in the team's color, and further ones from which heading and id follow."""

    name: Annotated[str, Meta(min_length=1)]
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

    def colors_worn(self, team: Team, marker_id: int) -> tuple[str, ...]:
        """The color class of every patch of a team's robot. Raises KeyError for an id that the pattern lacks."""
        by_initial = {color[0].upper(): color for color in self.code.colors}
        digits = iter(self.code_by_id[marker_id])
        return tuple(
            by_initial[next(digits)] if patch.color == CODE else str(team) if patch.color == TEAM else patch.color
            for patch in self.patches
        )


def scaled(pattern: Pattern, factor: float) -> Pattern:
    """The same marker, larger or smaller."""
    return msgspec.structs.replace(pattern, patches=_stretched(pattern.patches, factor, factor))


def mirrored(pattern: Pattern) -> Pattern:
    """The same marker in a mirror: left and right exchanged."""
    return msgspec.structs.replace(pattern, patches=_stretched(pattern.patches, 1.0, -1.0))


def _stretched(patches: tuple[Patch, ...], ahead: float, aside: float) -> tuple[Patch, ...]:
    """Patches with their places multiplied, and circles' diameters by the first factor."""
    return tuple(
        msgspec.structs.replace(
            patch,
            circle_mm=(ahead * patch.circle_mm[0], aside * patch.circle_mm[1], ahead * patch.circle_mm[2])
            if patch.circle_mm
            else None,
            polygon_mm=tuple((ahead * x, aside * y) for x, y in patch.polygon_mm) if patch.polygon_mm else None,
            hidden_by=_stretched(patch.hidden_by, ahead, aside),
        )
        for patch in patches
    )


def looks(pattern: Pattern) -> Iterator[tuple[Team, int, tuple[str, ...]]]:
    """Team, id and the colors of the patches of every robot that can wear a pattern."""
    for team in Team:
        for marker_id in pattern.code_by_id:
            yield team, marker_id, pattern.colors_worn(team, marker_id)
