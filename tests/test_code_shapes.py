"""Ids told by the shape of a patch: described by a file, checked, drawn, and read through the whole pipeline."""

import math
import re
from pathlib import Path

import numpy as np
import pytest

from tests.drawn_field import Told, drawn, points_venue, told
from tests.objects.drawing import Picture
from tests.objects.finding import empty_picture, finder_of, middle, seen_in
from vision_core.errors import SettingsError
from vision_core.patterns.distinctness import report_on
from vision_core.patterns.drawing import marker_svg
from vision_core.patterns.loader import load_pattern
from vision_core.patterns.pattern import NO_SHAPE, Pattern, mirrored, scaled
from vision_core.patterns.sheets import write_sheets
from vision_core.types.objects import Team
from vision_core.types.tables import NO_ID

SHAPES = """
name = "shaped"
[robot]
outline = "square"
radius_m = 0.08
height_m = 0.14
[[patches]]
color = "team"
polygon_mm = [[12, -70], [72, -70], [72, 70], [12, 70], [12, -70]]
[[patches]]
color = "pink"
shapes_at_mm = [-36, 0]
[code]
colors = []
ids = { 1 = "D", 2 = "S", 3 = "T", 4 = "B" }
[[code.shapes]]
name = "disc"
circle_mm = [0, 0, 68]
[[code.shapes]]
name = "square"
polygon_mm = [[-30, -30], [30, -30], [30, 30], [-30, 30], [-30, -30]]
[[code.shapes]]
name = "triangle"
polygon_mm = [[-33, -40], [-33, 40], [36, 0], [-33, -40]]
[[code.shapes]]
name = "bar"
polygon_mm = [[-17, -62], [17, -62], [17, 62], [-17, 62], [-17, -62]]
"""
CLASSES = """[colors.classes]
orange = [{ hue_deg = [5.0, 30.0], saturation = [0.6, 1.0], value = [0.5, 1.0] }]
yellow = [{ hue_deg = [42.0, 68.0], saturation = [0.45, 1.0], value = [0.36, 1.0] }]
blue = [{ hue_deg = [195.0, 240.0], saturation = [0.5, 1.0], value = [0.3, 1.0] }]
pink = [{ hue_deg = [300.0, 340.0], saturation = [0.3, 1.0], value = [0.5, 1.0] }]
"""
POSES = ((-0.6, 0.4, 0.2), (0.5, 0.5, 1.1), (-0.2, -0.5, 2.0), (0.6, -0.4, -0.7), (0.9, 0.1, 3.0))
STAR = np.array([((0.04, 0.015)[k % 2] * math.cos(k * math.pi / 5), (0.04, 0.015)[k % 2] * math.sin(k * math.pi / 5))
                 for k in range(10)])  # fmt: skip


def pattern_in(folder: Path, text: str = SHAPES) -> Pattern:
    file = folder / "shaped.toml"
    file.write_text(text)
    return load_pattern(str(file))


def said(folder: Path, shown: Picture) -> Told:
    venue = f'{points_venue()}{CLASSES}[field]\nline_width_m = 0.0\n[robots]\npattern = "shaped.toml"\n'
    return told(folder, f"{venue}[match]\nnumbers = 4\n", shown.as_bytes())


def test_a_file_says_which_shape_is_which_letter(tmp_path: Path) -> None:
    pattern = pattern_in(tmp_path)
    assert pattern.shapes_worn(3) == (NO_SHAPE, 2)
    assert pattern.colors_worn(Team.YELLOW, 3) == ("yellow", "pink")
    bar = pattern.layout(4)[1]
    assert bar.polygon_mm is not None
    assert bar.polygon_mm[0] == (-53.0, -62.0)
    triangle = scaled(mirrored(pattern), 0.5).layout(3)[1]
    assert triangle.polygon_mm is not None
    assert triangle.polygon_mm[0] == (-34.5, 20.0)


@pytest.mark.slow
def test_its_report_names_the_shapes_that_are_most_alike(tmp_path: Path) -> None:
    report = report_on(pattern_in(tmp_path))
    assert (report.ids, report.fewest_differences) == (4, 1)
    assert report.rival is not None
    assert (report.rival.one, report.rival.other) == ("shaped blue 1", "shaped blue 2")
    assert report.smallest_mm == pytest.approx(34.0, abs=1.0)


def test_it_is_drawn_and_printed_in_its_shape(tmp_path: Path) -> None:
    pattern = pattern_in(tmp_path)
    assert marker_svg(pattern, Team.BLUE, 1).count("<circle") == 1
    assert marker_svg(pattern, Team.BLUE, 2).count("<polygon") == 3
    assert write_sheets([(pattern, Team.BLUE, number) for number in (1, 2, 3, 4)], tmp_path / "sheets.pdf") >= 1


