"""Who sent a request, and in which role."""

from dataclasses import dataclass
from enum import StrEnum

from starlette.requests import HTTPConnection

SCOPE_KEY = "pslv.identity"


class Role(StrEnum):
    """What somebody may do; each role may do what the one before it may."""

    VIEWER = "viewer"
    """Looks at the page."""
    TEAM = "team"
    """Looks, and sees the views of its own robots without delay."""
    OPERATOR = "operator"
    """Changes everything."""


@dataclass(frozen=True, slots=True)
class Identity:
    """Who sent a request."""

    role: Role
    name: str
    """For the history of changes: operator, token "scoreboard", team robots-a; viewer for who did not log in."""
    team: str | None = None
    """Slug of the team, for the role team."""
    is_known: bool = True
    """It has logged in or brought a token; False: it is anybody who reaches the page."""


ANYBODY = Identity(Role.VIEWER, "viewer", is_known=False)


def identity_of(connection: HTTPConnection) -> Identity:
    """Who sent a request or opened a WebSocket, as the middleware found out; ANYBODY where nobody asked."""
    identity = connection.scope.get(SCOPE_KEY, ANYBODY)
    assert isinstance(identity, Identity)
    return identity
