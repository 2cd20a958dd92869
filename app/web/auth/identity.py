"""Who asks. So far everybody who may change something is at the server's own machine (``middleware.local_only``)."""

from dataclasses import dataclass

from starlette.requests import HTTPConnection


@dataclass(frozen=True, slots=True)
class Identity:
    """Who asks."""

    name: str


def identity_of(request: HTTPConnection) -> Identity:
    """Who asks."""
    return Identity(request.client.host if request.client else "unknown")
