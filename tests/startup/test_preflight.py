"""What would kill a task again and again is one line before the start."""

import io
from typing import Any

import msgspec
import pytest

from vision_core.errors import SettingsError
from vision_core.models.camera_setup import CameraSetup
from vision_core.startup.preflight import check_tasks, main
from vision_core.venues.loader import load_settings

WRONG: list[tuple[dict[str, Any], str]] = [
    ({"source.uri": "file:nowhere.jpg"}, "nowhere.jpg"),
]


def exit_status(options: dict[str, Any], monkeypatch: pytest.MonkeyPatch) -> int:
    written = msgspec.json.encode(load_settings(options=options))
    monkeypatch.setattr("sys.stdin", io.TextIOWrapper(io.BytesIO(written)))
    return main()


@pytest.mark.parametrize(("options", "named"), WRONG, ids=[next(iter(options)) for options, _ in WRONG])
def test_one_line_names_what_is_wrong(
    options: dict[str, Any], named: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    assert exit_status(options, monkeypatch) == 2
    said = capsys.readouterr().err
    assert named in said
    assert said.count("\n") == 1


def test_the_defaults_are_in_order(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    assert exit_status({}, monkeypatch) == 0
    assert capsys.readouterr().err == ""


def test_what_is_odd_is_said_and_no_error(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    assert exit_status({"match.blue_ids": [1, 2, 3, 4, 77]}, monkeypatch) == 0
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith("warning: settings: match.blue_ids gives numbers 1 to 5 id 77")


def test_a_palette_without_the_markers_colors_is_refused() -> None:
    settings = load_settings(options={"colors.classes": {"orange": [{"hue_deg": [4.0, 34.0]}]}})
    with pytest.raises(SettingsError, match="colors; found"):
        check_tasks(settings, CameraSetup.from_settings(settings))
