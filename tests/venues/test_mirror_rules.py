"""Mirrors of teams and robots: which goes first, what is refused, and that a match has one for all."""

from pathlib import Path
from typing import Any

import pytest

from vision_core.errors import SettingsError
from vision_core.models.from_settings import mirror_of, mirrors_of
from vision_core.models.mirror import PAPER_MIRROR, Mirror
from vision_core.types.objects import Team
from vision_core.venues.loader import load_settings

OTHER = {"a": 4.2, "b": 0.0131, "c": 91000.0}
THIRD = {"a": 4.4, "b": 0.0138, "c": 90000.0}
SINGULAR = {"a": 4.2, "b": 0.5, "c": 91000.0}


def loaded(**mirrors: Any) -> Any:
    return load_settings(options={f"mirror.{key}": value for key, value in mirrors.items()}).mirror


def test_a_robots_mirror_goes_before_its_teams_and_that_before_the_fields() -> None:
    mirrors = loaded(blue=OTHER, robots={"blue 3": THIRD})
    assert mirror_of(mirrors, Team.BLUE, 3) == Mirror(**THIRD)
    assert mirror_of(mirrors, Team.BLUE, 4) == mirror_of(mirrors, Team.BLUE) == Mirror(**OTHER)
    assert mirror_of(mirrors, Team.YELLOW, 3) == PAPER_MIRROR
    assert [robot for robot, mirror in mirrors_of(mirrors).items() if mirror == Mirror(**THIRD)] == [(Team.BLUE, 3)]


def test_a_file_gives_one_robot_a_mirror(tmp_path: Path) -> None:
    venue = tmp_path / "venue.toml"
    venue.write_text('[mirror.robots."yellow 12"]\na = 4.2\nb = 0.0131\nc = 91000.0\n')
    assert mirror_of(load_settings(str(venue)).mirror, Team.YELLOW, 12) == Mirror(**OTHER)
    venue.write_text('[mirror.robots."yellow 12"]\na = 4.2\nb = 0.5\nc = 91000.0\n')
    with pytest.raises(SettingsError, match=r"venue.toml, line \d: mirror.robots.yellow 12; found: .*A > B sqrt"):
        load_settings(str(venue))


@pytest.mark.parametrize(
    ("robots", "found"),
    [
        ({"blue 17": OTHER}, r'"blue 1" to "yellow 16"'),
        ({"blue": OTHER}, r'"blue 1" to "yellow 16"'),
        ({"green 1": OTHER}, r'"blue 1" to "yellow 16"'),
        ({"blue 3": SINGULAR}, r"mirror.robots.blue 3; found: .*A > B sqrt"),
        ({"blue 3": {"a": 1.0, "b": 0.04, "c": 100.0}}, r"mirror.robots.blue 3; found: only .* px between"),
        ({"blue 3": {"a": 4.2}}, r"blue 3.b; found: nothing"),
    ],
)
def test_a_robots_mirror_that_cannot_be_is_refused(robots: dict[str, Any], found: str) -> None:
    with pytest.raises(SettingsError, match=found):
        loaded(robots=robots)


PAPERS = {"a": PAPER_MIRROR.a, "b": PAPER_MIRROR.b, "c": PAPER_MIRROR.c}


@pytest.mark.parametrize(
    ("mirrors", "key"),
    [
        ({"blue": OTHER}, "mirror.blue"),
        ({"blue": OTHER, "yellow": THIRD}, "mirror.yellow"),
        ({"robots": {"yellow 2": OTHER}}, "mirror.robots.yellow 2"),
        ({"blue": OTHER, "yellow": OTHER, "robots": {"blue 1": PAPERS}}, "mirror.robots.blue 1"),
    ],
)
def test_a_match_has_one_mirror_for_all(mirrors: dict[str, Any], key: str) -> None:
    options = {f"mirror.{name}": value for name, value in mirrors.items()}
    load_settings(options=options)
    with pytest.raises(SettingsError, match=f"{key}; found: .*in match mode.*the same mirror for all robots"):
        load_settings(options={**options, "match.mode": "match"})


@pytest.mark.parametrize(
    "mirrors", [{}, THIRD, {"blue": PAPERS}, {"blue": OTHER, "yellow": OTHER, "robots": {"blue 3": OTHER}}]
)
def test_a_match_may_have_any_mirror_that_is_the_same_for_all(mirrors: dict[str, Any]) -> None:
    options = {f"mirror.{name}": value for name, value in mirrors.items()}
    settings = load_settings(options={**options, "match.mode": "match"})
    assert len(set(mirrors_of(settings.mirror).values())) == 1
