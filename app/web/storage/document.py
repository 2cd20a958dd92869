"""What was changed on the page: entries by key, every change with who, when, before and after, undo and redo.

A change may touch several entries; it is made as a whole or not at all, and makes a new revision. Undo and redo are
changes as well, so nothing of the history is ever lost. Only changes by a person can be undone.
"""

import json
import threading
import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path
from typing import Any

from app.web.storage.database import Database

VERSION = 1
SCHEMA = """
CREATE TABLE IF NOT EXISTS entries (key TEXT PRIMARY KEY, value TEXT NOT NULL) WITHOUT ROWID;
CREATE TABLE IF NOT EXISTS changes (
    revision INTEGER PRIMARY KEY, at REAL NOT NULL, who TEXT NOT NULL, kind TEXT NOT NULL, what TEXT NOT NULL,
    entries TEXT NOT NULL, of INTEGER
);
"""
UNDO_DEPTH = 100
"""Changes that can be undone, the newest first."""


class Kind(StrEnum):
    """Where a change comes from."""

    CHANGE = "change"
    """A person made it."""
    UNDO = "undo"
    REDO = "redo"
    SERVICE = "service"
    """The service made it by itself: an admission has ended."""


@dataclass(frozen=True, slots=True)
class EntryChange:
    """One entry before and after a change; None: it is not there."""

    key: str
    before: Any
    after: Any


@dataclass(frozen=True, slots=True)
class Change:
    """A change that was made."""

    revision: int
    at: float
    """Seconds since 1970."""
    who: str
    kind: Kind
    what: str
    """In words: "swap sides"."""
    entries: tuple[EntryChange, ...]
    of: int | None
    """The revision that an undo or redo is about."""


class ConflictError(Exception):
    """An entry was changed by somebody else in the meantime."""

    def __init__(self, change: Change, keys: tuple[str, ...]) -> None:
        super().__init__(f"{', '.join(keys)}: changed by {change.who} in revision {change.revision} ({change.what})")
        self.change = change
        self.keys = keys


class NothingToUndoError(Exception):
    """There is no change to undo or to redo."""