REFUSED = {
    "two or more shapes": (SHAPES[SHAPES.index("[[code.shapes]]") :], ""),
    "different initials": ('name = "square"', 'name = "disk"'),
    "a letter of DSTB": ('4 = "B"', '4 = "X"'),
    "3 and 4 both wear T": ('4 = "B"', '4 = "T"'),
    "another patch for the shapes, or a pattern for each shape": ("polygon_mm = [[12", "shapes_at_mm = [30, 0] #"),
    "patch 2, shape disc; found: patch 2 reaches": ("[-36, 0]", "[-50, 0]"),
    "patches 1 and 2; found: they overlap": ("[-36, 0]", "[-22, 0]"),
    "blue 1 as it is looks like blue 2": ("[[-30, -30], [30, -30], [30, 30], [-30, 30], [-30, -30]]", "ROUND"),
    "no room in common": ("circle_mm = [0, 0, 68]", "circle_mm = [12, 56, 20]"),
    "lies_over": ("shapes_at_mm", "lies_over = true\nshapes_at_mm"),
    "shapes_at_mm, and the shapes": ("shapes_at_mm = [-36, 0]", "shapes_at_mm = [-36, 0]\nshapes = [{color = 'red'}]"),
}
ROUND = [[round(33.5 * math.cos(k * math.pi / 12), 3), round(33.5 * math.sin(k * math.pi / 12), 3)] for k in range(24)]


@pytest.mark.parametrize(("why", "change"), REFUSED.items(), ids=REFUSED.keys())
def test_what_cannot_be_read_is_refused(why: str, change: tuple[str, str], tmp_path: Path) -> None:
    old, new = change
    with pytest.raises(SettingsError, match=why):
        pattern_in(tmp_path, SHAPES.replace(old, new.replace("ROUND", str([*ROUND, ROUND[0]])), 1))


@pytest.mark.slow
def test_all_shapes_are_read(tmp_path: Path) -> None:
    pattern, shown = pattern_in(tmp_path), drawn(robots=(), lines=False)
    robots = (("blue", 1), ("blue", 2), ("blue", 3), ("yellow", 4), ("yellow", 2))
    for (team, number), pose in zip(robots, POSES, strict=True):
        shown.paint_pattern(pattern, team, pattern.code_by_id[number], pose)
    found = said(tmp_path, shown)
    assert (found.robots, found.detect, found.validate) == ("b1 b2 b3 y2 y4", (), "")


@pytest.mark.slow
def test_each_is_read_at_any_heading_with_its_place(tmp_path: Path) -> None:
    pattern = pattern_in(tmp_path)
    finder = finder_of(str(tmp_path / "shaped.toml"))
    for number in pattern.code_by_id:
        for turn in range(6):
            shown = empty_picture(pattern, across_px=26.0)
            pose = (*middle(shown, 0.14), 0.2 + 1.07 * turn)
            shown.paint_pattern(pattern, "yellow", pattern.code_by_id[number], pose)
            robot = seen_in(shown, finder, turn)[0]
            assert robot["id"] == number
            assert robot["confidence"] > 0.8
            assert math.hypot(robot["x_m"] - pose[0], robot["y_m"] - pose[1]) < 0.003
            assert abs(math.remainder(robot["heading_rad"] - pose[2], math.tau)) < math.radians(3.0)


@pytest.mark.slow
def test_a_shape_that_is_none_of_them_gives_no_id_but_a_reason(tmp_path: Path) -> None:
    pattern, shown = pattern_in(tmp_path), drawn(robots=(), lines=False)
    shown.paint_pattern(pattern, "blue", "D", POSES[0])
    shown.paint_pattern(pattern, "blue", "-", POSES[1])
    x, y, turn = POSES[1]
    c, s = math.cos(turn), math.sin(turn)
    shown.paint_polygon("pink", (STAR + np.array([-0.036, 0.0])) @ np.array([[c, s], [-s, c]]) + np.array([x, y]), 0.14)
    found = said(tmp_path, shown)
    assert found.robots == "b1 b?"
    assert re.search(
        r"the blue robot at \(\d+, \d+\) px has no id: the shape of its back patch is none of disc, square, triangle, ",
        found.detect[0],
    )


@pytest.mark.slow
def test_shapes_too_alike_for_the_camera_are_said(tmp_path: Path) -> None:
    """A disc and a square, both four pixels across."""
    small = "[[-10, -10], [10, -10], [10, 10], [-10, 10], [-10, -10]]"
    text = SHAPES.replace("[[-30, -30], [30, -30], [30, 30], [-30, 30], [-30, -30]]", small)
    text = text.replace("circle_mm = [0, 0, 68]", "circle_mm = [0, 0, 22]")
    pattern, shown = pattern_in(tmp_path, text), drawn(robots=(), lines=False)
    shown.paint_pattern(pattern, "blue", "S", POSES[0])
    found = said(tmp_path, shown)
    assert re.search(
        r"the shapes disc and square of shaped differ by a margin of \d+ at 5\.\d mm per pixel: such robots will often "
        r"have no id; accepted: 16 or more",
        found.validate,
    )
    assert found.robots == "b?"
    assert re.search(
        r"the shape of its back patch may be (disc or square|square or disc) \(by \d of 10", found.detect[0]
    )
    assert seen_in(shown, finder_of(str(tmp_path / "shaped.toml")))["id"].tolist() == [NO_ID]
