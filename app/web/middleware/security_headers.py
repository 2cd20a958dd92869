"""Protection against foreign pages: headers on every answer, and a check of the origin of WebSockets."""

from urllib.parse import urlsplit, urlunsplit

from starlette.datastructures import MutableHeaders
from starlette.types import ASGIApp, Message, Receive, Scope, Send

HEADERS = {
    "Content-Security-Policy": (
        "default-src 'self'; object-src 'none'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
    ),
    "X-Content-Type-Options": "nosniff",
    "Referrer-Policy": "no-referrer",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Cache-Control": "no-cache",
}


class SecurityHeaders:
    """Middleware that adds HEADERS to every answer; a route may give one of them another value."""

    def __init__(self, app: ASGIApp) -> None:
        self._app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        async def send_with_headers(message: Message) -> None:
            if message["type"] == "http.response.start":
                headers = MutableHeaders(scope=message)
                for name, value in HEADERS.items():
                    headers.setdefault(name, value)
                if location := headers.get("location"):
                    headers["location"] = _relative(location)
            await send(message)

        await self._app(scope, receive, send_with_headers if scope["type"] == "http" else send)


def _relative(location: str) -> str:
    """A redirect stays on this host: it is told without a host, which a request could have made up."""
    parts = urlsplit(location)
    return urlunsplit(("", "", f"/{parts.path.lstrip('/')}", parts.query, parts.fragment))


def is_same_origin(origin: str | None, host: str | None) -> bool:
    """Does a request come from our own page, or from a program? Browsers send the page's origin, programs send none."""
    if origin is None:
        return True
    try:
        return host is not None and urlsplit(origin).netloc.lower() == host.lower()
    except ValueError:  # not a valid address
        return False
