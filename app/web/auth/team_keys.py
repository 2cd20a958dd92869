"""The teams' keys: with its own a team opens its page and connects its robots; and the monitors' key.

Only their hashes are kept, and nothing logs them.
"""

import time

from app.web.auth.hashing import digest, is_same, new_secret
from app.web.auth.people_file import PeopleFile

MONITORS = "*monitors"
"""Stands in place of a team for the key with which a monitor sees the field during a match; no team is called so."""


class TeamKeys:
    """The keys in ``people.db``. Threads may share it."""

    def __init__(self, file: PeopleFile) -> None:
        self._file = file

    def renew(self, slug: str) -> str:
        """Give a team a new key of 256 random bits and return it: it is told once. Who came with the old one is out."""
        key = new_secret()
        with self._file.writing() as connection:
            connection.execute("INSERT OR REPLACE INTO team_keys VALUES (?, ?, ?)", (slug, digest(key), time.time()))
            connection.execute("DELETE FROM sessions WHERE team = ?", (slug,))
        return key

    def digest_of(self, slug: str) -> str | None:
        """What is kept of a team's key, for the server of its robots; None: it has none."""
        row = self._file.row("SELECT hash FROM team_keys WHERE team = ?", slug)
        return str(row[0]) if row else None

    def forget(self, slug: str) -> None:
        """Withdraw a team's key, and end what was opened with it."""
        with self._file.writing() as connection:
            connection.execute("DELETE FROM team_keys WHERE team = ?", (slug,))
            connection.execute("DELETE FROM sessions WHERE team = ?", (slug,))

    def team_of(self, key: str) -> str | None:
        """The team whose key this is; None: nobody's."""
        computed = digest(key)
        row = self._file.row("SELECT team, hash FROM team_keys WHERE hash = ?", computed)
        return str(row[0]) if row and is_same(row[1], computed) and row[0] != MONITORS else None
