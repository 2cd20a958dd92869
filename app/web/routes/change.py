"""How a route changes the configuration, in the name of who asks."""

from typing import Any

from fastapi import Request

from app.web.auth.identity import identity_of
from app.web.configuration.configuration import Configuration
from app.web.reports.changes import ChangeReport, change_from, not_made


def change(
    configuration: Configuration, values: dict[str, Any], request: Request, what: str, seen: int | None = None
) -> ChangeReport:
    """Change entries; None deletes one. seen: the newest revision that the request knows, None: any.

    Raises RequestRefused for values that are not accepted, and when somebody else was faster.
    """
    made = configuration.change(values, who=identity_of(request).name, what=what, seen=seen)
    return change_from(made) if made else not_made(configuration.revision, what)
