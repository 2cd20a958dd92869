"""The edge types: what a ray of a view can hit. This table is the only place that lists them.

From it come the letters of the wire (``protocol.edge_codes``), the colors of the simulated on-board picture
(``client.panorama``), the colors and labels of the page (through ``/api/v1/field``), and the check of the list in
docs/protocol.md. A new edge type is one member of EdgeKind, one row of EDGE_TYPES and one row in docs/protocol.md.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from enum import IntEnum
from typing import Final

from vision_core.types.tables import MAX_NUMBERS

Rgb = tuple[int, int, int]
"""Red, green, blue, 0..255."""


class EdgeKind(IntEnum):
    """Code of an edge type: one byte per ray of a view.

    The code of a robot is ROBOT_BLUE or ROBOT_YELLOW plus its number; plus 0 when its number is not known.
    """

    NOTHING = 0
    WALL = 1
    GOAL_BLUE = 2
    GOAL_YELLOW = 3
    UNKNOWN = 4
    ROBOT_BLUE = 16
    ROBOT_YELLOW = 48


@dataclass(frozen=True, slots=True)
class Letter:
    """A letter of the wire, or several consecutive ones."""

    key: str
    """Its name in the settings: protocol.letters.<key> replaces the default."""
    default: str
    color: Rgb
    """In the simulated on-board picture."""
    count: int = 1
    """How many consecutive letters there are: of robots 1, 2, ..."""


@dataclass(frozen=True, slots=True)
class EdgeType:
    """One row of the table."""

    kind: EdgeKind
    meaning: str
    source: str
    """Which code makes such edges."""
    label: str
    """What the page writes beside such an edge; a robot's number follows."""
    legend: str
    """Its word in the page's legend, which types may share; empty: not in the legend."""
    on_light: str
    """Color on the page's light theme, #rrggbb."""
    on_dark: str
    """Color on the page's dark theme, #rrggbb."""
    same: Letter
    """Its letter in ``(types same)``."""
    team: Letter
    """Its letter in ``(types team)``."""
    number: Letter
    """Its letter in ``(types number)``; of a robot, when its number is not known."""
    numbered: Letter | None = None
    """Letters of a robot 1, 2, ... in ``(types number)``."""

    @property
    def codes(self) -> range:
        """The codes of this type; of a robot, code i is number i."""
        return range(self.kind, self.kind + 1 + (self.numbered.count if self.numbered else 0))

    @property
    def letters(self) -> tuple[Letter, ...]:
        """Its letters, each once."""
        all_of_them = (self.same, self.team, self.number, *([self.numbered] if self.numbered else []))
        return tuple(dict.fromkeys(all_of_them))


def _object(
    kind: EdgeKind, meaning: str, source: str, label: str, legend: str, page: tuple[str, str], letter: Letter
) -> EdgeType:
    """A type with the same letter in all three representations. page: colors on the light and on the dark theme."""
    return EdgeType(kind, meaning, source, label, legend, *page, letter, letter, letter)


BLUE_RGB, YELLOW_RGB = (42, 98, 214), (240, 200, 40)
BLUE_ON_PAGE, YELLOW_ON_PAGE = ("#1d5fd6", "#5b9bff"), ("#b98000", "#f2c230")
ANY_ROBOT = Letter("robot", "r", (58, 60, 66))
BLUE, YELLOW = Letter("blue", "x", BLUE_RGB), Letter("yellow", "y", YELLOW_RGB)

EDGE_TYPES: Final = (
    _object(
        EdgeKind.NOTHING, "nothing within range", "views.splat: rays that hit nothing", "", "",
        ("#5d6873", "#a9b4bd"), Letter("nothing", "-", (16, 18, 22)),
    ),
    _object(
        EdgeKind.WALL, "a wall, or the limit of the field", "models.field: walls, limits", "", "wall",
        ("#5d6873", "#a9b4bd"), Letter("wall", "w", (236, 236, 230)),
    ),
    _object(
        EdgeKind.GOAL_BLUE, "the goal that blue defends", "models.field: goals", "G", "goal",
        BLUE_ON_PAGE, Letter("goal_blue", "u", (34, 38, 132)),
    ),
    _object(
        EdgeKind.GOAL_YELLOW, "the goal that yellow defends", "models.field: goals", "G", "goal",
        YELLOW_ON_PAGE, Letter("goal_yellow", "v", (196, 150, 20)),
    ),
    _object(
        EdgeKind.UNKNOWN, "an obstacle: an object that is no known robot", "views.outlines: obstacles", "?", "obstacle",
        ("#963c96", "#e08ae0"), Letter("unknown", "q", (150, 60, 150)),
    ),
    EdgeType(
        EdgeKind.ROBOT_BLUE, "a robot of blue", "views.outlines: robots", "B", "robot", *BLUE_ON_PAGE,
        ANY_ROBOT, BLUE, BLUE, Letter("first_blue", "A", BLUE_RGB, MAX_NUMBERS),
    ),
    EdgeType(
        EdgeKind.ROBOT_YELLOW, "a robot of yellow", "views.outlines: robots", "Y", "robot", *YELLOW_ON_PAGE,
        ANY_ROBOT, YELLOW, YELLOW, Letter("first_yellow", "a", YELLOW_RGB, MAX_NUMBERS),
    ),
)  # fmt: skip

UNDEFINED = "?"
"""Sent for a code that is in no row, so that a mistake is visible; no edge type may have this letter."""
BRACKETS = "()"


def all_letters() -> tuple[Letter, ...]:
    """Every letter of the table, each once."""
    return tuple(dict.fromkeys(letter for edge in EDGE_TYPES for letter in edge.letters))


def edge_type_of(code: int) -> EdgeType:
    """The row of a code. Raises ValueError for a code that is in none."""
    for edge in EDGE_TYPES:
        if code in edge.codes:
            return edge
    raise ValueError(f"edge code {code} is in no row of EDGE_TYPES")


def letter_faults(chosen: Mapping[str, str]) -> Iterator[tuple[str, str, str]]:
    """What is wrong with letters that replace the defaults: (key, what was found, what is accepted).

    chosen: letters by key. Every letter must be printable, no bracket, not UNDEFINED, and have one meaning only.
    """
    known = {letter.key: letter for letter in all_letters()}
    for key in chosen:
        if key not in known:
            yield key, "no letter of this name", ", ".join(known)
    meanings: dict[str, str] = {}
    for key in sorted(known, key=lambda name: name in chosen):  # of two alike, the fault is the one that was chosen
        letter = known[key]
        first = chosen.get(key, letter.default)
        if len(first) != 1:
            yield key, repr(first), "one character"
            continue
        for character in (chr(ord(first) + offset) for offset in range(letter.count)):
            if not "!" <= character <= "~" or character in BRACKETS + UNDEFINED:
                behind = f" and {letter.count - 1} more behind it" if letter.count > 1 else ""
                yield key, repr(character), f"a printable character{behind}, no bracket, not {UNDEFINED}"
                break
            if character in meanings:
                yield key, f"{character!r}, which means {meanings[character]} too", "another letter for each meaning"
                break
            meanings[character] = key
