"""The file ``people.db``: opened once by the web process and by commands such as ``pslv passwd``, also side by side.

Readings have a connection of their own, because the event loop makes them for every request: it never waits for a
writing that waits for the disk.
"""

import sqlite3
import threading
from collections.abc import Iterator
from contextlib import closing, contextmanager
from pathlib import Path
from typing import Any

from app.web.storage.database import Database
from vision_core.rtdb.infos import ServiceInfo

NAME = "people.db"
VERSION = 1
SCHEMA = """
CREATE TABLE IF NOT EXISTS passwords (role TEXT PRIMARY KEY, hash TEXT NOT NULL, changed REAL NOT NULL);
CREATE TABLE IF NOT EXISTS first_run (hash TEXT PRIMARY KEY, made REAL NOT NULL);
CREATE TABLE IF NOT EXISTS sessions (
    hash TEXT PRIMARY KEY, role TEXT NOT NULL, name TEXT NOT NULL, team TEXT, made REAL NOT NULL, seen REAL NOT NULL
);
CREATE TABLE IF NOT EXISTS tokens (
    id INTEGER PRIMARY KEY AUTOINCREMENT, name TEXT NOT NULL, role TEXT NOT NULL, hash TEXT NOT NULL UNIQUE,
    made REAL NOT NULL, used REAL
);
CREATE TABLE IF NOT EXISTS team_keys (team TEXT PRIMARY KEY, hash TEXT NOT NULL UNIQUE, made REAL NOT NULL);
CREATE TABLE IF NOT EXISTS audit (
    id INTEGER PRIMARY KEY AUTOINCREMENT, kind TEXT NOT NULL, first REAL NOT NULL, last REAL NOT NULL,
    times INTEGER NOT NULL, who TEXT NOT NULL, address TEXT NOT NULL, what TEXT NOT NULL
);
"""


def people_path(service: ServiceInfo) -> Path:
    """The file beside the one that keeps what is changed on the page."""
    return Path(service.database).parent / NAME


class PeopleFile:
    """The open file. Threads may share it."""

    def __init__(self, path: Path) -> None:
        """Raises ServiceError when it cannot be opened."""
        self._database = Database(path, SCHEMA, VERSION)
        self._reading = sqlite3.connect(path, isolation_level=None, check_same_thread=False)
        self._writing_lock, self._reading_lock = threading.Lock(), threading.Lock()
        self.notice = self._database.notice
        """What happened to a damaged file; empty when it was in order."""

    def close(self) -> None:
        """Close the file."""
        self._reading.close()
        self._database.close()

    def rows(self, query: str, *values: Any) -> list[tuple[Any, ...]]:
        """What a SELECT finds. It waits for no writing."""
        with self._reading_lock, closing(self._reading.execute(query, values)) as found:
            return found.fetchall()

    def row(self, query: str, *values: Any) -> tuple[Any, ...] | None:
        """The first row that a SELECT finds."""
        found = self.rows(query, *values)
        return found[0] if found else None

    @contextmanager
    def writing(self, *, copy: bool = True) -> Iterator[sqlite3.Connection]:
        """All or nothing. copy: it is so important that a good copy is kept afterwards."""
        with self._writing_lock:
            connection = self._database.connection
            connection.execute("BEGIN IMMEDIATE")
            try:
                yield connection
            except BaseException:
                connection.execute("ROLLBACK")
                raise
            connection.execute("COMMIT")
            if copy:
                self._database.keep_good_copy()
