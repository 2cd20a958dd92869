"""Kinds of markers that were met on other fields: described by a file, drawn, and read through the whole pipeline."""

import math
import re
from collections.abc import Sequence
from pathlib import Path

import pytest

from tests.drawn_field import Robot, Told, drawn, points_venue, told
from vision_core.errors import SettingsError
from vision_core.patterns.distinctness import report_on
from vision_core.patterns.geometry import area_mm2, centroid_mm, width_mm
from vision_core.patterns.loader import load_pattern

pytestmark = pytest.mark.slow

HEAD = 'name = "met"\n[robot]\noutline = "{outline}"\nradius_m = {radius_m}\nheight_m = 0.075\n'
TAG, PLATE = HEAD.format(outline="square", radius_m=0.0375), HEAD.format(outline="circle", radius_m=0.08)
CLASSES = """[colors.classes]
orange = [{ hue_deg = [5.0, 30.0], saturation = [0.6, 1.0], value = [0.5, 1.0] }]
yellow = [{ hue_deg = [42.0, 68.0], saturation = [0.45, 1.0], value = [0.36, 1.0] }]
blue = [{ hue_deg = [195.0, 240.0], saturation = [0.5, 1.0], value = [0.3, 1.0] }]
red = [{ hue_deg = [345.0, 4.0], saturation = [0.6, 1.0], value = [0.3, 1.0] }]
green = [{ hue_deg = [95.0, 165.0], saturation = [0.5, 1.0], value = [0.6, 1.0] }]
pink = [{ hue_deg = [300.0, 340.0], saturation = [0.3, 1.0], value = [0.5, 1.0] }]
"""
HALVES = f"""{TAG}
[[patches]]
color = "team"
polygon_mm = [[-35, 35], [35, -35], [35, 35], [-35, 35]]
[[patches]]
color = "code"
polygon_mm = [[-35, 35], [-35, -35], [35, -35], [-35, 35]]
[code]
colors = ["red", "green", "pink"]
ids = {{ 1 = "R", 2 = "G", 3 = "P" }}
"""
OVERLAPPING = f"""{PLATE}
[[patches]]
color = "team"
circle_mm = [0, 0, 90]
[[patches]]
color = "code"
circle_mm = [38, 12, 40]
lies_over = true
[[patches]]
color = "code"
circle_mm = [-25, 40, 40]
lies_over = true
[code]
colors = ["red", "green"]
ids = {{ 1 = "RG", 2 = "GR", 3 = "RR", 4 = "GG" }}
"""
NO_CODE = f"""{TAG}
[[patches]]
color = "team"
circle_mm = [14, 0, 40]
[[patches]]
color = "pink"
circle_mm = [-22, 0, 24]
[code]
colors = []
ids = {{ 1 = "" }}
"""
POSES = ((-0.6, 0.4, 0.2), (0.5, 0.5, 1.1), (-0.2, -0.5, 2.0), (0.6, -0.4, -0.7), (0.9, 0.1, 3.0))


def read(folder: Path, pattern: str, robots: Sequence[tuple[str, int]]) -> tuple[Told, list[Robot]]:
    """What is said about robots that wear a pattern, and where they stand."""
    file = folder / "met.toml"
    file.write_text(pattern)
    worn = load_pattern(str(file))
    shown, placed = drawn(robots=(), lines=False), []
    for (team, number), pose in zip(robots, POSES, strict=False):
        shown.paint_pattern(worn, team, worn.code_by_id[number], pose)
        placed.append((team, number, *pose))
    numbers = len(worn.code_by_id)
    venue = f'{points_venue()}{CLASSES}[field]\nline_width_m = 0.0\n[robots]\npattern = "met.toml"\n'
    return told(folder, f"{venue}[match]\nnumbers = {min(numbers, 5)}\n", shown.as_bytes()), placed


def test_two_halves_along_a_diagonal(tmp_path: Path) -> None:
    found, _ = read(tmp_path, HALVES, [("blue", 1), ("blue", 2), ("blue", 3), ("yellow", 1), ("yellow", 3)])
    assert (found.robots, found.detect, found.validate) == ("b1 b2 b3 y1 y3", (), "")


def test_dots_that_overlap(tmp_path: Path) -> None:
    robots = [("blue", 1), ("blue", 2), ("blue", 3), ("yellow", 4), ("yellow", 1)]
    found, _ = read(tmp_path, OVERLAPPING, robots)
    assert (found.robots, found.detect, found.validate) == ("b1 b2 b3 y1 y4", (), "")


def test_what_is_hidden_is_no_part_of_a_patch(tmp_path: Path) -> None:
    file = tmp_path / "met.toml"
    file.write_text(OVERLAPPING)
    team, first, second = load_pattern(str(file)).patches
    whole = math.pi * 45.0**2
    assert area_mm2(first) == pytest.approx(math.pi * 20.0**2)
    assert 0.6 * whole < area_mm2(team) < whole - 600.0
    x, y = centroid_mm(team)
    assert x < -2.0
    assert y < -3.0
    assert width_mm(team) < 90.0
    assert report_on(load_pattern(str(file))).ids == 4
    assert second.hidden_by == ()


def test_dots_that_overlap_unsaid_are_refused(tmp_path: Path) -> None:
    file = tmp_path / "met.toml"
    file.write_text(OVERLAPPING.replace("lies_over = true\n", "", 1))
    with pytest.raises(
        SettingsError, match="they overlap, .* accepted: patches beside each other, or lies_over = true"
    ):
        load_pattern(str(file))
    file.write_text(OVERLAPPING.replace('colors = ["red", "green"]', 'colors = ["red", "pink"]').replace("G", "P"))
    load_pattern(str(file))
    file.write_text(
        OVERLAPPING + "[[patches]]\ncolor = 'red'\ncircle_mm = [30, -20, 20]\nhidden_by = [{color = 'red'}]\n"
    )
    with pytest.raises(SettingsError, match="lies_over = true"):
        load_pattern(str(file))


def test_one_robot_per_team_needs_no_code(tmp_path: Path) -> None:
    found, _ = read(tmp_path, NO_CODE, [("blue", 1), ("yellow", 1)])
    assert (found.robots, found.detect, found.validate) == ("b1 y1", (), "")
    several, _ = read(tmp_path, NO_CODE, [("blue", 1), ("blue", 1), ("yellow", 1)])
    assert several.robots == "b? b? y1"
    assert re.search(
        "2 blue robots wear pattern .*, which has no code, so none of them has an id: at", several.detect[0]
    )
