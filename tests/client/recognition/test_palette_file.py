"""Palettes of a file, in TOML and JSON, and what is refused."""

import json
from pathlib import Path

import numpy as np
import pytest

from vision_core.client.recognition import DRAWN, RENDERED, Surface, load_palette
from vision_core.client.recognition.palette import label_pixels
from vision_core.errors import SettingsError

GOOD = {
    "tolerance": 0.4,
    "dark_feet": True,
    "colors": {"floor": [30, 90, 200], "wall": [[250, 250, 250], [120, 120, 120]]},
}


def test_toml_and_json_say_the_same(tmp_path: Path) -> None:
    as_json, as_toml = tmp_path / "a.json", tmp_path / "a.toml"
    as_json.write_text(json.dumps(GOOD))
    as_toml.write_text(
        "tolerance = 0.4\ndark_feet = true\n[colors]\nfloor = [30, 90, 200]\n"
        "wall = [[250, 250, 250], [120, 120, 120]]\n"
    )
    palette = load_palette(str(as_json))
    assert palette == load_palette(str(as_toml))
    assert palette.colors[0] == (Surface.FLOOR, (30, 90, 200))
    assert (len(palette.colors), palette.tolerance, palette.dark_feet) == (3, 0.4, True)


def test_presets_have_names() -> None:
    assert load_palette("rendered") is RENDERED
    assert load_palette("drawn") is DRAWN


def test_light_changes_no_label_within_reason() -> None:
    for surface, rgb in DRAWN.colors:
        for light in (0.85, 1.0):
            bgr = np.array([[light * np.array(rgb[::-1])]]).astype(np.uint8)
            assert label_pixels(bgr, DRAWN) == surface
    assert label_pixels(np.array([[[255, 0, 255]]], dtype=np.uint8), RENDERED) == Surface.OTHER


@pytest.mark.parametrize(
    ("name", "content", "complaint"),
    [
        ("painted", "", "rendered, drawn"),
        ("a.json", "{", "valid TOML or JSON"),
        ("a.toml", "colors = [", "valid TOML or JSON"),
        ("a.json", "[1]", "tolerance, dark_feet, colors"),
        ("a.json", '{"collors": {}}', "found: collors"),
        ("a.json", '{"colors": {"floor": [1, 2, 3]}}', "floor, and at least one of"),
        ("a.json", '{"colors": {"wall": [1, 2, 3], "dark": [1, 2, 3]}}', "floor, and at least one of"),
        ("a.json", '{"colors": {"floor": [1, 2, 3], "sky": [1, 2, 3]}}', "found: floor, sky"),
        ("a.json", '{"colors": {"floor": [1, 2], "wall": [1, 2, 3]}}', "colors.floor"),
        ("a.json", '{"colors": {"floor": [1, 2, 300], "wall": [1, 2, 3]}}', "0..255"),
        ("a.json", '{"colors": {"floor": [], "wall": [1, 2, 3]}}', "colors.floor"),
        ("a.json", '{"tolerance": 0, "colors": {"floor": [1, 2, 3], "wall": [1, 2, 3]}}', "above 0"),
        ("a.json", '{"dark_feet": 1, "colors": {"floor": [1, 2, 3], "wall": [1, 2, 3]}}', "true or false"),
        ("missing.json", None, "missing.json"),
    ],
)
def test_what_is_refused(tmp_path: Path, name: str, content: str | None, complaint: str) -> None:
    path = tmp_path / name
    if content is not None:
        path.write_text(content)
    with pytest.raises(SettingsError, match=complaint):
        load_palette(str(path))
