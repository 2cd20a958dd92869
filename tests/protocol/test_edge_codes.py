"""Every letter means one thing."""

from dataclasses import asdict, replace

import pytest

from tests.protocol.samples import LETTERS
from vision_core.errors import SettingsError
from vision_core.protocol.edge_codes import LetterTable, letters_by_kind
from vision_core.types.field import EdgeKind
from vision_core.venues.loader import load_settings


def letter(kind: int, types: str) -> str:
    return chr(letters_by_kind(LETTERS, types)[kind])


@pytest.mark.parametrize("types", ["same", "team", "number"])
def test_things_keep_their_letters(types: str) -> None:
    kinds = (EdgeKind.NOTHING, EdgeKind.WALL, EdgeKind.GOAL_BLUE, EdgeKind.GOAL_YELLOW, EdgeKind.UNKNOWN)
    assert "".join(letter(kind, types) for kind in kinds) == "-wuvq"
    assert letter(200, types) == "q"


def test_the_papers_three_representations_of_robots() -> None:
    robots = [EdgeKind.ROBOT_BLUE, EdgeKind.ROBOT_BLUE + 1, EdgeKind.ROBOT_BLUE + 16]
    robots += [EdgeKind.ROBOT_YELLOW, EdgeKind.ROBOT_YELLOW + 1, EdgeKind.ROBOT_YELLOW + 16]
    assert "".join(letter(robot, "same") for robot in robots) == "rrrrrr"
    assert "".join(letter(robot, "team") for robot in robots) == "xxxyyy"
    assert "".join(letter(robot, "number") for robot in robots) == "xAPyap"


def test_the_configuration_holds_these_letters() -> None:
    configured = load_settings().protocol.letters
    assert {name: getattr(configured, name) for name in asdict(LETTERS)} == asdict(LETTERS)


@pytest.mark.parametrize(
    "change",
    [{"wall": "("}, {"wall": " "}, {"wall": "ww"}, {"wall": "u"}, {"unknown": "C"}, {"first_blue": "x"}],
)
def test_letters_that_cannot_be_told_apart_are_refused(change: dict[str, str]) -> None:
    with pytest.raises(SettingsError):
        LetterTable(**{**asdict(LETTERS), **change})


def test_the_tables_cannot_be_changed() -> None:
    with pytest.raises(ValueError, match="read-only"):
        letters_by_kind(replace(LETTERS), "same")[0] = 0
