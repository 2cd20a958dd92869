"""Shipped patterns are in order; one that a camera could not read in one way only is refused, by name."""

import os
from pathlib import Path

import pytest

from vision_core.errors import SettingsError
from vision_core.patterns.loader import load_pattern
from vision_core.patterns.pattern import looks
from vision_core.types.objects import Team
from vision_core.venues.loader import config_folder

SHIPPED = sorted(path.stem for path in (config_folder() / "patterns").glob("*.toml"))

SQUARE = """
name = "own"
[robot]
outline = "square"
radius_m = 0.0375
height_m = 0.075
"""
TEAM_BOX = '[[patches]]\ncolor = "team"\npolygon_mm = [[0, 0], [30, 0], [30, 30], [0, 30], [0, 0]]\n'
CODE_BOX = '[[patches]]\ncolor = "code"\npolygon_mm = [[-30, -30], [0, -30], [0, 0], [-30, 0], [-30, -30]]\n'
APART = '[[patches]]\ncolor = "code"\npolygon_mm = [[-33, -33], [-3, -33], [-3, -3], [-33, -3], [-33, -33]]\n'
CODE = '[code]\ncolors = ["green", "pink"]\nids = { 1 = "G", 2 = "P" }\n'
GOOD = SQUARE + TEAM_BOX + CODE_BOX + CODE


def load(folder: Path, text: str) -> None:
    file = folder / "own.toml"
    file.write_text(text)
    load_pattern(str(file))


@pytest.mark.parametrize("name", SHIPPED)
def test_shipped_patterns_load(name: str) -> None:
    pattern = load_pattern(name)
    assert pattern.name == name
    worn = [colors for _, _, colors in looks(pattern)]
    assert len(set(worn)) == len(worn) == 2 * len(pattern.code.ids)


def test_colors_worn_follow_the_patches() -> None:
    pattern = load_pattern("ssl-standard")
    assert pattern.colors_worn(Team.YELLOW, 0) == ("yellow", "pink", "green", "pink", "pink")
    with pytest.raises(KeyError):
        pattern.colors_worn(Team.BLUE, 16)


def test_a_team_may_wear_another_color() -> None:
    pattern = load_pattern("mirosot-tile-pink")
    assert [pattern.colors_worn(team, 1) for team in Team] == [("blue", "pale"), ("pink", "pale")]


def test_own_pattern(tmp_path: Path) -> None:
    load(tmp_path, GOOD)


REFUSED = {
    "patch 1; found: 4 corners, first and last [0, 0], [0, 30]: not closed": (", [0, 0]]\n[[", "]\n[["),
    "patch 1; found: sides that cross": ("[30, 0], [30, 30]", "[30, 30], [30, 0]"),
    "patch 1 reaches 48 mm from the center, the robot's half side is 37.5 mm": ("[30, 30]", "[30, 48]"),
    "patches 1 and 2; found: they overlap, 2.8 mm wide": ("[-30, -30], [0, -30]", "[-30, -30], [0, -30], [6, 6]"),
    "patch 1; found: both or none": ("polygon_mm = [[0, 0]", "circle_mm = [1, 1, 9]\npolygon_mm = [[0, 0]"),
    "patch 2; found: [nan": ("[[-30, -30], [0", "[[nan, -30], [0"),
    "patch 2; found: 1 mm wide": (CODE_BOX, '[[patches]]\ncolor = "code"\ncircle_mm = [-10, 0, 1]\n'),
    "blue 1 turned by 180 deg looks like yellow 2": (
        CODE_BOX + CODE,
        APART + '[code]\ncolors = ["blue", "yellow"]\nids = { 1 = "Y", 2 = "B" }\n',
    ),
    "touch and are both blue": (CODE, '[code]\ncolors = ["blue", "pink"]\nids = { 1 = "B", 2 = "P" }\n'),
    "1 and 2 both wear G": ('2 = "P"', '2 = "G"'),
    '2 = "GP"; accepted: a number of 0 to 255 and a letter of GP': ('2 = "P"', '2 = "GP"'),
    "256 = ": ("2 = ", "256 = "),
    "01 = ": ("2 = ", "01 = "),
    "different initials": ('"pink"', '"grey"'),
    "0 of color team": ('"team"', '"green"'),
    "unknown field": ('name = "own"', 'name = "own"\ncolour = 1'),
    "matching regex": ('"pink"', '""'),
}


@pytest.mark.parametrize("complaint", REFUSED)
def test_refused(tmp_path: Path, complaint: str) -> None:
    old, new = REFUSED[complaint]
    assert old in GOOD
    with pytest.raises(SettingsError) as refusal:
        load(tmp_path, GOOD.replace(old, new, 1))
    assert complaint in str(refusal.value)
    assert "own.toml" in str(refusal.value)


def test_an_id_that_looks_like_itself_has_no_heading(tmp_path: Path) -> None:
    text = SQUARE + '[[patches]]\ncolor = "team"\ncircle_mm = [0, 0, 40]\n[code]\ncolors = []\nids = { 1 = "" }\n'
    with pytest.raises(SettingsError, match="blue 1 turned by 180 deg looks like blue 1"):
        load(tmp_path, text)


def test_two_ids_that_a_turn_exchanges(tmp_path: Path) -> None:
    dots = "".join(f'[[patches]]\ncolor = "code"\ncircle_mm = [0, {y}, 20]\n' for y in (25, -25))
    team = '[[patches]]\ncolor = "team"\ncircle_mm = [0, 0, 20]\n'
    code = '[code]\ncolors = ["green", "pink"]\nids = { 1 = "GP", 2 = "PG" }\n'
    with pytest.raises(SettingsError, match="blue 1 turned by 180 deg looks like blue 2"):
        load(tmp_path, SQUARE + team + dots + code)


def test_dots_of_a_round_robot_stay_within_its_radius(tmp_path: Path) -> None:
    text = GOOD.replace('"square"', '"circle"')
    with pytest.raises(SettingsError, match=r"patch 1 reaches 42\.43 mm from the center, the robot's radius is 37\.5"):
        load(tmp_path, text)


def test_a_file_is_parsed_once_and_again_when_it_has_changed(tmp_path: Path) -> None:
    path = tmp_path / "mine.toml"
    text = (config_folder() / "patterns" / "ssl-standard.toml").read_text()
    path.write_text(text)
    os.utime(path, ns=(0, 10**9))
    assert load_pattern(str(path)) is load_pattern(str(path))
    path.write_text(text.replace('name = "', 'name = "my-'))
    os.utime(path, ns=(0, 2 * 10**9))
    assert load_pattern(str(path)).name.startswith("my-")
