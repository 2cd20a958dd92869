"""What ``pslv config validate`` warns of: palettes and patterns that are accepted and probably wrong."""

from pathlib import Path

import pytest

from vision_core.pipeline.venue_warnings import venue_warnings
from vision_core.venues.loader import config_folder, layers_of, place_of, settings_from_layers

SHIPPED = sorted(path.stem for path in (config_folder() / "venues").glob("*.toml"))
SAMPLES = """[colors.samples]
orange = ["#f07828"]
yellow = ["#ebd228", "#d0b820"]
blue = ["#145ac8", "#2064c8"]
pink = ["#eb46be"]
green = ["#3ce15a"]
"""
MERGING = """name = "two"
[robot]
outline = "square"
radius_m = 0.0375
height_m = 0.075
[[patches]]
color = "team"
polygon_mm = [[1.5, -34.5], [34.5, -34.5], [34.5, 34.5], [1.5, 34.5], [1.5, -34.5]]
[[patches]]
color = "code"
polygon_mm = [[-34.5, 1.5], [-1.5, 1.5], [-1.5, 34.5], [-34.5, 34.5], [-34.5, 1.5]]
[[patches]]
color = "code"
polygon_mm = [[-34.5, -34.5], [-1.5, -34.5], [-1.5, -1.5], [-34.5, -1.5], [-34.5, -34.5]]
[code]
colors = ["green", "pink"]
[code.ids]
1 = "GP"
2 = "GG"
"""


def warnings(folder: Path, text: str, numbers: int = 2) -> list[str]:
    file = folder / "venue.toml"
    file.write_text(f"{text}\n[match]\nnumbers = {numbers}\n")
    layers = layers_of(str(file))
    return list(venue_warnings(settings_from_layers(layers), lambda key: place_of(key, layers)))


@pytest.mark.parametrize("venue", SHIPPED)
def test_shipped_venues_are_in_order(venue: str) -> None:
    layers = layers_of(venue)
    assert list(venue_warnings(settings_from_layers(layers), lambda key: place_of(key, layers))) == []


@pytest.mark.parametrize(
    ("samples", "words"),
    [
        (SAMPLES, None),
        (SAMPLES.replace("yellow =", "x =").replace("blue =", "yellow =").replace("x =", "blue ="),
         "class yellow looks blue (#1a5fc8); blue looks yellow: the two are exchanged"),
        (SAMPLES.replace('pink = ["#eb46be"]', 'pink = ["#3ce05c"]'), "class pink looks green"),
        (SAMPLES.replace('pink = ["#eb46be"]', 'pink = ["#eb46be", "#3ce05c"]'),
         "one color in two classes"),
        (SAMPLES.replace('"#d0b820"', '"#3060b8"'), "#3060b8 is "),
    ],
    ids=["in order", "teams exchanged", "another name", "contradictory", "far from its class"],
)  # fmt: skip
def test_palettes(tmp_path: Path, samples: str, words: str | None) -> None:
    found = warnings(tmp_path, samples)
    assert (found == []) if words is None else any(words in warning for warning in found), found
    assert all("venue.toml, line" in warning for warning in found)


def test_patches_that_run_together_are_said_with_the_ids(tmp_path: Path) -> None:
    (tmp_path / "two.toml").write_text(MERGING)
    (found,) = warnings(tmp_path, '[robots]\npattern = "two.toml"')
    assert "robots.pattern: patches 2 and 3 of two id 2 have one color and are 3 mm apart" in found
    assert "px at 5." in found


def test_as_few_ids_as_numbers_are_said(tmp_path: Path) -> None:
    assert "match.numbers is 17" not in "".join(warnings(tmp_path, "", 16))
    (tmp_path / "two.toml").write_text(MERGING)
    found = warnings(tmp_path, '[robots]\npattern = "two.toml"', 5)
    assert any("match.numbers is 5, but pattern 'two' of team blue has ids 1, 2 alone" in warning for warning in found)
