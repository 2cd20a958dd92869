"""The document as a file: exported from one server, imported into another."""

import time
from collections.abc import Mapping
from http import HTTPStatus
from typing import Any

from pydantic import ConfigDict

from app.web.configuration.keys import KINDS
from app.web.problems import RequestRefused
from app.web.reports.base import Report

FORMAT = "pslv-settings"
VERSION = 1


class Export(Report):
    """Everything that was changed on the page. It holds no password, key or token."""

    model_config = ConfigDict(extra="forbid")

    format: str = FORMAT
    version: int = VERSION
    made: str = ""
    """When it was made, in UTC."""
    made_by: str = ""
    """Version of the PSLV that made it."""
    venue: str = ""
    entries: dict[str, Any]


def export_of(entries: Mapping[str, Any], version: str, venue: str) -> Export:
    """The document as a file."""
    made = time.strftime("%Y-%m-%dT%H:%M:%SZ", time.gmtime())
    return Export(made=made, made_by=f"PSLV {version}", venue=venue, entries=dict(entries))


def changes_to(imported: Export, entries: Mapping[str, Any]) -> dict[str, Any]:
    """The changes that make the document the imported one: None for entries that it does not have.

    Raises RequestRefused for a file of another format or version, or with entries that are not known.
    """
    if (imported.format, imported.version) != (FORMAT, VERSION):
        raise _refused(f"format {imported.format[:40]!r}, version {imported.version}", f"{FORMAT}, version {VERSION}")
    unknown = [key for key in imported.entries if not key.startswith(KINDS)]
    if unknown:
        raise _refused(f"an entry {unknown[0][:80]!r}", f"keys that begin with {', '.join(KINDS)}")
    empty = [key for key, value in imported.entries.items() if value is None]
    if empty:
        raise _refused(f"entry {empty[0][:80]!r} without a value", "entries with values")
    gone = dict.fromkeys(key for key in entries if key not in imported.entries)
    return {**gone, **{key: value for key, value in imported.entries.items() if entries.get(key) != value}}


def _refused(found: str, accepted: str) -> RequestRefused:
    return RequestRefused(HTTPStatus.UNPROCESSABLE_ENTITY, "import", found=found, accepted=accepted)
