"""The audit log: who logged in, who failed to, and who changed what. It is bounded, and a flood hides nothing.

Failures of one address are counted in one row, and each kind of entry has room of its own, so that somebody who guesses
passwords cannot push out what was done before. No entry holds a secret.
"""

import time
from dataclasses import dataclass
from enum import StrEnum

from app.web.auth.people_file import PeopleFile

ROOM = 2000
"""Entries of each kind that are kept."""
ONE_ROW_S = 600.0
"""Failures of one address in this time are one entry."""
MAX_WORDS = 200


class Kind(StrEnum):
    """What an entry tells."""

    LOGIN = "login"
    FAILURE = "failure"
    CHANGE = "change"
    SECRET = "secret"  # noqa: S105 (a password, token or key was set or withdrawn)


@dataclass(frozen=True, slots=True)
class Entry:
    """One line of the log, or several that are alike."""

    kind: Kind
    first_at: float
    """Unix time [s]."""
    last_at: float
    """Unix time [s]; that of ``first_at`` when it happened once."""
    times: int
    who: str
    address: str
    """Where it came from; "this machine" for the command line."""
    what: str


class AuditLog:
    """The log in ``people.db``."""

    def __init__(self, file: PeopleFile) -> None:
        self._file = file

    def note(self, kind: Kind, who: str, address: str, what: str) -> None:
        """Add an entry. It waits for the disk, so call it in a thread."""
        now = time.time()
        what = what[:MAX_WORDS]
        with self._file.writing(copy=False) as connection:
            if kind is Kind.FAILURE:
                counted = connection.execute(
                    "UPDATE audit SET times = times + 1, last = ? "
                    "WHERE kind = ? AND who = ? AND address = ? AND what = ? AND first > ?",
                    (now, kind, who, address, what, now - ONE_ROW_S),
                )
                if counted.rowcount:
                    return
            connection.execute(
                "INSERT INTO audit (kind, first, last, times, who, address, what) VALUES (?, ?, ?, 1, ?, ?, ?)",
                (kind, now, now, who, address, what),
            )
            connection.execute(
                "DELETE FROM audit WHERE kind = ? AND id <= "
                "(SELECT id FROM audit WHERE kind = ? ORDER BY id DESC LIMIT 1 OFFSET ?)",
                (kind, kind, ROOM),
            )

    def entries(self, limit: int) -> list[Entry]:
        """The newest entries, the newest first."""
        rows = self._file.rows(
            "SELECT kind, first, last, times, who, address, what FROM audit ORDER BY last DESC, id DESC LIMIT ?", limit
        )
        return [Entry(Kind(kind), *rest) for kind, *rest in rows]
