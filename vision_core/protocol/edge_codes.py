"""Edge types on the wire: kinds of edges -> letters, in the paper's three representations (section 3.2)."""

from dataclasses import dataclass, fields
from functools import lru_cache

import numpy as np

from vision_core.errors import SettingsError
from vision_core.geometry import Bytes, frozen
from vision_core.protocol.messages import MAX_NUMBER
from vision_core.types.field import EdgeKind

BRACKETS = "()"


@dataclass(frozen=True, slots=True)
class LetterTable:
    """One letter per meaning. Robots by number take 16 letters in a row.

    Raises SettingsError unless all are printable, no brackets, and every letter means one thing.
    """

    nothing: str
    wall: str
    goal_blue: str
    goal_yellow: str
    unknown: str
    robot: str
    """Any robot, in ``(types same)``."""
    blue: str
    """A robot of the blue team in ``(types team)``, or one whose number is not known."""
    yellow: str
    first_blue: str
    """Blue 1 in ``(types number)``."""
    first_yellow: str

    def __post_init__(self) -> None:
        meant: dict[str, str] = {}
        for field in fields(self):
            first = getattr(self, field.name)
            if len(first) != 1 or not "!" <= first <= "~":
                raise SettingsError(f"letter {field.name}", found=repr(first), accepted="one printable character")
            count = MAX_NUMBER if field.name.startswith("first_") else 1
            for letter in (chr(ord(first) + i) for i in range(count)):
                if letter > "~" or letter in BRACKETS:
                    raise SettingsError(f"letter {field.name}", found=repr(letter), accepted="letters, no bracket")
                if letter in meant:
                    found = f"{letter!r} means {meant[letter]} too"
                    raise SettingsError(f"letter {field.name}", found=found, accepted="letters of its own")
                meant[letter] = field.name


@lru_cache(maxsize=16)
def letters_by_kind(table: LetterTable, types: str) -> Bytes:
    """ASCII letter of every EdgeKind for ``(types same|team|number)``, shape (256,), read-only."""
    letters = np.full(256, ord(table.unknown), dtype=np.uint8)
    for kind, letter in (
        (EdgeKind.NOTHING, table.nothing),
        (EdgeKind.WALL, table.wall),
        (EdgeKind.GOAL_BLUE, table.goal_blue),
        (EdgeKind.GOAL_YELLOW, table.goal_yellow),
    ):
        letters[kind] = ord(letter)
    for first, team, numbered in (
        (EdgeKind.ROBOT_BLUE, table.blue, table.first_blue),
        (EdgeKind.ROBOT_YELLOW, table.yellow, table.first_yellow),
    ):
        letters[first : first + MAX_NUMBER + 1] = ord(table.robot if types == "same" else team)
        if types == "number":
            letters[first + 1 : first + MAX_NUMBER + 1] = ord(numbered) + np.arange(MAX_NUMBER)
    return frozen(letters)
