"""``pslv colors``: what it prints can be pasted, and what it cannot do it refuses by name."""

import tomllib
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from app.cli import app
from app.commands.colors import color_at, places_of
from vision_core.errors import PslvError, SettingsError
from vision_core.native.opencv import write_picture
from vision_core.venues.loader import load_settings


@pytest.fixture
def picture(tmp_path: Path) -> Path:
    pixels = np.zeros((480, 640, 3), dtype=np.uint8)
    pixels[:] = (46, 98, 38)
    pixels[100:120, 200:220] = (192, 80, 32)
    write_picture(tmp_path / "field.png", pixels)
    return tmp_path / "field.png"


def run(*words: str) -> tuple[str, BaseException | None]:
    result = CliRunner().invoke(app, ["colors", *words])
    return result.stdout, result.exception


def test_samples_can_be_pasted_into_a_venue(picture: Path, tmp_path: Path) -> None:
    out, error = run("sample", str(picture), "--class", "paint", "--at", "210,110,211,111", "--at", "20,20")
    assert error is None
    assert tomllib.loads(out) == {"colors": {"samples": {"paint": ["#2050c0", "#26622e"]}}}
    assert out.count("# ") == 3
    venue = tmp_path / "venue.toml"
    venue.write_text(out)
    assert load_settings(str(venue)).colors.samples == {"paint": ("#2050c0", "#26622e")}


def test_show_says_the_class_and_the_misses(picture: Path) -> None:
    out, error = run("show", str(picture), "--at", "210,110,20,20")
    assert error is None
    assert "210,110: blue | bgr 192 80 32 #2050c0 | hsv: hue_deg 222" in out
    assert "blue: claims it" in out
    assert "20,20: no class" in out
    assert "orange: no: hue_deg 128 misses 4..34 by 94" in out


def test_light_prints_the_line_of_the_settings(picture: Path) -> None:
    out, error = run("light", str(picture))
    assert error is None
    assert tomllib.loads(out)["reference_bgr"] == [46.0, 98.0, 38.0]
    reference = load_settings().colors.light.reference_bgr
    assert reference is not None
    gains = " ".join(f"{wanted / found:.2f}" for wanted, found in zip(reference, (46.0, 98.0, 38.0), strict=True))
    assert f"gains {gains}" in out


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--class", "paint", "--at", "640,10"], "--at 640,10; found: a point outside of the picture"),
        (["--class", "paint", "--at", "10,-1"], "--at 10,-1; found: a point outside of the picture"),
        (["--class", "paint", "--at", "10"], "--at 10; found: no pairs"),
        (["--class", "paint", "--at", "a,b"], "--at a,b; found: no pairs"),
    ],
)
def test_what_cannot_be_sampled_is_refused_by_name(picture: Path, words: list[str], said: str) -> None:
    out, error = run("sample", str(picture), *words)
    assert isinstance(error, PslvError)
    assert said in str(error)
    assert out == ""


def test_a_class_that_the_same_file_defines_by_ranges_is_refused_with_its_line(picture: Path, tmp_path: Path) -> None:
    venue = tmp_path / "venue.toml"
    venue.write_text("[colors.classes]\nblue = [{ hue_deg = [200, 240] }]\n")
    out, error = run("sample", str(picture), "--class", "blue", "--at", "10,10", "--venue", str(venue))
    assert isinstance(error, PslvError)
    assert f"--class blue; found: a class by ranges ({venue}, line 2)" in str(error)
    assert out == ""


def test_a_palette_can_be_made_from_nothing_with_samples_alone(picture: Path, tmp_path: Path) -> None:
    venue = tmp_path / "venue.toml"
    venue.write_text("[colors.classes]\n")
    with pytest.raises(SettingsError, match="there is none yet; to make it: pslv colors sample"):
        load_settings(str(venue))
    missing = ["orange", "blue", "yellow", "pink", "green"]
    while missing:
        name = missing.pop(0)
        words = ["sample", str(picture), "--class", name, "--at", f"210,{101 + len(missing)}", "--venue", str(venue)]
        result = CliRunner().invoke(app, ["colors", *words, "--save"])
        assert result.exception is None
        assert f"saved in {venue}" in result.stderr
        said = result.stderr.partition("classes without a color yet: ")[2].partition(";")[0]
        assert set(filter(None, said.split(", "))) == set(missing)
        text = venue.read_text().replace("#2050c0", f"#2050{len(missing):02x}")  # the picture has one color only
        venue.write_text(text)
    assert list(load_settings(str(venue)).colors.samples) == ["orange", "blue", "yellow", "pink", "green"]


def test_what_is_printed_says_where_it_goes_and_can_be_read(picture: Path, tmp_path: Path) -> None:
    venue = tmp_path / "venue.toml"
    venue.touch()
    words = ["colors", "sample", str(picture), "--class", "Orange ball", "--at", "210,110", "--venue", str(venue)]
    result = CliRunner().invoke(app, words)
    assert tomllib.loads(result.stdout) == {"colors": {"samples": {"Orange ball": ["#2050c0"]}}}
    assert f"append these lines to {venue}" in result.stderr
    venue.write_text(result.stdout)
    assert f"replace [colors.samples] in line 2 of {venue}" in CliRunner().invoke(app, words).stderr
    without_file = CliRunner().invoke(app, [*words[:-2], "--save"])
    assert "--save; found: no file of yours" in str(without_file.exception)


def test_a_grey_color_has_no_hue_and_no_nan(tmp_path: Path) -> None:
    write_picture(tmp_path / "grey.png", np.full((480, 640, 3), 89, dtype=np.uint8))
    out, error = run("sample", str(tmp_path / "grey.png"), "--class", "grey", "--at", "10,10")
    assert error is None
    assert "nan" not in out
    assert "hue_deg none" in out


def test_a_square_at_the_edge_is_what_of_it_lies_inside() -> None:
    pixels = np.arange(4 * 4 * 3, dtype=np.uint8).reshape(4, 4, 3)
    assert color_at(pixels, (0, 0), 1, Path("x")).tolist() == np.median(pixels[:2, :2].reshape(-1, 3), axis=0).tolist()
    assert places_of(["1,2,3,4", "5,6"]) == [(1, 2), (3, 4), (5, 6)]
