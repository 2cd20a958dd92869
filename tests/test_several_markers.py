"""Robots of one team that wear different markers: read by the one that explains the pixels."""

import re
from collections.abc import Sequence
from pathlib import Path

import pytest

from tests.drawn_field import Told, drawn, points_venue, told
from vision_core.errors import SettingsError
from vision_core.patterns.loader import load_pattern
from vision_core.patterns.worn import worn_patterns
from vision_core.types.objects import Team
from vision_core.venues.loader import load_settings

pytestmark = pytest.mark.slow

BODY = '[robot]\noutline = "square"\nradius_m = 0.08\nheight_m = 0.14\n'
BAR = '[[patches]]\ncolor = "team"\npolygon_mm = [[12, -70], [72, -70], [72, 70], [12, 70], [12, -70]]\n'
LEFT = '[[patches]]\ncolor = "code"\npolygon_mm = [[-70, 12], [-12, 12], [-12, 70], [-70, 70], [-70, 12]]\n'
RIGHT = '[[patches]]\ncolor = "code"\npolygon_mm = [[-70, -70], [-12, -70], [-12, -12], [-70, -12], [-70, -70]]\n'
DISC = '[[patches]]\ncolor = "team"\ncircle_mm = [30, 0, 70]\n[[patches]]\ncolor = "pink"\ncircle_mm = [-35, 0, 50]\n'
CODE = '[code]\ncolors = ["green", "pink"]\n'
FILES = {
    "two": f'name = "two"\n{BODY}{BAR}{LEFT}{RIGHT}{CODE}ids = {{ 1 = "GP", 2 = "PG", 3 = "GG", 4 = "PP" }}\n',
    "one": f'name = "one"\n{BODY}{BAR}{LEFT}{CODE}ids = {{ 4 = "G", 5 = "P" }}\n',
    "disc": f'name = "disc"\n{BODY}{DISC}[code]\ncolors = []\nids = {{ 7 = "" }}\n',
}
CLASSES = """[colors.classes]
orange = [{ hue_deg = [5.0, 30.0], saturation = [0.6, 1.0], value = [0.5, 1.0] }]
yellow = [{ hue_deg = [42.0, 68.0], saturation = [0.45, 1.0], value = [0.36, 1.0] }]
blue = [{ hue_deg = [195.0, 240.0], saturation = [0.5, 1.0], value = [0.3, 1.0] }]
green = [{ hue_deg = [95.0, 165.0], saturation = [0.5, 1.0], value = [0.6, 1.0] }]
pink = [{ hue_deg = [300.0, 340.0], saturation = [0.3, 1.0], value = [0.5, 1.0] }]
"""
TEAMS = """[robots]
pattern = "two.toml"
[robots.yellow]
pattern = ["two.toml", "one.toml", "disc.toml"]
pattern_ids = [[1, 2], [4, 5], []]
[match]
numbers = 4
yellow_ids = [1, 4, 5, 7]
"""
POSES = ((-0.6, 0.4, 0.2), (0.5, 0.5, 1.1), (-0.2, -0.5, 2.0), (0.6, -0.4, -0.7), (0.9, 0.1, 3.0), (-1.0, -0.3, -2.0))


def written(folder: Path, **changed: str) -> None:
    for name, text in (FILES | changed).items():
        (folder / f"{name}.toml").write_text(text)


def read(folder: Path, robots: Sequence[tuple[str, str, int]], teams: str = TEAMS) -> Told:
    """What is said about robots of a team, a pattern and an id."""
    shown = drawn(robots=(), lines=False)
    for (team, name, number), pose in zip(robots, POSES, strict=False):
        pattern = load_pattern(str(folder / f"{name}.toml"))
        shown.paint_pattern(pattern, team, pattern.code_by_id[number], pose)
    return told(folder, f"{points_venue()}{CLASSES}[field]\nline_width_m = 0.0\n{teams}", shown.as_bytes())


def test_each_robot_is_read_by_its_own_marker(tmp_path: Path) -> None:
    written(tmp_path)
    robots = (
        ("blue", "two", 3), ("blue", "two", 1), ("yellow", "two", 1), ("yellow", "one", 4), ("yellow", "one", 5),
        ("yellow", "disc", 7),
    )  # fmt: skip
    found = read(tmp_path, robots)
    assert (found.robots, found.detect, found.validate) == ("b1 b3 y1 y4 y5 y7", (), "")


def test_markers_that_explain_the_pixels_as_well_give_no_id(tmp_path: Path) -> None:
    """A robot with the disc of one pattern, and the square of the same size of another one: four pixels differ."""
    square = "polygon_mm = [[8, -22], [52, -22], [52, 22], [8, 22], [8, -22]]"
    disc = FILES["disc"].replace("30, 0, 70", "30, 0, 50")
    other = disc.replace("circle_mm = [30, 0, 50]", square).replace('"disc"', '"other"').replace("7 =", "8 =")
    written(tmp_path, disc=disc, other=other)
    teams = TEAMS.replace('["two.toml", "one.toml", "disc.toml"]', '["two.toml", "disc.toml", "other.toml"]')
    teams = teams.replace("[[1, 2], [4, 5], []]", "[]").replace("[1, 4, 5, 7]", "[1, 4, 7, 8]")
    found = read(tmp_path, [("blue", "two", 3), ("yellow", "two", 1), ("yellow", "disc", 7)], teams)
    assert found.robots == "b3 y1 y?"
    assert re.search(
        r"the yellow robot at \(\d+, \d+\) px has no id: pattern .*two.toml or .*disc.toml or .*other.toml\? They ",
        found.detect[0],
    )


WRONG = {
    "two and one both have id 4": ("pattern_ids = [[1, 2], [4, 5], []]", ""),
    "2 lists for 3 patterns": ("[[1, 2], [4, 5], []]", "[[1, 2], [4, 5]]"),
    "9; accepted: ids of the pattern: 4, 5": ("[4, 5]", "[4, 9]"),
    "nothing.toml": ('"one.toml"', '"nothing.toml"'),
}


@pytest.mark.parametrize(("why", "change"), WRONG.items(), ids=WRONG.keys())
def test_what_a_team_cannot_wear_is_refused(why: str, change: tuple[str, str], tmp_path: Path) -> None:
    written(tmp_path)
    (tmp_path / "venue.toml").write_text(TEAMS.replace(*change))
    with pytest.raises(SettingsError, match=why):
        worn_patterns(load_settings(str(tmp_path / "venue.toml")).robots, Team.YELLOW)


def test_a_list_stands_in_a_venue_beside_its_files(tmp_path: Path) -> None:
    written(tmp_path)
    (tmp_path / "venue.toml").write_text(TEAMS)
    robots = load_settings(str(tmp_path / "venue.toml")).robots
    assert [pattern.name for pattern in worn_patterns(robots, Team.BLUE)] == ["two"]
    assert [list(pattern.code_by_id) for pattern in worn_patterns(robots, Team.YELLOW)] == [[1, 2], [4, 5], [7]]
    assert robots.yellow is not None
    assert robots.yellow.radius_m == pytest.approx(0.08)
