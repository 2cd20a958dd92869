"""``pslv calibrate board`` and ``lens``: what is printed can be pasted, and saved; a refusal says what is missing."""

from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner, Result

from app.cli import app
from bench.board_views import board_pictures
from vision_core.errors import SettingsError
from vision_core.native.opencv import read_picture, write_picture
from vision_core.venues.loader import load_settings


@pytest.fixture(scope="module")
def pictures(tmp_path_factory: pytest.TempPathFactory) -> list[Path]:
    folder = tmp_path_factory.mktemp("boards")
    paths = [folder / f"{number}.png" for number in range(7)]
    for path, pixels in zip(paths, board_pictures(), strict=True):
        write_picture(path, pixels)
    return paths


def run(*words: str | Path) -> Result:
    return CliRunner().invoke(app, ["calibrate", *map(str, words)])


@pytest.mark.slow
def test_a_lens_is_printed_drawn_and_saved(pictures: list[Path], tmp_path: Path) -> None:
    venue = tmp_path / "venue.toml"
    venue.write_text('field_preset = "ssl-2002"  # mine\n')
    result = run("lens", *pictures, "--config", venue, "--save", "--draw", tmp_path / "lens.png")
    assert result.exit_code == 0, result.output
    assert "0.png: 0.0" in result.stdout
    lens = load_settings(str(venue)).camera.lens
    assert lens is not None
    assert lens.focal_px == pytest.approx(390.0, abs=3.0)
    assert "# mine" in venue.read_text()
    pasted = tmp_path / "pasted.toml"
    pasted.write_text(result.stdout)
    assert load_settings(str(pasted)).camera.lens == lens
    assert read_picture(tmp_path / "lens.png").shape == (360, 480, 3)


def test_a_refusal_says_what_is_missing(tmp_path: Path) -> None:
    picture = tmp_path / "empty.png"
    write_picture(picture, np.full((120, 160, 3), 90, dtype=np.uint8))
    result = run("lens", picture)
    assert result.exit_code == 2
    assert "refused: the board is seen in 0 of 1 pictures, 4 are needed; not in empty.png (no board" in result.stdout
    assert "[camera.lens]" not in result.stdout
    assert isinstance(run("lens", picture, "--save").exception, SettingsError)


def test_a_board_is_written(tmp_path: Path) -> None:
    assert run("board", "--out", tmp_path / "board.pdf", "--paper", "a3").exit_code == 0
    assert (tmp_path / "board.pdf").read_bytes().startswith(b"%PDF")
    error = run("board", "--out", tmp_path / "board.pdf", "--paper", "A5").exception
    assert "accepted: A4, A3" in str(error)
