"""viser's server, closed to everybody but our own relay.

viser listens without a login. So the function by which it opens its socket is wrapped while it starts: a connection
that does not bring the secret of this process is answered with 403. A test tries the door.
"""

import http
import logging
import secrets
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import rich
import viser
import websockets.asyncio.server
from websockets import Headers
from websockets.asyncio.server import ServerConnection, serve
from websockets.http11 import Request, Response

HOST = "127.0.0.1"
SECRET_HEADER = "X-PSLV-Secret"  # noqa: S105 (the name of a header)
_starting = threading.Lock()


class GuardedServer:
    """A viser server that only connections with its secret reach."""

    def __init__(self) -> None:
        self.secret = secrets.token_urlsafe(32)
        logging.getLogger("websockets.server").setLevel(logging.ERROR)
        with _starting, _guarded(self.secret):
            self.viser = viser.ViserServer(host=HOST, port=0, label="PSLV", verbose=False)

    @property
    def address(self) -> str:
        """Of its WebSocket."""
        return f"ws://{HOST}:{self.viser.get_port()}/"

    @property
    def protocol(self) -> str:
        """The WebSocket subprotocol that viser's page asks for."""
        return f"viser-v{viser.__version__}"

    def stop(self) -> None:
        """Close all connections and the socket."""
        self.viser.stop()


@contextmanager
def _guarded(secret: str) -> Iterator[None]:
    """While this holds, a server that viser starts asks for the secret, and viser prints nothing."""

    def judge(_connection: ServerConnection, request: Request) -> Response | None:
        if secrets.compare_digest(request.headers.get(SECRET_HEADER, "").encode(), secret.encode()):
            return None
        return Response(http.HTTPStatus.FORBIDDEN, "Forbidden", Headers())

    def guarded_serve(*arguments: Any, **options: Any) -> Any:
        return serve(*arguments, **{**options, "process_request": judge})

    with _replaced(websockets.asyncio.server, "serve", guarded_serve), _replaced(rich, "print", _ignore):
        yield


@contextmanager
def _replaced(module: object, name: str, value: object) -> Iterator[None]:
    """An attribute of a module has another value for a while."""
    before = getattr(module, name)
    setattr(module, name, value)
    try:
        yield
    finally:
        setattr(module, name, before)


def _ignore(*_words: object) -> None:
    """In place of printing."""
