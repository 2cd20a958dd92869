"""``pslv onboard render`` writes the picture that was asked for, and refuses what it cannot make."""

from pathlib import Path

import pytest
from typer.testing import CliRunner

from app.cli import app
from vision_core.errors import SettingsError
from vision_core.native.opencv import read_picture


def run(*words: str) -> str:
    return CliRunner().invoke(app, ["onboard", "render", *words], catch_exceptions=False).output


def test_the_same_seed_and_time_give_the_same_picture(tmp_path: Path) -> None:
    pictures = []
    for name, seed in (("a", "3"), ("b", "3"), ("c", "4")):
        file = tmp_path / f"{name}.png"
        said = run("--seed", seed, "--robot", "yellow:2", "--time", "1.5", "--size", "120x90", "-o", str(file))
        assert "viewpoint 219 mm high" in said
        pictures.append(read_picture(file, (120, 90)))
    assert (pictures[0] == pictures[1]).all()
    assert (pictures[0] != pictures[2]).any()


def test_another_mirror(tmp_path: Path) -> None:
    said = run("--mirror", "8.591547", "0.01583711", "250000", "--size", "120x90", "-o", str(tmp_path / "a.png"))
    assert "viewpoint 150 mm high, focal length 500 px" in said


@pytest.mark.parametrize(
    ("words", "accepted"),
    [
        (("--robot", "blue"), "blue:1"),
        (("--robot", "green:1"), "blue:1"),
        (("--robot", "blue:7"), "blue:5"),
        (("--size", "640"), "640x480"),
        (("--mirror", "1", "2", "3"), "A > B"),
    ],
)
def test_what_cannot_be_rendered_is_refused(words: tuple[str, ...], accepted: str, tmp_path: Path) -> None:
    with pytest.raises(SettingsError, match=accepted):
        run(*words, "-o", str(tmp_path / "a.png"))
