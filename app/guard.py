"""Who may change something: our own page and programs, in JSON, and in few words.

A browser sends a foreign page's request along with its ``Origin``; what comes as JSON or by another method than POST it
sends only after it has asked, which we never allow. Both are looked at, for every request that is not for reading.
"""

from http import HTTPStatus

from starlette.datastructures import Headers
from starlette.requests import Request
from starlette.types import ASGIApp, Receive, Scope, Send

from app.problems import problem_response
from app.security import is_same_origin

READING = frozenset({"GET", "HEAD", "OPTIONS"})
JSON = "application/json"
LONGEST_BODY = 4096
"""Of a request [bytes]."""


class ChangesGuard:
    """Middleware that refuses foreign and formless changes."""

    def __init__(self, app: ASGIApp) -> None:
        self._app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        refusal = _refusal(Headers(scope=scope)) if _changes(scope) else None
        if refusal is None:
            await self._app(scope, receive, send)
        else:
            await problem_response(Request(scope), *refusal)(scope, receive, send)


def _changes(scope: Scope) -> bool:
    return scope["type"] == "http" and scope["method"] not in READING


def _refusal(headers: Headers) -> tuple[HTTPStatus, str] | None:
    """Status and words for a request that may not be obeyed; None for one that may."""
    if not is_same_origin(headers.get("origin"), headers.get("host")):
        return HTTPStatus.FORBIDDEN, f"a page of {headers['origin']} may not change anything here"
    if "transfer-encoding" in headers:
        return HTTPStatus.LENGTH_REQUIRED, "say how long the request is"
    length = headers.get("content-length", "0")
    if not length.isdecimal() or int(length) > LONGEST_BODY:
        return HTTPStatus.REQUEST_ENTITY_TOO_LARGE, f"at most {LONGEST_BODY} bytes are read"
    kind = headers.get("content-type", "").partition(";")[0].strip().lower()
    if length != "0" and kind != JSON:
        return HTTPStatus.FORBIDDEN, f"content type {kind or 'of no name'}; accepted: {JSON}"
    return None
