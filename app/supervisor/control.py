"""The control socket: requests to look at the database, and requests to the supervisor.

An abstract Unix socket, which vanishes with the process. A connection carries one request and its answer, a line of
JSON each; the answer to {"do": "attach"} carries the database's descriptor. Only the same user and root are answered.
The supervisor never waits for a peer: a connection that takes longer than a second is closed.
"""

import contextlib
import json
import os
import socket
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any, TypeAlias

from vision_core.clock import NS_PER_S
from vision_core.errors import ServiceError
from vision_core.net.unix_peers import process_and_user

Answer: TypeAlias = tuple[dict[str, Any], tuple[int, ...]]
"""An answer's JSON object, and the descriptors that go with it."""
MAX_CONNECTIONS = 4
"""Open at the same time; more wait in the backlog."""
BACKLOG = 16
PATIENCE_S = 1.0
MAX_REQUEST = 4096


@dataclass(slots=True)
class _Connection:
    peer: socket.socket
    deadline: int
    received: bytes = b""


class ControlSocket:
    """Receives requests and sends answers, without ever waiting."""

    def __init__(self, name: str, answer: Callable[[object], Answer]) -> None:
        """answer: makes the answer to a request. Raises ServiceError when the name is taken."""
        self._answer = answer
        self._open: dict[int, _Connection] = {}
        self._listener = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
        self._listener.setblocking(False)
        try:
            self._listener.bind(f"\0{name}")
        except OSError as error:
            self._listener.close()
            raise ServiceError(
                f"control socket {name}", found=error.strerror or str(error), accepted="one service for each port"
            ) from None
        self._listener.listen(BACKLOG)

    def descriptors(self) -> Iterator[int]:
        """Descriptors to wait for: when one is readable, call ``serve``."""
        if len(self._open) < MAX_CONNECTIONS:
            yield self._listener.fileno()
        yield from self._open

    def serve(self, descriptor: int, now: int) -> None:
        """Accept or read from a readable descriptor; one that is not of this socket is ignored."""
        if descriptor == self._listener.fileno():
            self._accept(now)
        elif descriptor in self._open:
            self._receive(descriptor)

    def close_slow(self, now: int) -> None:
        """Close connections that have passed their deadline."""
        for descriptor in [fd for fd, connection in self._open.items() if now > connection.deadline]:
            self._open.pop(descriptor).peer.close()

    def close(self) -> None:
        """Close everything."""
        for connection in self._open.values():
            connection.peer.close()
        self._open.clear()
        self._listener.close()

    def _accept(self, now: int) -> None:
        try:
            peer, _ = self._listener.accept()
        except OSError:  # the peer has closed it already
            return
        peer.setblocking(False)
        if process_and_user(peer)[1] in (os.geteuid(), 0):
            self._open[peer.fileno()] = _Connection(peer, now + int(PATIENCE_S * NS_PER_S))
        else:
            peer.close()

    def _receive(self, descriptor: int) -> None:
        """Read from a connection; answer and close it when a whole line has come."""
        connection = self._open[descriptor]
        try:
            chunk = connection.peer.recv(MAX_REQUEST)
        except BlockingIOError:
            return
        except OSError:
            chunk = b""
        connection.received += chunk
        line, end, _ = connection.received.partition(b"\n")
        if chunk and not end and len(line) <= MAX_REQUEST:
            return
        if end:
            with contextlib.suppress(OSError):
                self._reply(connection.peer, line)
        self._open.pop(descriptor).peer.close()

    def _reply(self, peer: socket.socket, line: bytes) -> None:
        """Send the answer; what does not fit into the socket's buffer at once is lost."""
        table, descriptors = self._answer(_decoded(line))
        text = json.dumps(table).encode() + b"\n"
        socket.send_fds(peer, [text], descriptors)


def _decoded(line: bytes) -> object:
    """The request; None when it is not valid JSON."""
    try:
        return json.loads(line)
    except (ValueError, RecursionError):
        return None
