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


NO_SHAPE = -1
"""The number of the shape of a patch that all robots wear in one shape."""


class CodeShape(Record, frozen=True):
    """A shape that tells a letter of the id: a circle, or a polygon whose last corner is its first."""

    name: Annotated[ColorName, Meta(description="its initial is the letter")]
    circle_mm: Annotated[tuple[float, float, float] | None, Meta(description="center x, y, diameter")] = None
    polygon_mm: Annotated[tuple[Point2, ...] | None, Meta(description="corners; the first closes it")] = None


class Patch(Record, frozen=True):
    """A piece of colored paper: a circle, or a polygon whose last corner is its first, or one of the code's shapes."""

    color: Annotated[ColorName, Meta(description="team: the team's color; code: a digit of the id; or a color class")]
    circle_mm: Annotated[tuple[float, float, float] | None, Meta(description="center x, y, diameter")] = None
    polygon_mm: Annotated[tuple[Point2, ...] | None, Meta(description="corners; the first closes it")] = None
    shapes_at_mm: Annotated[
        Point2 | None, Meta(description="its shape is a letter of the id: the origin of code.shapes lies here")
    ] = None
    lies_over: Annotated[bool, Meta(description="it lies over the patches before it and hides what it covers")] = False
    hidden_by: Annotated[tuple["Patch", ...], Meta(description="follows from lies_over; in no file")] = ()
    shapes: Annotated[tuple["Patch", ...], Meta(description="follows from shapes_at_mm; in no file")] = ()
    """It in each of the code's shapes. Its own circle is then the largest that all of them contain in the middle."""


class Code(Record, frozen=True):
    """How ids are written."""

    colors: Annotated[tuple[ColorName, ...], Meta(max_length=8, description="color classes of different initials")]
    ids: Annotated[
        dict[str, str],
        Meta(min_length=1, description="id: initials of the code patches' colors and shapes, in order of the patches"),
    ]
    shapes: Annotated[tuple[CodeShape, ...], Meta(max_length=8, description="shapes of different initials")] = ()


class Pattern(Record, frozen=True):
    """A marker: one patch in the team's color, and further ones from which heading and id follow."""

    name: Annotated[str, Meta(min_length=1)]
    robot: RobotShape
    patches: Annotated[tuple[Patch, ...], Meta(min_length=1, max_length=9)]
    code: Code
    team_colors: Annotated[
        dict[Team, ColorName], Meta(description="color class of the team's patch, where it is not the team's name")
    ] = msgspec.field(default_factory=dict)

    def team_color(self, team: Team) -> str:
        """The color class of a team's patch."""
        return self.team_colors.get(team, str(team))

    @property
    def code_by_id(self) -> dict[int, str]:
        """Initials of the code patches' colors and shapes, in capitals, by marker id."""
        return {int(key): code for key, code in self.code.ids.items()}

    @property
    def alphabets(self) -> list[str]:
        """The letters that each place of a code may have."""
        found = []
        for patch in self.patches:
            if patch.color == CODE:
                found.append("".join(color[0].upper() for color in self.code.colors))
            if patch.shapes_at_mm is not None:
                found.append("".join(shape.name[0].upper() for shape in self.code.shapes))
        return found

    @property
    def digits(self) -> int:
        """How many letters a code has."""
        return len(self.alphabets)

    def colors_worn(self, team: Team, marker_id: int) -> tuple[str, ...]:
        """The color class of every patch of a team's robot. Raises KeyError for an id that the pattern lacks."""
        by_initial = {color[0].upper(): color for color in self.code.colors}
        return tuple(
            by_initial[color] if color else self.team_color(team) if patch.color == TEAM else patch.color
            for patch, color, _ in self.letters(marker_id)
        )

    def shapes_worn(self, marker_id: int) -> tuple[int, ...]:
        """Which of its shapes every patch of a robot has, or NO_SHAPE. Raises KeyError as ``colors_worn``."""
        initials = [shape.name[0].upper() for shape in self.code.shapes]
        return tuple(initials.index(shape) if shape else NO_SHAPE for _, _, shape in self.letters(marker_id))

    def layout(self, marker_id: int) -> tuple[Patch, ...]:
        """The patches of a robot, each in the shape that it wears. Raises KeyError as ``colors_worn``."""
        worn = zip(self.patches, self.shapes_worn(marker_id), strict=True)
        return tuple(patch if shape == NO_SHAPE else patch.shapes[shape] for patch, shape in worn)

    @property
    def layouts(self) -> dict[tuple[Patch, ...], list[int]]:
        """The ids that wear their patches in the same shapes; a pattern without shapes in its code has one layout."""
        found: dict[tuple[Patch, ...], list[int]] = {}
        for marker_id in self.code_by_id:
            found.setdefault(self.layout(marker_id), []).append(marker_id)
        return found

    def letters(self, marker_id: int) -> Iterator[tuple[Patch, str, str]]:
        """Every patch with the letters of its color and of its shape, empty where all robots have the same."""
        letters = iter(self.code_by_id[marker_id])
        for patch in self.patches:
            color = next(letters) if patch.color == CODE else ""
            yield patch, color, next(letters) if patch.shapes_at_mm is not None else ""


def scaled(pattern: Pattern, factor: float) -> Pattern:
    """The same marker, larger or smaller."""
    return msgspec.structs.replace(pattern, patches=_stretched(pattern.patches, factor, factor))


def mirrored(pattern: Pattern) -> Pattern:
    """The same marker in a mirror: left and right exchanged."""
    return msgspec.structs.replace(pattern, patches=_stretched(pattern.patches, 1.0, -1.0))


def _stretched(patches: tuple[Patch, ...], ahead: float, aside: float) -> tuple[Patch, ...]:
    """Patches with their places multiplied, and circles' diameters by the first factor. The code's shapes stay."""
    return tuple(
        msgspec.structs.replace(
            patch,
            circle_mm=(ahead * patch.circle_mm[0], aside * patch.circle_mm[1], ahead * patch.circle_mm[2])
            if patch.circle_mm
            else None,
            polygon_mm=tuple((ahead * x, aside * y) for x, y in patch.polygon_mm) if patch.polygon_mm else None,
            shapes_at_mm=(ahead * patch.shapes_at_mm[0], aside * patch.shapes_at_mm[1]) if patch.shapes_at_mm else None,
            hidden_by=_stretched(patch.hidden_by, ahead, aside),
            shapes=_stretched(patch.shapes, ahead, aside),
        )
        for patch in patches
    )


def looks(pattern: Pattern) -> Iterator[tuple[Team, int, tuple[str, ...]]]:
    """Team, id and the colors of the patches of every robot that can wear a pattern."""
    for team in Team:
        for marker_id in pattern.code_by_id:
            yield team, marker_id, pattern.colors_worn(team, marker_id)
