"""``pslv patterns`` and ``pslv evaluate`` as one calls them."""

import json
from pathlib import Path

import pytest
from typer.testing import CliRunner

from app.cli import app
from vision_core.errors import SettingsError, SourceError


def call(*arguments: str) -> str:
    result = CliRunner().invoke(app, arguments)
    if result.exception is not None and not isinstance(result.exception, SystemExit):
        raise result.exception
    assert result.exit_code == 0, result.output
    return result.stdout


def test_list_and_check() -> None:
    assert "vsss-three-patch     12 ids (1..12)  square 75 mm, 75 mm high" in call("patterns", "list")
    checked = call("patterns", "check", "--venue", "demo-vsss")
    assert "vsss-three-patch: 12 ids, in order" in checked
    assert "6 classes needed, all there, 0 pairs disputed" in checked
    assert "vsss-diagonal and ssl-standard" in call("patterns", "check", "vsss-diagonal", "ssl-standard")


def test_check_refuses() -> None:
    with pytest.raises(SettingsError, match="no class pink"):
        call("patterns", "check", "vsss-diagonal", "--venue", "demo-vsss")
    with pytest.raises(SettingsError, match="pattern 'none'"):
        call("patterns", "check", "none")


def test_the_same_pattern_twice_under_another_name_is_refused(tmp_path: Path) -> None:
    from vision_core.venues.loader import find_file

    copy = tmp_path / "copy.toml"
    copy.write_text(find_file("patterns", "vsss-diagonal").read_text().replace('name = "vsss', 'name = "copy'))
    with pytest.raises(SettingsError, match="patterns seen together"):
        call("patterns", "check", "vsss-diagonal", str(copy))


def test_print(tmp_path: Path) -> None:
    out = str(tmp_path / "m.pdf")
    said = call("patterns", "print", "vsss-diagonal", "--out", out, "--team", "blue", "--ids", "1,3")
    assert "2 markers on 1 pages" in said
    for option, value in (("--ids", "9"), ("--ids", "x"), ("--team", "red")):
        with pytest.raises(SettingsError, match=f"{option}; found: {value}"):
            call("patterns", "print", "vsss-diagonal", "--out", out, option, value)


def test_evaluate_refuses_what_it_cannot_score(tmp_path: Path) -> None:
    truth = tmp_path / "truth.json"
    truth.write_text(json.dumps({"none.png": {"balls": []}}))
    with pytest.raises(SourceError, match=r"none\.png"):
        call("evaluate", str(truth), "--json")
    with pytest.raises(SourceError, match="--only x; found: no picture of this name"):
        call("evaluate", str(truth), "--only", "x")
