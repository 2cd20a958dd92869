"""Who may change something: our own page and programs, on this machine, in JSON, and in few words.

Reading is open to whoever reaches the page; a change is taken from the server's own machine alone, since nobody has a
role yet by which a referee could be told from a team. A browser sends a foreign page's request along with its
``Origin``; what comes as JSON or by another method than POST it sends only after it has asked, which we never allow.
Both are looked at, for every request that is not for reading.
"""

from http import HTTPStatus
from ipaddress import ip_address

from starlette.datastructures import Headers
from starlette.requests import Request
from starlette.types import ASGIApp, Receive, Scope, Send

from app.web.middleware.security_headers import is_same_origin
from app.web.problems import problem_response

READING = frozenset({"GET", "HEAD", "OPTIONS"})
JSON = "application/json"
MAX_BODY = 4096
"""Of a request [bytes]."""


class ChangesGuard:
    """Middleware that refuses foreign and formless changes."""

    def __init__(self, app: ASGIApp) -> None:
        self._app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        refusal = _refusal(Headers(scope=scope), scope.get("client")) if _changes(scope) else None
        if refusal is None:
            await self._app(scope, receive, send)
        else:
            await problem_response(Request(scope), *refusal)(scope, receive, send)


def _changes(scope: Scope) -> bool:
    return scope["type"] == "http" and scope["method"] not in READING


def _refusal(headers: Headers, client: tuple[str, int] | None) -> tuple[HTTPStatus, str] | None:
    """Status and words for a request that may not be obeyed; None for one that may."""
    if client is None or not _is_ours(client[0]):
        return HTTPStatus.FORBIDDEN, "changes are taken from the server's own machine only"
    if "origin" in headers and not _is_plain(headers.get("host", "")):
        return HTTPStatus.FORBIDDEN, f"a page at {headers.get('host')} may not change anything; accepted: localhost"
    if not is_same_origin(headers.get("origin"), headers.get("host")):
        return HTTPStatus.FORBIDDEN, f"a page of {headers['origin']} may not change anything here"
    if "transfer-encoding" in headers:
        return HTTPStatus.LENGTH_REQUIRED, "say how long the request is"
    length = headers.get("content-length", "0")
    if not length.isdecimal() or int(length) > MAX_BODY:
        return HTTPStatus.REQUEST_ENTITY_TOO_LARGE, f"at most {MAX_BODY} bytes are read"
    kind = headers.get("content-type", "").partition(";")[0].strip().lower()
    if length != "0" and kind != JSON:
        return HTTPStatus.FORBIDDEN, f"content type {kind or 'of no name'}; accepted: {JSON}"
    return None


def _is_ours(host: str) -> bool:
    """Is it an address of the loopback?"""
    try:
        return ip_address(host).is_loopback
    except ValueError:
        return False


def _is_plain(host: str) -> bool:
    """An address, or localhost: another name may lead here while its page is somebody else's (DNS rebinding)."""
    name = host.rpartition(":")[0] or host
    try:
        return name == "localhost" or bool(ip_address(name.strip("[]")))
    except ValueError:
        return False
