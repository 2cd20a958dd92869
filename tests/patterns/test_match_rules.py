"""Robots that may connect and cannot all be recognized: said, with the file."""

from typing import Any

from vision_core.patterns.match_rules import match_warnings
from vision_core.venues.loader import load_settings


def warnings(options: dict[str, Any]) -> list[str]:
    return list(match_warnings(load_settings(options=options), lambda key: f"file of {key}"))


def test_as_many_numbers_as_ids_are_in_order() -> None:
    assert warnings({"match.numbers": 16}) == []


def test_more_numbers_than_ids_are_said_for_each_team() -> None:
    blue, yellow = warnings({"robots.pattern": "t-plate"})
    assert blue == "file of match.numbers: match.numbers is 5, but pattern 't-plate' of team blue has id 1 alone"
    assert "team yellow" in yellow


def test_ids_that_the_pattern_lacks_are_said_where_they_are_used() -> None:
    ids = [1, 2, 77, 4, 5, 99]
    (warning,) = warnings({"match.blue_ids": ids})
    known = ", ".join(map(str, range(16)))
    assert warning == (
        "file of match.blue_ids: match.blue_ids gives numbers 1 to 5 id 77, "
        f"but pattern 'ssl-standard' of team blue has ids {known}"
    )
