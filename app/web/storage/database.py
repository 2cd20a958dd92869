"""One SQLite file: opened in WAL mode, readable by its owner alone, checked, and copied when it is good.

A damaged file is not repaired: it is set aside under another name, and the last good copy takes its place. A line for
the log and the page says what happened.
"""

import contextlib
import os
import sqlite3
import time
from pathlib import Path

from vision_core.errors import ServiceError

GOOD = ".good"
"""Ending of the copy."""
PRIVATE_FILE = 0o600
PRIVATE_FOLDER = 0o700
BUSY_S = 2.0
"""Another process (the command line) may hold the file for this long."""


class Database:
    """An open file, for one process; its connection may be used by threads that take turns."""

    def __init__(self, path: Path, schema: str, version: int) -> None:
        """schema: statements that make the tables; version: of the schema, above 0.

        Raises ServiceError when the file cannot be opened or belongs to a newer PSLV.
        """
        self.path = path
        self.notice = ""
        """What happened to a damaged file; empty when it was in order."""
        try:
            path.parent.mkdir(parents=True, exist_ok=True, mode=PRIVATE_FOLDER)
            self.connection = _connected(path)
            self._make_tables(schema, version)
        except sqlite3.DatabaseError as damage:
            if isinstance(damage, sqlite3.OperationalError) and not _is_damage(damage):
                raise _cannot_open(path, str(damage)) from None
            self.notice = _set_aside(path, damage)
            self.connection = _connected(path)
            self._make_tables(schema, version)
        except OSError as error:
            raise _cannot_open(path, error.strerror or str(error)) from None
        self.keep_good_copy()

    def keep_good_copy(self) -> None:
        """Copy the file as it is now, for the case that it is damaged later. A full disk leaves the old copy."""
        unfinished = self.path.with_suffix(f"{self.path.suffix}.unfinished")
        with contextlib.suppress(sqlite3.Error, OSError):
            unfinished.unlink(missing_ok=True)
            _create_private(unfinished)
            with contextlib.closing(sqlite3.connect(unfinished)) as copy:
                self.connection.backup(copy)
            unfinished.replace(_good_copy(self.path))

    def close(self) -> None:
        """Close the file."""
        self.connection.close()

    def _make_tables(self, schema: str, version: int) -> None:
        found = self.connection.execute("PRAGMA user_version").fetchone()[0]
        if found > version:
            self.close()
            raise ServiceError(
                f"database {self.path}",
                found=f"version {found}, of a newer PSLV",
                accepted=f"version {version}; --database FOLDER takes another folder",
            )
        self.connection.executescript(schema)
        self.connection.execute(f"PRAGMA user_version = {version}")


def _connected(path: Path) -> sqlite3.Connection:
    """Raises sqlite3.DatabaseError when the file is damaged."""
    _create_private(path)
    connection = sqlite3.connect(path, timeout=BUSY_S, isolation_level=None, check_same_thread=False)
    try:
        connection.execute("PRAGMA journal_mode = WAL")
        connection.execute("PRAGMA synchronous = FULL")
        found = connection.execute("PRAGMA quick_check").fetchone()[0]
        if found != "ok":
            raise sqlite3.DatabaseError(found)
    except sqlite3.Error:
        connection.close()
        raise
    return connection


def _create_private(path: Path) -> None:
    os.close(os.open(path, os.O_RDWR | os.O_CREAT | os.O_CLOEXEC | os.O_NOFOLLOW, PRIVATE_FILE))


def _good_copy(path: Path) -> Path:
    return path.with_suffix(f"{path.suffix}{GOOD}")


def _set_aside(path: Path, damage: sqlite3.DatabaseError) -> str:
    """Give a damaged file another name and put the last good copy in its place. Returns what was done."""
    aside = path.with_name(f"{path.name}.damaged-{time.strftime('%Y%m%d-%H%M%S')}")
    path.replace(aside)
    for ending in ("-wal", "-shm"):
        path.with_name(path.name + ending).unlink(missing_ok=True)
    done = f"{path} is damaged ({damage}) and is kept as {aside.name}"
    good = _good_copy(path)
    if not good.exists():
        return f"{done}; there is no earlier copy of it, so it starts empty"
    made = time.strftime("%Y-%m-%d %H:%M:%S", time.localtime(good.stat().st_mtime))
    good.replace(path)
    return f"{done}; its last good copy, of {made}, is used"


def _is_damage(error: sqlite3.OperationalError) -> bool:
    return error.sqlite_errorcode & 0xFF in (sqlite3.SQLITE_CORRUPT, sqlite3.SQLITE_NOTADB)


def _cannot_open(path: Path, found: str) -> ServiceError:
    return ServiceError(f"database {path}", found=found, accepted="a folder that can be written: --database FOLDER")