class Document:
    """Entries with their history. Threads may share it."""

    def __init__(self, path: Path) -> None:
        """path: of the database's file. Raises ServiceError when it cannot be opened."""
        self._database = Database(path, SCHEMA, VERSION)
        self._connection = self._database.connection
        self._lock = threading.RLock()
        self.notice = self._database.notice
        """What happened to a damaged file; empty when it was in order."""

    def close(self) -> None:
        """Close the file."""
        self._database.close()

    @property
    def revision(self) -> int:
        """Number of the newest change; 0 before the first."""
        with self._lock:
            newest = self._connection.execute("SELECT max(revision) FROM changes").fetchone()[0]
        return newest or 0

    def entries(self) -> dict[str, Any]:
        """All entries by key."""
        with self._lock:
            rows = self._connection.execute("SELECT key, value FROM entries ORDER BY key").fetchall()
        return {key: json.loads(value) for key, value in rows}

    def history(self, limit: int) -> list[Change]:
        """The newest changes, the newest first."""
        with self._lock:
            return list(self._changes("ORDER BY revision DESC LIMIT ?", limit))

    def change(
        self,
        values: Mapping[str, Any],
        *,
        who: str,
        what: str,
        seen: int | None = None,
        kind: Kind = Kind.CHANGE,
    ) -> Change | None:
        """Set entries, or delete those whose value is None. Returns None when nothing differs from before.

        seen: the revision that the person has seen; None: whatever is there is replaced. Raises ConflictError when one
        of the entries was changed after it.
        """
        with self._transaction():
            if seen is not None:
                self._check_unchanged_since(seen, values)
            before = self.entries()
            changed = [
                EntryChange(key, before.get(key), value)
                for key, value in sorted(values.items())
                if before.get(key) != value
            ]
            return self._apply(changed, who, kind, what, None) if changed else None

    def undoable(self) -> Change | None:
        """The change that ``undo`` takes back; None: there is none."""
        return self._stacks()[0]

    def redoable(self) -> Change | None:
        """The change that ``redo`` makes again; None: there is none."""
        return self._stacks()[1]

    def undo(self, *, who: str, seen: int) -> Change:
        """Take back the newest change. Raises NothingToUndoError, or ConflictError when ``seen`` is not the newest."""
        return self._step(Kind.UNDO, who, seen)

    def redo(self, *, who: str, seen: int) -> Change:
        """Make the change again that was taken back last. Raises as ``undo``."""
        return self._step(Kind.REDO, who, seen)

    def _step(self, kind: Kind, who: str, seen: int) -> Change:
        with self._transaction():
            newest = next(self._changes("ORDER BY revision DESC LIMIT ?", 1), None)
            if newest is not None and newest.revision != seen:
                raise ConflictError(newest, tuple(entry.key for entry in newest.entries))
            target = self._stacks()[0 if kind is Kind.UNDO else 1]
            if target is None:
                raise NothingToUndoError
            now = self.entries()
            wanted = {e.key: e.before if kind is Kind.UNDO else e.after for e in target.entries}
            steps = [EntryChange(key, now.get(key), value) for key, value in wanted.items()]
            return self._apply(steps, who, kind, f"{kind}: {target.what}", target.revision)

    def _stacks(self) -> tuple[Change | None, Change | None]:
        """The change that undo takes back, and the one that redo makes again."""
        undo: list[Change] = []
        redo: list[Change] = []
        with self._lock:
            recent = list(self._changes("WHERE kind != 'service' ORDER BY revision DESC LIMIT ?", UNDO_DEPTH))
        for change in reversed(recent):
            if change.kind is Kind.UNDO and undo:
                redo.append(undo.pop())
            elif change.kind is Kind.REDO and redo:
                undo.append(redo.pop())
            elif change.kind is Kind.CHANGE:
                undo.append(change)
                redo.clear()
        return (undo[-1] if undo else None), (redo[-1] if redo else None)

    def _check_unchanged_since(self, seen: int, values: Mapping[str, Any]) -> None:
        known = min(max(seen, 0), self.revision)  # SQLite takes no number of any size
        for change in self._changes("WHERE revision > ? ORDER BY revision DESC", known):
            if keys := tuple(entry.key for entry in change.entries if entry.key in values):
                raise ConflictError(change, keys)

    def _apply(self, changed: list[EntryChange], who: str, kind: Kind, what: str, of: int | None) -> Change:
        for entry in changed:
            if entry.after is None:
                self._connection.execute("DELETE FROM entries WHERE key = ?", (entry.key,))
            else:
                self._connection.execute(
                    "INSERT OR REPLACE INTO entries VALUES (?, ?)", (entry.key, json.dumps(entry.after))
                )
        plain = json.dumps([[entry.key, entry.before, entry.after] for entry in changed])
        at = time.time()
        cursor = self._connection.execute(
            "INSERT INTO changes (at, who, kind, what, entries, of) VALUES (?, ?, ?, ?, ?, ?)",
            (at, who, kind, what, plain, of),
        )
        assert cursor.lastrowid is not None
        return Change(cursor.lastrowid, at, who, kind, what, tuple(changed), of)

    def _changes(self, clause: str, value: int) -> Iterator[Change]:
        rows = self._connection.execute(
            f"SELECT revision, at, who, kind, what, entries, of FROM changes {clause}",  # noqa: S608 (our own clauses)
            (value,),
        ).fetchall()
        for revision, at, who, kind, what, entries, of in rows:
            changed = tuple(EntryChange(*entry) for entry in json.loads(entries))
            yield Change(revision, at, who, Kind(kind), what, changed, of)

    @contextmanager
    def _transaction(self) -> Iterator[None]:
        """All or nothing; afterwards a good copy is kept."""
        with self._lock:
            self._connection.execute("BEGIN IMMEDIATE")
            try:
                yield
            except BaseException:
                self._connection.execute("ROLLBACK")
                raise
            self._connection.execute("COMMIT")
            self._database.keep_good_copy()
