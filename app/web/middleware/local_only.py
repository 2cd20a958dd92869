"""Requests that change something are accepted from this machine only, from our own page or a program, as short JSON.

Every machine that reaches the page may read. Changes need the server's own machine, because there are no user roles yet
that distinguish a referee from a team. A browser sends a request of a foreign page with its ``Origin`` header; a
request with JSON, or by a method other than POST, needs a preflight request first, which is never granted. Origin and
content type are checked for every request that does not only read.
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
"""Largest body of a request [bytes]."""


class LocalChangesOnly:
    """Middleware that refuses changes from other machines and foreign pages, and those that are not short JSON."""

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
    """Status and reason for a request that is refused; None for one that is accepted."""
    if client is None or not _is_loopback(client[0]):
        return HTTPStatus.FORBIDDEN, "changes are accepted from the server's own machine only"
    if "origin" in headers and not _is_local_name(headers.get("host", "")):
        return HTTPStatus.FORBIDDEN, f"a page at {headers.get('host')} may not change anything; accepted: localhost"
    if not is_same_origin(headers.get("origin"), headers.get("host")):
        return HTTPStatus.FORBIDDEN, f"a page of {headers['origin']} may not change anything here"
    if "transfer-encoding" in headers:
        return HTTPStatus.LENGTH_REQUIRED, "the request has no Content-Length"
    length = headers.get("content-length", "0")
    if not length.isdecimal() or int(length) > MAX_BODY:
        return HTTPStatus.REQUEST_ENTITY_TOO_LARGE, f"the request is longer than {MAX_BODY} bytes"
    kind = headers.get("content-type", "").partition(";")[0].strip().lower()
    if length != "0" and kind != JSON:
        return HTTPStatus.FORBIDDEN, f"content type {kind or 'is missing'}; accepted: {JSON}"
    return None


def _is_loopback(host: str) -> bool:
    """Is it an address of this machine's loopback interface?"""
    try:
        return ip_address(host).is_loopback
    except ValueError:
        return False


def _is_local_name(host: str) -> bool:
    """Is it an IP address or localhost? Another name may resolve to this machine for a foreign page (DNS rebinding)."""
    name = host.rpartition(":")[0] or host
    try:
        return name == "localhost" or bool(ip_address(name.strip("[]")))
    except ValueError:
        return False
