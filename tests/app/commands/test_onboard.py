"""``pslv onboard``: the picture that was asked for, the edges in it, and refusals."""

import json
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from app.cli import app
from vision_core.client.panorama import draw_panorama
from vision_core.errors import SettingsError, SourceError
from vision_core.models.mirror import PAPER_MIRROR
from vision_core.native.opencv import read_picture, write_picture


def run(*words: str, command: str = "render") -> str:
    return CliRunner().invoke(app, ["onboard", command, *words], catch_exceptions=False).output


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


@pytest.fixture(scope="module")
def drawn(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with two drawn panoramas: a wall at 60 px, a robot of blue on the left half of the second."""
    folder = tmp_path_factory.mktemp("drawn")
    for name, letters in (("a", "w" * 360), ("b", "x" * 180 + "w" * 180)):
        picture = draw_panorama(np.full(360, 60.0), letters, (40, 300, 6), PAPER_MIRROR)
        write_picture(folder / f"{name}.png", np.ascontiguousarray(picture[..., ::-1]))
    return folder


def test_edges_of_pictures_as_json_and_drawn(drawn: Path, tmp_path: Path) -> None:
    out = tmp_path / "seen"
    lines = run(str(drawn), "--palette", "drawn", "--json", "--draw", str(out), command="edges").splitlines()
    first, second = map(json.loads, lines)
    assert first["edges"] == [["w", 60]] * 360
    assert second["edges"][90] == ["x", 60]
    assert (first["ball"]["px"], first["ball"]["direction_deg"]) == (40, 300)
    assert len(list(out.iterdir())) == 2


def test_edges_in_words(drawn: Path) -> None:
    said = run(str(drawn / "b.png"), "--palette", "drawn", command="edges")
    assert "b.png, picture 0: nearest x at" in said
    assert "300 deg" in said


@pytest.mark.parametrize(
    ("words", "complaint"),
    [
        (("--palette", "painted"), "rendered, drawn"),
        (("--mirror", "1", "2", "3"), "A > B"),
        (("--rim", "-1"), "--rim"),
        (("--nearest", "1e6"), "leave room"),
        (("--center", "0", "0", "--rim", "20"), "leave room"),
    ],
)
def test_edges_that_cannot_be_found_are_refused(words: tuple[str, ...], complaint: str, drawn: Path) -> None:
    with pytest.raises(SettingsError, match=complaint):
        run(str(drawn / "a.png"), *words, command="edges")


def test_a_picture_without_a_mirror_is_named(tmp_path: Path) -> None:
    write_picture(tmp_path / "grey.png", np.full((240, 320, 3), 128, dtype=np.uint8))
    with pytest.raises(SourceError, match=r"grey\.png, picture 0: the mirror's rim; found: corners of brightness 128"):
        run(str(tmp_path / "grey.png"), command="edges")
    (tmp_path / "empty").mkdir()
    with pytest.raises(SourceError, match="no picture"):
        run(str(tmp_path / "empty"), command="edges")
