"""What was changed on the page is there at the next start of the same venue, and only there."""

from pathlib import Path

import pytest

from app.launch.kept_changes import database_folder, scope_of, with_kept_changes
from app.web.storage.document import Document
from vision_core.errors import ServiceError
from vision_core.venues.loader import layers_of, settings_from_layers


def kept(path: Path, **settings: object) -> None:
    document = Document(path)
    values = {f"settings/{key.replace('__', '.')}": value for key, value in settings.items()}
    document.change(values, who="Ada", what="a test")
    document.close()


def test_a_change_is_there_at_the_next_start(tmp_path: Path) -> None:
    kept(tmp_path / "venue.db", match__blue_defends="right")
    lines: list[str] = []
    settings = settings_from_layers(with_kept_changes(tmp_path / "venue.db", layers_of(), lines.append))
    assert settings.match.blue_defends == "right"
    assert lines == ["1 settings were changed on the page: match.blue_defends"]


def test_a_change_that_does_not_fit_any_more_is_left_out_and_said(tmp_path: Path) -> None:
    kept(tmp_path / "venue.db", match__blue_ids=[1, 2], match__numbers=16)
    lines: list[str] = []
    settings = settings_from_layers(with_kept_changes(tmp_path / "venue.db", layers_of(), lines.append))
    assert settings.match.numbers == 5
    assert "left out: changes made on the page: match.blue_ids" in lines[0]


def test_the_command_line_wins_over_the_page(tmp_path: Path) -> None:
    kept(tmp_path / "venue.db", server__port=8001)
    layers = layers_of(options={"server.port": 8002})
    settings = settings_from_layers(with_kept_changes(tmp_path / "venue.db", layers, lambda _line: None))
    assert settings.server.port == 8002


def test_each_venue_has_its_own(tmp_path: Path) -> None:
    venues = (None, "demo-vsss", str(tmp_path / "hall.toml"), str(tmp_path / "other" / "hall.toml"))
    scopes = [scope_of(venue, None) for venue in venues]
    assert scopes[:2] == ["default", "demo-vsss"]
    assert len(set(scopes)) == 4
    assert scope_of("demo-vsss", tmp_path / "lamps.toml") not in scopes


def test_a_folder_that_was_chosen_and_cannot_be_written_is_an_error(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("no folder")
    with pytest.raises(ServiceError, match="--database"):
        database_folder(tmp_path / "file")


def test_without_a_data_folder_memory_is_taken_and_said(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "file").write_text("no folder")
    monkeypatch.setenv("PSLV_DATA_DIR", str(tmp_path / "file"))
    monkeypatch.setattr("app.launch.kept_changes.MEMORY", tmp_path / "memory")
    folder, line = database_folder(None)
    assert folder.is_relative_to(tmp_path / "memory")
    assert "until this machine restarts" in line
