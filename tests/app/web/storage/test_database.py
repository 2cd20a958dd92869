"""A database file: private, checked, set aside when damaged."""

import stat
from pathlib import Path

import pytest

from app.web.storage.database import Database
from vision_core.errors import ServiceError

SCHEMA = "CREATE TABLE IF NOT EXISTS things (name TEXT PRIMARY KEY);"


def stored(database: Database) -> list[str]:
    return [row[0] for row in database.connection.execute("SELECT name FROM things ORDER BY name")]


@pytest.fixture
def path(tmp_path: Path) -> Path:
    """A file with one row, whose good copy has that row."""
    path = tmp_path / "data" / "venue.db"
    database = Database(path, SCHEMA, 1)
    database.connection.execute("INSERT INTO things VALUES ('ball')")
    database.keep_good_copy()
    database.close()
    return path


def test_what_was_written_is_there_after_a_restart(path: Path) -> None:
    database = Database(path, SCHEMA, 1)
    assert (stored(database), database.notice) == (["ball"], "")


def test_only_its_owner_may_read_it(path: Path) -> None:
    files = [path, *path.parent.glob("*.good")]
    assert [stat.S_IMODE(file.stat().st_mode) for file in files] == [0o600, 0o600]


@pytest.mark.parametrize("damage", [b"no database at all" * 100, b"SQLite format 3\0" + b"\xff" * 5000])
def test_a_damaged_file_is_set_aside_and_its_last_good_copy_is_used(path: Path, damage: bytes) -> None:
    path.write_bytes(damage)
    database = Database(path, SCHEMA, 1)
    assert stored(database) == ["ball"]
    (aside,) = path.parent.glob("*.damaged-*")
    assert aside.read_bytes() == damage
    assert aside.name in database.notice
    assert "its last good copy" in database.notice


def test_a_file_whose_pages_are_damaged_is_found_at_the_next_start(path: Path) -> None:
    content = bytearray(path.read_bytes())
    content[4096:] = b"\x55" * (len(content) - 4096)
    path.write_bytes(content)
    database = Database(path, SCHEMA, 1)
    assert stored(database) == ["ball"]
    assert "is damaged" in database.notice


def test_without_a_good_copy_it_starts_empty_and_says_so(path: Path) -> None:
    path.write_bytes(b"rubbish" * 1000)
    path.with_suffix(".db.good").unlink()
    database = Database(path, SCHEMA, 1)
    assert stored(database) == []
    assert "starts empty" in database.notice


def test_a_file_of_a_newer_version_is_refused_and_kept(path: Path) -> None:
    Database(path, SCHEMA, 3).close()
    with pytest.raises(ServiceError, match="version 3, of a newer PSLV"):
        Database(path, SCHEMA, 2)
    assert not list(path.parent.glob("*.damaged-*"))


def test_a_folder_that_is_a_file_is_refused(tmp_path: Path) -> None:
    (tmp_path / "data").write_text("no folder")
    with pytest.raises(ServiceError, match="--database FOLDER"):
        Database(tmp_path / "data" / "venue.db", SCHEMA, 1)
