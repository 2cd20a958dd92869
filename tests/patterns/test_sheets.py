"""Sheets are true to scale: read back from the PDF's own operators."""

import re
import zlib
from pathlib import Path

import msgspec
import pytest

from vision_core.errors import SettingsError, SourceError
from vision_core.evaluation.pattern_colors import report_on_colors
from vision_core.patterns.loader import load_pattern
from vision_core.patterns.pattern import Pattern
from vision_core.patterns.sheets import RULER_MM, write_sheets
from vision_core.types.objects import Team
from vision_core.venues.loader import load_settings

POINTS_PER_MM = 72.0 / 25.4
NUMBER = r"(-?[\d.]+)"


def pages_of(pdf: bytes) -> list[str]:
    """The drawing operators of every page."""
    streams = re.findall(rb"stream\n(.*?)\nendstream", pdf, re.DOTALL)
    texts = []
    for stream in streams:
        try:
            texts.append(zlib.decompress(stream).decode("latin-1"))
        except zlib.error:
            continue
    return [text for text in texts if " re" in text or " l" in text]


def test_ruler_and_patches_are_true_to_scale(tmp_path: Path) -> None:
    pattern = load_pattern("vsss-three-patch")
    assert write_sheets([(pattern, Team.BLUE, 1)], tmp_path / "m.pdf") == 1
    (page,) = pages_of((tmp_path / "m.pdf").read_bytes())
    lines = [tuple(map(float, found)) for found in re.findall(rf"{NUMBER} {NUMBER} m {NUMBER} {NUMBER} l S", page)]
    assert max(x2 - x1 for x1, _, x2, _ in lines) == pytest.approx(RULER_MM * POINTS_PER_MM, abs=0.02)
    boxes = [tuple(map(float, found)) for found in re.findall(rf"{NUMBER} {NUMBER} {NUMBER} {NUMBER} re B", page)]
    assert [(abs(w), abs(h)) for _, _, w, h in boxes] == [pytest.approx((75 * POINTS_PER_MM,) * 2, abs=0.02)]


def test_front_is_up_and_left_is_left(tmp_path: Path) -> None:
    """The team's rectangle lies in front: above the middle; the first code square, back left, has the smallest x."""
    write_sheets([(load_pattern("vsss-three-patch"), Team.BLUE, 1)], tmp_path / "m.pdf")
    (page,) = pages_of((tmp_path / "m.pdf").read_bytes())
    parts = [re.findall(rf"{NUMBER} {NUMBER} [ml]\n", part) for part in page.split(" rg\n")]
    polygons = [[(float(x), float(y)) for x, y in part[:5]] for part in parts if part[4:]]
    team, first, second = polygons[-3:]
    assert min(y for _, y in team) > max(y for _, y in first) == max(y for _, y in second)
    assert max(x for x, _ in first) < min(x for x, _ in second)


def test_many_markers_fill_pages(tmp_path: Path) -> None:
    pattern = load_pattern("vsss-three-patch")
    markers = [(pattern, team, number) for team in Team for number in pattern.code_by_id]
    assert write_sheets(markers, tmp_path / "m.pdf") == 6
    assert (tmp_path / "m.pdf").read_bytes().startswith(b"%PDF")


def changed(pattern: Pattern, color: str) -> Pattern:
    code = msgspec.structs.replace(pattern.code, colors=(color, *pattern.code.colors[1:]))
    return msgspec.structs.replace(pattern, code=code)


def test_refusals(tmp_path: Path) -> None:
    pattern = load_pattern("vsss-diagonal")
    with pytest.raises(SettingsError, match="rose; accepted: blue"):
        write_sheets([(changed(pattern, "rose"), Team.BLUE, 1)], tmp_path / "m.pdf")
    with pytest.raises(SourceError, match="accepted: a file to write"):
        write_sheets([(pattern, Team.BLUE, 1)], tmp_path / "none" / "m.pdf")


def test_a_large_robot_gets_paper_round_its_patches(tmp_path: Path) -> None:
    write_sheets([(load_pattern("t-plate"), Team.BLUE, 1)], tmp_path / "m.pdf")
    (page,) = pages_of((tmp_path / "m.pdf").read_bytes())
    boxes = re.findall(rf"{NUMBER} {NUMBER} {NUMBER} {NUMBER} re B", page)
    assert [float(box[2]) for box in boxes] == [pytest.approx(176 * POINTS_PER_MM, abs=0.02)]


def test_missing_and_disputed_colors() -> None:
    settings = load_settings(venue="demo-vsss")
    assert report_on_colors(("red", "cyan", "pink"), settings).missing == ("pink",)
    assert report_on_colors(("red", "cyan", "magenta"), settings).disputed == ()
    classes = dict(settings.colors.classes)
    classes["rose"] = classes["magenta"]
    twice = msgspec.structs.replace(settings, colors=msgspec.structs.replace(settings.colors, classes=classes))
    assert [pair[:2] for pair in report_on_colors(("magenta", "rose"), twice).disputed] == [("magenta", "rose")]
    assert report_on_colors(("magenta", "red"), twice).disputed == ()
