"""``pslv calibrate mirror``: what it prints can be pasted, ``--save`` edits a user's file, refusals change nothing."""

import json
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner, Result

from app.cli import app
from tests.calibration.mirror.pictures import around
from vision_core.errors import SettingsError
from vision_core.models.from_settings import mirror_of
from vision_core.models.mirror import PAPER_MIRROR
from vision_core.native.opencv import read_picture, write_picture
from vision_core.types.objects import Team
from vision_core.venues.loader import load_settings

DISTANCES = np.array([110.0, 150.0, 220.0, 300.0, 380.0, 500.0, 700.0, 1000.0, 1500.0, 2000.0, 2750.0])
VENUE = """# my field
field_preset = "ssl-2002"

[mirror]
a = 4.0   # guessed
b = 0.0125
"""


@pytest.fixture
def pairs(tmp_path: Path) -> Path:
    path = tmp_path / "pairs.csv"
    rows = [f"{PAPER_MIRROR.px_from_mm(mm):.1f},{mm}" for mm in DISTANCES.tolist()]
    path.write_text("\n".join(["R_px,r_mm", *rows]))
    return path


def run(*words: str | Path) -> Result:
    return CliRunner().invoke(app, ["calibrate", "mirror", *map(str, words)])


def test_what_it_prints_can_be_pasted(pairs: Path, tmp_path: Path) -> None:
    result = run(pairs, "--focal", "300", "--draw", tmp_path / "curve.png")
    assert result.exit_code == 0, result.output
    venue = tmp_path / "venue.toml"
    venue.write_text(result.stdout)
    mirror = mirror_of(load_settings(str(venue)).mirror, Team.BLUE)
    assert mirror.px_from_mm(DISTANCES) == pytest.approx(PAPER_MIRROR.px_from_mm(DISTANCES), abs=0.1)
    assert "px rms over 11 pairs" in result.stdout
    assert read_picture(tmp_path / "curve.png").shape == (640, 800, 3)
    shown = json.loads(run(pairs, "--json").stdout)
    assert shown["shape"]["focal_px"] > 0.0
    assert len(shown["pairs"]) == 11


def test_save_edits_the_file_and_nothing_else(pairs: Path, tmp_path: Path) -> None:
    venue = tmp_path / "venue.toml"
    venue.write_text(VENUE)
    result = run(pairs, "--venue", venue, "--save", "--focal", "300", "--focal-sd", "3")
    assert result.exit_code == 0, result.output
    assert 'field_preset = "ssl-2002"' in venue.read_text()
    assert "# guessed" in venue.read_text()
    mirror = mirror_of(load_settings(str(venue)).mirror, Team.YELLOW)
    assert (mirror.a, mirror.b, mirror.c) == pytest.approx((PAPER_MIRROR.a, PAPER_MIRROR.b, PAPER_MIRROR.c), rel=0.03)


def test_a_team_and_a_robot_have_mirrors_of_their_own(pairs: Path, tmp_path: Path) -> None:
    venue = tmp_path / "venue.toml"
    venue.write_text(VENUE)
    for whose in ("yellow", "blue:3", "blue:3"):
        result = run(pairs, "--venue", venue, "--save", "--for", whose)
        assert result.exit_code == 0, result.output
    assert [line for line in venue.read_text().splitlines() if line.startswith("[")] == [
        "[mirror]",
        "[mirror.yellow]",
        '[mirror.robots."blue 3"]',
    ]
    mirrors = load_settings(str(venue)).mirror
    radii = [mirror_of(mirrors, team, 3).px_from_mm(DISTANCES) for team in Team]
    assert radii[0] == pytest.approx(PAPER_MIRROR.px_from_mm(DISTANCES), abs=0.2)
    assert radii[0] == pytest.approx(radii[1])
    assert mirror_of(mirrors, Team.BLUE, 2).a == 4.0, "the field's stays"


def test_a_refusal_leaves_the_file_as_it_was(pairs: Path, tmp_path: Path) -> None:
    venue = tmp_path / "venue.toml"
    venue.write_text(VENUE)
    pairs.write_text("\n".join(pairs.read_text().splitlines()[:6]))
    result = run(pairs, "--venue", venue, "--save", "--draw", tmp_path / "curve.png")
    assert result.exit_code == 2
    assert "refused: pairs at 5 distances agree, 6 are needed" in result.stdout
    assert "[mirror]" not in result.stdout
    assert venue.read_text() == VENUE
    assert (tmp_path / "curve.png").exists()


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("--focal-sd", "3"), "no --focal"),
        (("--save",), "no file of yours"),
        (("--field", "moon"), "moon"),
        (("--for", "blue:17"), "blue:17"),
        (("--for", "green"), "blue, yellow, or a robot's"),
    ],
)
def test_what_it_refuses(pairs: Path, words: tuple[str, ...], said: str) -> None:
    error = run(pairs, *words).exception
    assert isinstance(error, SettingsError)
    assert said in str(error)


def test_pictures_of_a_target_at_known_distances(tmp_path: Path) -> None:
    words: list[str | Path] = []
    for mm in DISTANCES.tolist():
        path = tmp_path / f"{mm:.0f}.png"
        write_picture(path, around(np.full(360, PAPER_MIRROR.px_from_mm(mm))))
        words += ["--picture", path, "--at", f"{mm}"]
    result = run(*words, "--focal", "300", "--json")
    assert result.exit_code == 2, "the mirror's rim is the strongest edge"
    for mm in DISTANCES.tolist():
        words += ["--click", f"159.5,{119.5 - PAPER_MIRROR.px_from_mm(mm) - 2.0}"]
    result = run(*words, "--focal", "300", "--json")
    assert result.exit_code == 0, result.output
    shown = json.loads(result.stdout)
    curve = [(point["r_mm"], point["r_px"]) for point in shown["curve"]]
    assert max(abs(px - PAPER_MIRROR.px_from_mm(mm)) for mm, px in curve) < 0.3
    assert shown["pairs"][0]["name"] == "110.png"


def test_surroundings_from_a_file(tmp_path: Path) -> None:
    directions = np.arange(360.0)
    distances = 300.0 + 750.0 * (1.0 - np.cos(np.radians(2.0 * directions)))
    picture, table = tmp_path / "onboard.png", tmp_path / "around.csv"
    write_picture(picture, around(PAPER_MIRROR.px_from_mm(distances)))
    rows = [f"{degree:.0f};{mm:.1f}" for degree, mm in zip(directions, distances, strict=True)]
    table.write_text("\n".join(["direction [deg];r [mm]", *rows]))
    result = run("--picture", picture, "--around", table, "--focal", "300")
    assert result.exit_code == 0, result.output
    assert "px rms over 3" in result.stdout
    table.write_text("direction [deg];r [mm]\n0;0\n")
    error = run("--picture", picture, "--around", table).exception
    assert isinstance(error, SettingsError)
    assert "line 2; found: no distance" in str(error)
