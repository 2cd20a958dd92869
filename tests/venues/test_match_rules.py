"""The views that a match fixes must be ones that a client could ask for."""

import pytest
from msgspec.structs import replace

from vision_core.errors import SettingsError
from vision_core.protocol.messages import PLAY_MODES
from vision_core.protocol.options import MAX_DIRECTIONS, TICKS_PER_DEG
from vision_core.settings.schema import MatchViews, PlayMode
from vision_core.venues import rules
from vision_core.venues.loader import load_settings

SETTINGS = load_settings()


def checked(**changed: float) -> None:
    views = replace(SETTINGS.match.views, **changed)
    rules.check_settings(replace(SETTINGS, match=replace(SETTINGS.match, views=views)), lambda _: "here")


@pytest.mark.parametrize(
    "changed", [{}, {"fov_deg": 112.0, "resolution_deg": 0.25}, {"fov_deg": 90.0, "center_deg": 0.0}]
)
def test_what_a_client_may_ask_for_is_accepted(changed: dict[str, float]) -> None:
    checked(**changed)


@pytest.mark.parametrize(
    ("changed", "found"),
    [
        ({"resolution_deg": 0.25}, "1440 directions"),
        ({"fov_deg": 10.0, "resolution_deg": 20.0}, "0 directions"),
        ({"resolution_deg": 0.3}, "every 0.3 deg"),
        ({"center_deg": 0.1}, "from -179.9 deg"),
    ],
)
def test_what_no_client_may_ask_for_is_refused(changed: dict[str, float], found: str) -> None:
    with pytest.raises(SettingsError, match=found):
        checked(**changed)


def test_the_limits_are_those_of_the_protocol() -> None:
    assert (rules.MAX_DIRECTIONS, rules.RAYS_PER_DEG) == (MAX_DIRECTIONS, TICKS_PER_DEG)
    assert MatchViews.__struct_fields__ == ("types", "fov_deg", "center_deg", "resolution_deg", "rate_hz")


def test_play_modes_are_those_of_the_protocol() -> None:
    assert set(PlayMode.__args__) == PLAY_MODES  # type: ignore[attr-defined]
