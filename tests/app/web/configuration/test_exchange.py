"""An exported file says what differs; a foreign or older one is named and refused."""

from typing import Any

import pytest

from app.web.configuration.exchange import Export, changes_to, export_of
from app.web.problems import RequestRefused

ENTRIES = {"settings/match.blue_defends": "right", "teams/cgn": {"name": "Köln"}}


def test_what_was_exported_comes_back() -> None:
    exported = Export.model_validate_json(export_of(ENTRIES, "0.1.0", "hall-7").model_dump_json())
    assert changes_to(exported, {}) == ENTRIES
    assert changes_to(exported, ENTRIES) == {}


def test_what_the_file_does_not_have_goes() -> None:
    exported = export_of({}, "0.1.0", "hall-7")
    assert changes_to(exported, ENTRIES) == dict.fromkeys(ENTRIES)


@pytest.mark.parametrize(
    ("changed", "found"),
    [
        ({"format": "photonvision"}, "photonvision"),
        ({"version": 0}, "version 0"),
        ({"version": 9}, "version 9"),
        ({"entries": {"passwords/operator": "x"}}, "passwords/operator"),
        ({"entries": {"settings/match.mode": None}}, "without a value"),
    ],
)
def test_another_file_is_refused_by_name(changed: dict[str, Any], found: str) -> None:
    exported = export_of(ENTRIES, "0.1.0", "hall-7").model_copy(update=changed)
    with pytest.raises(RequestRefused, match=found):
        changes_to(exported, {})
