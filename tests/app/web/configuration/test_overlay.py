"""From entries to settings: values, the teams on the field, admissions, refusals."""

from typing import Any

from app.web.configuration.overlay import overlay_from
from vision_core.settings.schema import Settings
from vision_core.venues.loader import load_settings

NOW_S = 1_800_000_000.0
BASE = load_settings()
COLOGNE = {"name": "1. FC Köln", "short_name": "CGN", "contact": "", "robots": [7, 3, 1, 9, 4]}


def overlay(entries: dict[str, Any], base: Settings = BASE) -> dict[str, Any]:
    return overlay_from(entries, base, NOW_S)


def admission(network: str, until: float | None = None, **robot: Any) -> dict[str, Any]:
    return {"network": network, "team": None, "number": None, "until": until, "by": "Ada", **robot}


def test_nothing_changed_is_nothing() -> None:
    assert overlay({}) == {}


def test_a_setting_replaces_that_of_the_files() -> None:
    assert overlay({"settings/match.blue_defends": "right"}) == {"match.blue_defends": "right"}


def test_a_team_on_the_field_brings_its_name_and_its_markers() -> None:
    found = overlay({"teams/cgn": COLOGNE, "plays/yellow": "cgn"})
    assert found == {"match.yellow_name": "1. FC Köln", "match.yellow_ids": [7, 3, 1, 9, 4]}


def test_a_team_beside_the_field_changes_nothing() -> None:
    assert overlay({"teams/cgn": COLOGNE}) == {}


def test_a_team_without_markers_plays_with_those_of_the_color() -> None:
    assert overlay({"teams/cgn": {**COLOGNE, "robots": []}, "plays/blue": "cgn"}) == {"match.blue_name": "1. FC Köln"}


def test_a_team_that_was_deleted_plays_no_more() -> None:
    assert overlay({"plays/blue": "cgn"}) == {}


def test_admissions_follow_those_of_the_files() -> None:
    found = overlay({"admissions/1": admission("10.0.0.7", team="blue", number=3)})
    assert found == {"admission.rules": [{"network": "10.0.0.7", "team": "blue", "number": 3}]}


def test_an_admission_whose_time_is_over_admits_nobody() -> None:
    entries = {"admissions/1": admission("10.0.0.7", NOW_S - 1.0), "admissions/2": admission("10.0.0.8", NOW_S + 1.0)}
    assert [rule["network"] for rule in overlay(entries)["admission.rules"]] == ["10.0.0.8"]


def test_refused_addresses() -> None:
    assert overlay({"refusals/10.0.0.9": {"by": "Ada"}}) == {"admission.refused": ["10.0.0.9"]}
