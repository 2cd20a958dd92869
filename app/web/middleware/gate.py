"""The gate in front of every route and WebSocket: under which name we were asked, who asks, and whether he may.

In this order, the cheapest first: the name in the header Host (DNS rebinding), its origin (foreign pages), length and
kind of what changes something, the session or token (who), the table of ``auth.rules`` (may he). Loopback is no
identity: whoever may log in to this machine may not therefore change a match.
"""

from collections.abc import Sequence
from http import HTTPStatus
from http.cookies import CookieError, SimpleCookie
from typing import Any

from starlette.datastructures import Headers
from starlette.requests import Request
from starlette.types import ASGIApp, Receive, Scope, Send

from app.web.auth.addresses import address_of, is_our_name
from app.web.auth.credential import SCOPE_KEY as CREDENTIAL_KEY
from app.web.auth.credential import Credential
from app.web.auth.identity import ANYBODY, SCOPE_KEY, Identity, Role
from app.web.auth.people import People
from app.web.auth.rules import READING, Need, need_of
from app.web.connections import OperatorAddresses
from app.web.middleware.security_headers import is_same_origin
from app.web.problems import cut, problem_response
from vision_core.setup.folder import MAX_FILE_BYTES

JSON = "application/json"
MAX_BODY = 4096
"""Largest body of a request [bytes]."""
FILE = "application/octet-stream"
"""Kind of a file's body: like JSON, no form of a foreign page can send it."""
FILE_BODY: dict[str, Any] = {
    "requestBody": {"required": True, "content": {FILE: {"schema": {"type": "string", "format": "binary"}}}}
}
"""The same in the OpenAPI document."""
FILES = frozenset({"/api/v1/new-venue/pictures", "/api/v1/calibration/pictures"})
MAX_BODIES = {
    "/api/v1/settings/import": 256 * 1024,
    **{f"/api/v1/calibration/mirror{path}": 2 * 1024 * 1024 for path in ("", "/pairs", "/around")},
    **dict.fromkeys(FILES, MAX_FILE_BYTES),
}
POLICY_VIOLATION = 1008
BEARER = "bearer "
HOW = "log in on the page, or send a token: `pslv token NAME` on the server makes one"


def cookie_name(scope: Scope) -> str:
    """Of the session; browsers send cookies to every port of a host, so the port is part of it."""
    server = scope.get("server")
    return f"pslv_session_{server[1] if server else 0}"


class Gate:
    """Middleware that lets through who may."""

    def __init__(
        self, app: ASGIApp, people: People, hosts: Sequence[str], viewers: str, operators: OperatorAddresses
    ) -> None:
        """hosts: further names of this server; viewers: "open" or "closed"; operators: is told their addresses."""
        self._app = app
        self._people = people
        self._hosts = hosts
        self._viewers_are_open = viewers == "open"
        self._operators = operators

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] not in ("http", "websocket"):
            await self._app(scope, receive, send)
            return
        headers = Headers(scope=scope)
        method = scope.get("method", "GET")
        refusal = self._foreign(headers, method, scope)
        if refusal is None:
            scope[SCOPE_KEY] = identity = await self._identity(headers, scope)
            if identity.role is Role.OPERATOR:
                self._operators.note(address_of(scope))
            refusal = self._forbidden(identity, need_of(method, scope["path"]))
        if refusal is None:
            await self._app(scope, receive, send)
        elif scope["type"] == "http":
            await problem_response(Request(scope), *refusal)(scope, receive, send)
        else:
            await send({"type": "websocket.close", "code": POLICY_VIOLATION, "reason": refusal[1][:120]})

    def _foreign(self, headers: Headers, method: str, scope: Scope) -> tuple[HTTPStatus, str] | None:
        """Why a request is refused whoever asks."""
        host = headers.get("host", "")
        if not is_our_name(host, self._hosts):
            accepted = "an IP address, localhost, this machine's name, or a name of server.hosts"
            return HTTPStatus.MISDIRECTED_REQUEST, f"a page at {cut(host)}; accepted: {accepted}"
        changes = method not in READING
        if not is_same_origin(headers.get("origin"), host):
            return HTTPStatus.FORBIDDEN, f"a page of {cut(headers['origin'])} may not do that here"
        return _wrong_body(headers, scope["path"]) if changes else None

    def _forbidden(self, identity: Identity, need: Need) -> tuple[HTTPStatus, str] | None:
        """Why somebody may not do what he asks for."""
        if need is Need.OPERATOR and identity.role is not Role.OPERATOR:
            if identity.is_known:
                return HTTPStatus.FORBIDDEN, f"{identity.name} may look; only the operator changes something: {HOW}"
            return HTTPStatus.UNAUTHORIZED, f"only the operator may do that: {HOW}"
        if self._viewers_are_open or need is Need.NOTHING:
            return None
        if not identity.is_known:
            return HTTPStatus.UNAUTHORIZED, f"viewers have to log in here: {HOW}"
        if identity.role is Role.TEAM and need is not Need.TEAM:
            return HTTPStatus.FORBIDDEN, "a team sees its own robots' views here"
        return None

    async def _identity(self, headers: Headers, scope: Scope) -> Identity:
        """Who asks, by the session of his browser or the token of his script."""
        authorization = headers.get("authorization", "")
        if authorization.lower().startswith(BEARER):
            secret = authorization[len(BEARER) :].strip()
            credential = Credential(secret, self._people.of_token, self._people.touch_token)
        else:
            secret = session_of(headers, cookie_name(scope))
            credential = Credential(secret, self._people.of_session, self._people.touch_session)
        identity = await credential.identity() if secret else None
        if identity is None:
            return ANYBODY
        scope[CREDENTIAL_KEY] = credential
        return identity


def session_of(headers: Headers, name: str) -> str:
    """The secret in a session's cookie; empty without one."""
    cookies: SimpleCookie = SimpleCookie()
    try:
        cookies.load(headers.get("cookie", ""))
    except CookieError:
        return ""
    return cookies[name].value if name in cookies else ""


def _wrong_body(headers: Headers, path: str) -> tuple[HTTPStatus, str] | None:
    """Why the body of a request that changes something is refused before it is read."""
    if "transfer-encoding" in headers:
        return HTTPStatus.LENGTH_REQUIRED, "the request has no Content-Length"
    length, most = headers.get("content-length", "0"), MAX_BODIES.get(path, MAX_BODY)
    if not length.isdecimal() or int(length[:20]) > most:
        return HTTPStatus.REQUEST_ENTITY_TOO_LARGE, f"the request is longer than {most} bytes"
    kind = headers.get("content-type", "").partition(";")[0].strip().lower()
    accepted = (JSON, FILE) if path in FILES else (JSON,)
    if length != "0" and kind not in accepted:
        words = " or ".join(accepted)
        return HTTPStatus.UNSUPPORTED_MEDIA_TYPE, f"content type {cut(kind) or 'is missing'}; accepted: {words}"
    return None
