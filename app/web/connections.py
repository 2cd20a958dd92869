"""What strangers can hold open: counted for each address and in all, timed, and less than what the process has.

An address from which the operator was heard finds room when strangers have taken all of theirs.
"""

import asyncio
import time
from collections import OrderedDict
from typing import Any

from uvicorn.protocols.http.h11_impl import H11Protocol

from app.web.auth.addresses import share_of

BACKLOG = 16
MAX_CONNECTIONS = 256
FOR_OPERATORS = 32
"""Of them, for addresses from which the operator was heard."""
PER_ADDRESS = 96
"""Connections of one address; an IPv6 network counts as one."""
REQUEST_S = 5.0
"""For a whole request, from the connection or its first byte on; from the operator's address, for its next byte: who
sends pictures over a slow network needs longer."""
IDLE_S = 75
"""A connection without a request is closed after this time."""
DESCRIPTORS = 1024
"""The process needs less for everything that it holds open."""
REMEMBERED, REMEMBERED_S = 64, 12 * 3600.0


class OperatorAddresses:
    """From where the operator was heard lately."""

    def __init__(self) -> None:
        self._heard_s: OrderedDict[str, float] = OrderedDict()

    def note(self, address: str) -> None:
        """The operator was heard from an address."""
        share = share_of(address)
        self._heard_s.pop(share, None)
        self._heard_s[share] = time.monotonic()
        if len(self._heard_s) > REMEMBERED:
            self._heard_s.popitem(last=False)

    def __contains__(self, address: object) -> bool:
        """Was the operator heard from there?"""
        return time.monotonic() - self._heard_s.get(share_of(str(address)), float("-inf")) < REMEMBERED_S


def guarded_protocol(operators: OperatorAddresses) -> type[H11Protocol]:
    """uvicorn's protocol for HTTP with these limits."""

    class GuardedProtocol(H11Protocol):
        """One connection."""

        _slow: asyncio.TimerHandle | None = None

        def connection_made(self, transport: asyncio.Transport) -> None:  # type: ignore[override]
            super().connection_made(transport)
            if has_room(self.client, self.connections, operators):
                self._start()
            else:
                transport.abort()

        def data_received(self, data: bytes) -> None:
            if not self.transport.is_closing():
                super().data_received(data)
                if self.client and self.client[0] in operators:
                    self._stop()
                self._watch()

        def on_response_complete(self) -> None:
            super().on_response_complete()
            self._watch()

        def connection_lost(self, exc: Exception | None) -> None:
            self._stop()
            super().connection_lost(exc)

        def _watch(self) -> None:
            """Time runs while a request has begun and is not whole."""
            state = str(self.conn.their_state)
            begun = state == "SEND_BODY" or (state == "IDLE" and bool(self.conn.trailing_data[0]))
            if not begun or self.transport.get_protocol() is not self:
                self._stop()
            elif self._slow is None:
                self._start()

        def _start(self) -> None:
            self._slow = self.loop.call_later(REQUEST_S, self.transport.abort)

        def _stop(self) -> None:
            if self._slow is not None:
                self._slow.cancel()
                self._slow = None

    return GuardedProtocol


def has_room(client: tuple[str, int] | None, connections: set[Any], operators: OperatorAddresses) -> bool:
    """May one more connection stay? It is among the connections already, with ``client`` as all others."""
    address = client[0] if client else "unknown"
    share = share_of(address)
    known = address in operators
    if len(connections) > MAX_CONNECTIONS - (0 if known else FOR_OPERATORS):
        return False
    held = sum(1 for each in connections if each.client and share_of(each.client[0]) == share)
    return held <= PER_ADDRESS
