"""Ends WebSockets, whatever state they are in."""

import contextlib

from starlette.websockets import WebSocket, WebSocketDisconnect

MAX_REASON = 123
"""Bytes; a frame that closes a WebSocket has no room for more."""


async def close(page: WebSocket, code: int, reason: str = "") -> None:
    """End a connection, and say why. It never raises: the page may have left, or the connection may have broken."""
    with contextlib.suppress(RuntimeError, WebSocketDisconnect, OSError):
        await page.close(code, short(reason))


def short(reason: str) -> str:
    """A reason that fits into the frame; characters may have several bytes."""
    return reason.encode("utf-8", "replace")[:MAX_REASON].decode("utf-8", "ignore")
