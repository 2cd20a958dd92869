"""What a request needs: one table for every route and WebSocket."""

from enum import StrEnum

READING = frozenset({"GET", "HEAD", "OPTIONS"})
OPEN_CHANGES = frozenset({"/api/v1/login", "/api/v1/logout"})
"""Requests that change something and need nobody: they are how somebody becomes known."""
GUARDED = ("/api/", "/live", "/view3d", "/metrics", "/openapi.json", "/docs")
"""What viewers see. The page itself and its scripts hold no data; they are needed to log in."""
OPERATORS_READ = frozenset(
    {
        "/api/v1/tokens",
        "/api/v1/audit",
        "/api/v1/log",
        "/api/v1/support-bundle",
        "/api/v1/sources",
    }
)
OPERATORS_FOLDERS = ("/api/v1/new-venue", "/api/v1/calibration")
"""Everything of them is the operator's: pictures that somebody gave."""
TEAMS_READ = frozenset({"/api/v1/me", "/api/v1/field", "/api/v1/match", "/api/v1/game", "/live"})
"""What a team needs for its own page, where viewers are kept out."""


class Need(StrEnum):
    """Who may make a request."""

    NOTHING = "nothing"
    VIEWER = "viewer"
    """Anybody where viewers are open; else somebody who has logged in."""
    TEAM = "team"
    """A team's key is enough, also where viewers are kept out."""
    OPERATOR = "operator"


def need_of(method: str, path: str) -> Need:
    """What a request needs. method: of a WebSocket "GET"."""
    if path in OPEN_CHANGES:
        return Need.NOTHING
    if method not in READING or path in OPERATORS_READ or path.startswith(OPERATORS_FOLDERS):
        return Need.OPERATOR
    if path in TEAMS_READ:
        return Need.TEAM
    return Need.VIEWER if path.startswith(GUARDED) else Need.NOTHING
