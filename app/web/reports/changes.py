"""Changes that were made on the page."""

from collections.abc import Iterable
from typing import Any

from app.web.configuration.keys import SETTING
from app.web.reports.base import Report
from app.web.storage.document import Change, EntryChange, Kind
from vision_core.settings.live import is_live


class EntryReport(Report):
    """One entry before and after a change."""

    key: str
    """``settings/<key>``, ``teams/<team>``, ``plays/<color>``, ``admissions/<number>`` or ``refusals/<address>``."""
    before: Any
    """null: it was not there."""
    after: Any
    """null: it is deleted."""


class ChangeReport(Report):
    """A change, with who, when, before and after."""

    revision: int
    at: float | None
    """Seconds since 1970; null: it was not made."""
    who: str
    kind: Kind | None
    """null: it was not made."""
    what: str
    entries: list[EntryReport]
    """Empty: nothing differs from before."""
    of: int | None
    """The revision that an undo or redo is about."""
    needs_restart: list[str]
    """Settings among them that take effect with the next start of the service."""


def change_from(change: Change) -> ChangeReport:
    """The report of a change."""
    return ChangeReport(
        revision=change.revision,
        at=change.at,
        who=change.who,
        kind=change.kind,
        what=change.what,
        entries=_entries(change.entries),
        of=change.of,
        needs_restart=_need_restart(change.entries),
    )


def not_made(revision: int, what: str, entries: Iterable[EntryChange] = ()) -> ChangeReport:
    """The report of a change that is only previewed, or that changes nothing. revision: the newest."""
    entries = tuple(entries)
    return ChangeReport(
        revision=revision,
        at=None,
        who="",
        kind=None,
        what=what,
        entries=_entries(entries),
        of=None,
        needs_restart=_need_restart(entries),
    )


def _entries(entries: Iterable[EntryChange]) -> list[EntryReport]:
    return [EntryReport(key=entry.key, before=entry.before, after=entry.after) for entry in entries]


def _need_restart(entries: Iterable[EntryChange]) -> list[str]:
    keys = [entry.key.removeprefix(SETTING) for entry in entries if entry.key.startswith(SETTING)]
    return [key for key in keys if not is_live(key)]
