"""Answers init with ``(error not_ready)`` while no server answers. Standard library only.

It looks at the first bytes of a datagram and parses nothing: whatever an attacker sends costs the same few
microseconds. An answer is never longer than three times its request, a client's socket gets at most one a second, and
all together get at most MAX_CLIENTS a second.
"""

import re
from collections import OrderedDict

from vision_core.clock import NS_PER_S, Instant
from vision_core.net.udp import Address, SharedSocket
from vision_core.protocol.error_codes import ErrorCode
from vision_core.protocol.rate_limits import AMPLIFICATION

NOT_READY = f"(error {ErrorCode.NOT_READY})".encode("ascii")
MAX_HEAD = 64
"""Bytes of a datagram that are looked at."""
MAX_DATAGRAMS = 64
"""Handled by one call."""
ANSWER_PERIOD_S = 1.0
"""Between two answers to one client's socket: each robot has one, and several robots share a computer."""
MAX_CLIENTS = 256
"""Clients that are remembered for a second. While the table is full, others get no answer."""

_INIT = re.compile(rb"\s*+\(\s*+init[\s(]", re.IGNORECASE)


class NotReadyResponder:
    """Answers on the server's unconnected sockets in place of the server."""

    def __init__(self, shared: list[SharedSocket]) -> None:
        self._shared = shared
        self._answered_at: OrderedDict[Address, Instant] = OrderedDict()
        """When each client was answered last, the oldest first."""

    def answer_pending(self, now: Instant) -> int:
        """Read at most 64 datagrams of each socket and answer the inits among them; returns the number of answers."""
        answers = 0
        for shared in self._shared:
            for _ in range(MAX_DATAGRAMS):
                datagram = shared.receive()
                if datagram is None:
                    break
                if _INIT.match(datagram.data[:MAX_HEAD]) and self._may_answer(datagram.peer, now):
                    end = b"\0" if datagram.data.endswith(b"\0") else b""
                    if len(NOT_READY + end) <= AMPLIFICATION * len(datagram.data):
                        shared.send(NOT_READY + end, datagram.peer, datagram.local)
                        answers += 1
        return answers

    def _may_answer(self, client: Address, now: Instant) -> bool:
        while self._answered_at and now - next(iter(self._answered_at.values())) >= ANSWER_PERIOD_S * NS_PER_S:
            self._answered_at.popitem(last=False)
        if client in self._answered_at or len(self._answered_at) >= MAX_CLIENTS:
            return False
        self._answered_at[client] = now
        return True
