"""``pslv venue new``: by options alone, as a dialogue, and what is said when something is missing."""

from pathlib import Path

import pytest
from typer.testing import CliRunner, Result

from app.cli import app
from tests.setup.demo import DemoPicture, demo_pictures
from vision_core.errors import PslvError
from vision_core.models.camera_setup import CameraSetup
from vision_core.native.opencv import write_picture
from vision_core.venues.loader import load_settings

pytestmark = [pytest.mark.slow, pytest.mark.timeout(300)]
HEIGHT_M = 3.75


@pytest.fixture(scope="module")
def shown() -> DemoPicture:
    return demo_pictures()[0]


@pytest.fixture
def picture(shown: DemoPicture, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setattr("vision_core.setup.venue_file.own_venues_folder", lambda: tmp_path / "venues")
    monkeypatch.setattr("vision_core.venues.loader.own_venues_folder", lambda: tmp_path / "venues")
    path = tmp_path / "field.png"
    write_picture(path, shown.pixels)
    return path


def run(*words: object, answers: str = "") -> Result:
    return CliRunner().invoke(app, ["venue", *map(str, words)], input=answers)


def samples_of(shown: DemoPicture) -> list[str]:
    return [f"{name}={x},{y}" for name, places in shown.papers().items() for x, y in places[:2]]


def test_a_venue_by_options_alone(shown: DemoPicture, picture: Path, tmp_path: Path) -> None:
    bad = tmp_path / "bad.png"
    bad.write_text("no picture")
    colors = [part for text in samples_of(shown) for part in ("--sample", text)]
    words = ["new", "lab", "--pictures", picture, "--pictures", bad, "--pattern", "ssl-standard", "--field", "ssl-2002"]
    result = run(*words, "--height", HEIGHT_M, *colors, "--source", "pictures", "--draw", tmp_path / "drawn")
    assert result.exit_code == 0, result.output
    assert "left out: picture bad.png" in result.stderr
    for team, number in shown.ids():
        assert f"{team} {number}" in result.stdout
    assert f"{len(shown.ids())} with an id" in result.stdout
    assert (tmp_path / "drawn" / "field.png").exists()
    settings = load_settings(str(tmp_path / "venues" / "lab.toml"))
    truth = CameraSetup.from_settings(shown.settings).model.position_m
    assert settings.camera.pinhole.position_m == pytest.approx(truth, abs=0.05)
    assert "lab" in run("list").stdout
    again = run(*words, *colors)
    assert isinstance(again.exception, PslvError)
    assert "is there already" in str(again.exception)


def test_a_dialogue_asks_again_for_what_cannot_be_read(
    shown: DemoPicture, picture: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("app.commands.venue._is_terminal", lambda: True)
    papers = [f"{name}={x},{y}" for name, ((x, y), *_) in shown.papers().items()]
    first = papers.pop(next(number for number, text in enumerate(papers) if text.startswith("orange")))
    colors = [part for text in papers for part in ("--sample", text)]
    answers = [tmp_path / "none.png", picture, "nope", "ssl-standard", "nope", "ssl-2002", "y", "9999,1", first[7:]]
    result = run("new", "lab", "--height", HEIGHT_M, *colors, answers="\n".join(map(str, answers)) + "\n")
    assert result.exit_code == 0, result.output
    for words in ("no such file", "pattern 'nope'", "field nope; found: no such preset", "outside of the picture"):
        assert words in result.stdout
    assert load_settings(str(tmp_path / "venues" / "lab.toml")).field.name == "ssl-2002"


@pytest.mark.parametrize(
    ("words", "error"),
    [
        ((), "--pictures; found: not said, and no terminal to ask on"),
        (("--pictures", "none.png"), "none.png"),
        (("--pattern", "nope"), "--pictures; found: not said"),
    ],
)
def test_what_is_missing_is_named_by_its_option(words: tuple[str, ...], error: str) -> None:
    result = run("new", "lab", *words)
    assert isinstance(result.exception, PslvError)
    assert error in str(result.exception)


def test_wrong_options_are_named(picture: Path) -> None:
    words = ["new", "lab", "--pictures", picture, "--pattern", "ssl-standard", "--field", "ssl-2002"]
    corners = "--corners", "40,30,600,30,600,450,40,450"
    for more, error in (
        (("--corners", "1,2,3"), "--corners 1,2,3; found: not 8 numbers"),
        (("--size", "1"), "--size 1; found: not 2 numbers"),
        (("--size", "1,900"), "--size 1,900"),
        ((*corners, "--walls", "--sample", "orange"), "--sample orange"),
        ((*corners, "--walls", "--sample", "orange=7:1,2"), "found: picture 7; accepted: picture 1 to 1"),
        ((*corners, "--walls", "--sample", "orange=#12"), "found: no color"),
        ((*corners, "--walls", "--sample", "violet=1,2"), "nothing wears it"),
        ((*corners, "--walls"), "--sample orange=X,Y; found: not said"),
    ):
        result = run(*words, *more)
        assert isinstance(result.exception, PslvError), (more, result.output)
        assert error in str(result.exception)
    named = run("new", "My Lab", "--pictures", picture)
    assert "venue My Lab" in str(named.exception)
