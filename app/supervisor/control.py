"""The socket for requests: who may look at the database, and what is asked of the supervisor.

An abstract Unix socket, which vanishes with the process. A connection carries one request and its answer, a line of
JSON each; the answer to {"do": "attach"} brings the database's descriptor with it. Only the same user and root are
answered, and nobody can make the supervisor wait: what is not said within a second is not heard.
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
"""A table to tell, and descriptors to send along."""
MAX_CONNECTIONS = 4
"""That are heard at the same time; others wait for their turn."""
BACKLOG = 16
PATIENCE_S = 1.0
MAX_REQUEST = 4096


@dataclass(slots=True)
class _Connection:
    peer: socket.socket
    deadline: int
    heard: bytes = b""


class ControlSocket:
    """Listens for requests and has them answered, without ever waiting."""

    def __init__(self, name: str, answer: Callable[[object], Answer]) -> None:
        """answer: what to say to a request. Raises ServiceError when the name is taken."""
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
        """What to wait for: readable means that ``serve`` has something to do."""
        if len(self._open) < MAX_CONNECTIONS:
            yield self._listener.fileno()
        yield from self._open

    def serve(self, descriptor: int, now: int) -> None:
        """Go on with what a descriptor has to say; one that is none of ours is left alone."""
        if descriptor == self._listener.fileno():
            self._accept(now)
        elif descriptor in self._open:
            self._hear(descriptor)

    def hang_up(self, now: int) -> None:
        """Close connections that have taken too long."""
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
        except OSError:  # it has changed its mind
            return
        peer.setblocking(False)
        if process_and_user(peer)[1] in (os.geteuid(), 0):
            self._open[peer.fileno()] = _Connection(peer, now + int(PATIENCE_S * NS_PER_S))
        else:
            peer.close()

    def _hear(self, descriptor: int) -> None:
        """Take what was said; answer when it is a whole line."""
        connection = self._open[descriptor]
        try:
            said = connection.peer.recv(MAX_REQUEST)
        except BlockingIOError:
            return
        except OSError:
            said = b""
        connection.heard += said
        line, end, _ = connection.heard.partition(b"\n")
        if said and not end and len(line) <= MAX_REQUEST:
            return
        if end:
            with contextlib.suppress(OSError):
                self._reply(connection.peer, line)
        self._open.pop(descriptor).peer.close()

    def _reply(self, peer: socket.socket, line: bytes) -> None:
        """What does not fit into the socket's buffer at once is lost: nobody is waited for."""
        table, descriptors = self._answer(_decoded(line))
        text = json.dumps(table).encode() + b"\n"
        socket.send_fds(peer, [text], descriptors)


def _decoded(line: bytes) -> object:
    """A request; None when it is none."""
    try:
        return json.loads(line)
    except (ValueError, RecursionError):
        return None
