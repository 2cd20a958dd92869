"""Pairs from text: every form of CSV that spreadsheets make, and errors that name the line."""

from pathlib import Path

import numpy as np
import pytest

from vision_core.calibration.mirror.pairs import Pairs, pairs_from_text, pairs_of, read_pairs
from vision_core.calibration.mirror.rounding import Rounding
from vision_core.errors import SettingsError


def rows(pairs: Pairs) -> list[tuple[float, float]]:
    return list(zip(pairs.radii_px.tolist(), pairs.distances_mm.tolist(), strict=True))


@pytest.mark.parametrize(
    "text",
    [
        "25.5,110\n61,380\n",
        "25.5\t110\r\n61\t380\r\n",
        "25,5;110\n61;380",
        "25,5\t110\n61\t380",
        "25.5   110\n  61 380  \n",
        "\ufeffR_px,r_mm\n25.5,110\n61,380\n",
        '"R [px]";"r [mm]"\n"25,5";"110"\n"61";"380"\n',
        "# measured on Monday, with a tape\n\nR px, r mm\n25.5, 110\n\n61, 380\n",
        "distance (cm);note;radius (px)\n11;wall; 25,5\n38;;61\n",
        "r_m,R_px\n0.11,25.5\n0.38,6.1e1\n",
        "25.5;110;\n61;380;\n",
    ],
)
def test_the_same_pairs_in_every_form(text: str) -> None:
    pairs = pairs_from_text(text)
    np.testing.assert_allclose(rows(pairs), [(25.5, 110.0), (61.0, 380.0)])


def test_names_are_the_lines_of_the_text() -> None:
    assert pairs_from_text("# a tape\nR px;r mm\n\n25;110\n61;380").names == ("line 4", "line 5")


@pytest.mark.parametrize(
    ("text", "asked", "found", "accepted"),
    [
        ("", "the pairs", "no pair", "one pair a line"),
        ("R_px,r_mm\n", "the pairs", "no pair", "one pair a line"),
        ("25,110\n61,x\n", "line 2", "'x'", "a number such as 61"),
        ("25,110\n61\n", "line 2", "1 cells: 61", "two columns"),
        ("25,5,110\n", "line 1", "3 cells: 25; 5; 110", "separate the cells by semicolons"),
        ("25;110\n61;1.234,5\n", "line 2", "'1.234,5'", "a number"),
        ("radius,distance\n25,110\n", "line 1", "radius; distance", "names the units"),
        ("R_px,r_px\n25,110\n", "line 1", "R_px; r_px", "names the units"),
        ("R_px,r_mm\n25\n", "line 2", "1 cells: 25", "both columns"),
        ("25,110\n0,380\n", "line 2", "R 0 px", "more than 0"),
        ("25,110\n61,-380\n", "line 2", "r -380 mm", "more than 0"),
        ("25,110\n61,1e9\n", "line 2", "r 1e+09 mm", "at most 100000 mm"),
        ("25,110\n61,1e999\n", "line 2", "r inf mm", "at most 100000 mm"),
        ("25,110\nnan,380\n", "line 2", "'nan'", "a number"),
        ('25,110\n"61,380\n', "line 2", '"61,380', "a quote at both ends"),
    ],
)
def test_errors_name_the_line(text: str, asked: str, found: str, accepted: str) -> None:
    with pytest.raises(SettingsError) as error:
        pairs_from_text(text)
    assert asked in error.value.asked
    assert found in error.value.found
    assert accepted in error.value.accepted


def test_a_file_is_named(tmp_path: Path) -> None:
    path = tmp_path / "pairs.csv"
    path.write_bytes(b"\xef\xbb\xbfR_px;r_mm\r\n25,5;110\r\n")
    assert rows(read_pairs(path)) == [(25.5, 110.0)]
    path.write_bytes(b"25;110\n\xff;1\n")
    with pytest.raises(SettingsError, match=r"pairs\.csv.*byte 0xff in line 2"):
        read_pairs(path)
    with pytest.raises(SettingsError, match="No such file"):
        read_pairs(tmp_path / "none.csv")


def test_whole_radii_get_half_a_pixel() -> None:
    whole, other = [(25.0, 110.0), (61.0, 380.0)], [(25.0, 110.0), (61.3, 380.0)]
    assert pairs_of(whole).measured_px.tolist() == [25.5, 61.5]
    assert pairs_of(other).measured_px.tolist() == [25.0, 61.3]
    assert pairs_of(whole, rounding=Rounding.EXACT).measured_px.tolist() == [25.0, 61.0]
    assert pairs_of(other, rounding=Rounding.CUT).measured_px.tolist() == [25.5, 61.8]
    assert pairs_of(whole).joined(pairs_of(other)).measured_px.tolist() == [25.5, 61.5, 25.0, 61.3]
    both = pairs_of(whole).joined(pairs_of(whole))
    assert (both.are_cut, both.radii_px.tolist()) == (True, [25.0, 61.0, 25.0, 61.0])
