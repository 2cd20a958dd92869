"""``pslv calibrate camera``: what it prints can be pasted, ``--save`` edits a user's file, refusals change nothing."""

import json
import tomllib
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner, Result

from app.cli import app
from bench.calibration_views import floor_error_m, view
from vision_core.errors import PslvError, SettingsError, SourceError
from vision_core.models.camera import CameraModel
from vision_core.native.opencv import read_picture, write_picture
from vision_core.venues.loader import load_settings

pytestmark = pytest.mark.slow
VENUE = """# my field
field_preset = "ssl-2002"   # by tape

[camera]
name = "main"
width_px = 640              # of the old camera

[colors.light]
adapt = true
"""


@pytest.fixture(scope="module")
def truth(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, CameraModel]:
    shown = view(1)
    path = tmp_path_factory.mktemp("pictures") / "field.png"
    write_picture(path, shown.pixels)
    return path, shown.truth


def run(*words: str | Path) -> Result:
    return CliRunner().invoke(app, ["calibrate", "camera", *map(str, words)])


def test_what_it_prints_can_be_pasted(truth: tuple[Path, CameraModel], tmp_path: Path) -> None:
    picture, camera = truth
    result = run(picture, "--find", "--draw", tmp_path / "overlay.png")
    assert result.exit_code == 0, result.output
    venue = tmp_path / "venue.toml"
    venue.write_text(result.stdout)
    settings = load_settings(str(venue))
    assert (settings.camera.width_px, settings.camera.height_px, settings.camera.model) == (780, 580, "pinhole")
    assert floor_error_m(settings.camera.pinhole, camera, settings.field) < 0.003
    assert "px rms" in result.stdout
    assert read_picture(tmp_path / "overlay.png").shape == (580, 780, 3)


def test_save_edits_the_file_and_nothing_else(truth: tuple[Path, CameraModel], tmp_path: Path) -> None:
    venue = tmp_path / "venue.toml"
    venue.write_text(VENUE)
    result = run(truth[0], "--venue", venue, "--save")
    assert result.exit_code == 0, result.output
    text = venue.read_text()
    assert "width_px = 780              # of the old camera" in text
    assert 'field_preset = "ssl-2002"   # by tape' in text
    table = tomllib.loads(text)
    assert table["camera"]["name"] == "main"
    assert table["colors"] == {"light": {"adapt": True}}
    settings = load_settings(str(venue))
    assert floor_error_m(settings.camera.pinhole, truth[1], settings.field) < 0.003
    again = run(truth[0], "--venue", venue, "--save")
    assert again.exit_code == 0, again.output
    assert venue.read_text().count("[camera.pinhole]") == 1


def test_four_points_become_a_pinhole(truth: tuple[Path, CameraModel], tmp_path: Path) -> None:
    picture, camera = truth
    corners = np.array([[-1.4, 1.15], [1.4, 1.15], [1.4, -1.15], [-1.4, -1.15]])
    pixels = (camera.pixel_from_field(corners) + 3.0).round(1).tolist()
    points = [f"  {{ name = 'point {n}', pixel_px = {pixels[n]}, field_m = {corners[n].tolist()} }}," for n in range(4)]
    text = ["[camera]", "width_px = 780", "height_px = 580", 'model = "homography"', "[camera.homography]"]
    venue = tmp_path / "venue.toml"
    venue.write_text("\n".join([*text, "position_m = [0.0, 0.0, 4.0]", "points = [", *points, "]", ""]))
    result = run(picture, "--venue", venue, "--save")
    assert result.exit_code == 0, result.output
    settings = load_settings(str(venue))
    assert settings.camera.model == "pinhole"
    assert floor_error_m(settings.camera.pinhole, camera, settings.field) < 0.003


def test_a_refusal_leaves_the_file_as_it_was(tmp_path: Path) -> None:
    venue, dark = tmp_path / "venue.toml", tmp_path / "dark.png"
    venue.write_text(VENUE)
    write_picture(dark, np.full((480, 640, 3), 9, dtype=np.uint8))
    result = run(dark, "--venue", venue, "--save")
    assert result.exit_code == 2
    assert "refused: the picture is too dark" in result.stdout
    assert "[camera]" not in result.stdout
    assert venue.read_text() == VENUE


def test_swap_ends(truth: tuple[Path, CameraModel]) -> None:
    one, other = (json.loads(run(truth[0], "--json", *words).stdout) for words in ((), ("--swap-ends",)))
    x, y, height = one["camera"]["position_m"]
    assert other["camera"]["position_m"] == pytest.approx([-x, -y, height])
    assert other["lines"][0]["residuals"] == one["lines"][0]["residuals"]


def test_corners(truth: tuple[Path, CameraModel]) -> None:
    picture, camera = truth
    corners = camera.pixel_from_field(np.array([[-1.4, 1.15], [1.4, 1.15], [1.4, -1.15], [-1.4, -1.15]])) + 5.0
    words = ",".join(f"{value:.0f}" for value in corners.ravel())
    assert run(picture, "--corners", words).exit_code == 0
    mirrored = ",".join(f"{value:.0f}" for value in corners[[1, 0, 3, 2]].ravel())
    error = run(picture, "--corners", mirrored).exception
    assert isinstance(error, SettingsError)
    assert "mirrored" in str(error)


@pytest.mark.parametrize(
    ("words", "kind", "said"),
    [
        (("--corners", "1,2,3"), SettingsError, "not eight numbers"),
        (("--save",), SettingsError, "no file of yours"),
        (("--venue", "ssl-rosenheim"), SourceError, "1920x1080 as the venue's camera has"),
    ],
)
def test_what_it_refuses(
    truth: tuple[Path, CameraModel], words: tuple[str, ...], kind: type[PslvError], said: str
) -> None:
    error = run(truth[0], *words).exception
    assert isinstance(error, kind)
    assert said in str(error)
