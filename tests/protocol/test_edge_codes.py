"""The letters of the edge types on the wire."""

import pytest

from vision_core.errors import SettingsError
from vision_core.protocol.edge_codes import TYPES, edge_codes
from vision_core.types.edges import EDGE_TYPES, UNDEFINED, EdgeKind

CODES = edge_codes()


def letters(types: str, *codes: int) -> str:
    return "".join(chr(CODES[types][code]) for code in codes)


@pytest.mark.parametrize("types", TYPES)
def test_objects_have_the_same_letter_in_every_representation(types: str) -> None:
    kinds = (EdgeKind.NOTHING, EdgeKind.WALL, EdgeKind.GOAL_BLUE, EdgeKind.GOAL_YELLOW, EdgeKind.UNKNOWN)
    assert letters(types, *kinds) == "-wuvq"


@pytest.mark.parametrize("types", TYPES)
def test_a_code_without_a_type_is_visible(types: str) -> None:
    undefined = sorted(set(range(256)) - {code for edge in EDGE_TYPES for code in edge.codes})
    assert 255 in undefined
    assert letters(types, *undefined) == UNDEFINED * len(undefined)


def test_the_papers_three_representations_of_robots() -> None:
    robots = [EdgeKind.ROBOT_BLUE, EdgeKind.ROBOT_BLUE + 1, EdgeKind.ROBOT_BLUE + 16]
    robots += [EdgeKind.ROBOT_YELLOW, EdgeKind.ROBOT_YELLOW + 1, EdgeKind.ROBOT_YELLOW + 16]
    assert letters("same", *robots) == "rrrrrr"
    assert letters("team", *robots) == "xxxyyy"
    assert letters("number", *robots) == "xAPyap"


def test_the_settings_replace_letters() -> None:
    chosen = edge_codes({"wall": "!", "first_blue": "Q", "robot": "+"})
    assert [chr(chosen[types][EdgeKind.WALL]) for types in TYPES] == ["!", "!", "!"]
    assert chr(chosen["number"][EdgeKind.ROBOT_BLUE + 3]) == "S"
    assert chr(chosen["same"][EdgeKind.ROBOT_YELLOW + 3]) == "+"


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"wall": "("}, r"protocol.letters.wall; found: '\('; accepted: a printable character, no bracket"),
        ({"wall": " "}, "protocol.letters.wall; found: ' '"),
        ({"wall": "ww"}, "protocol.letters.wall; found: 'ww'; accepted: one character"),
        ({"wall": "u"}, "protocol.letters.wall; found: 'u', which means goal_blue too"),
        ({"wall": UNDEFINED}, "protocol.letters.wall"),
        ({"unknown": "C"}, "protocol.letters.unknown; found: 'C', which means first_blue too"),
        ({"first_blue": "x"}, "protocol.letters.first_blue; found: 'x', which means blue too"),
        ({"first_blue": "{"}, "protocol.letters.first_blue; .* and 15 more behind it"),
        ({"wal": "W"}, "protocol.letters.wal; found: no letter of this name; accepted: nothing, wall, goal_blue"),
    ],
)
def test_letters_that_cannot_be_told_apart_are_refused(change: dict[str, str], message: str) -> None:
    with pytest.raises(SettingsError, match=message):
        edge_codes(change)


def test_the_tables_cannot_be_changed() -> None:
    with pytest.raises(ValueError, match="read-only"):
        CODES["same"][0] = 0
