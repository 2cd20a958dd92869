"""The control socket: requests to look at the database, and requests to the supervisor.

A Unix socket in a folder that only the same user and root can enter: the supervisor runs above all tasks, so nothing
that a stranger does may occupy it. A connection carries one request and its answer, a line of JSON each; the answer to
{"do": "attach"} carries the database's descriptor. The supervisor never waits for a peer: a connection that takes
longer than a second is closed, and of more than MAX_PER_S connections in a second the others wait.
"""

import contextlib
import json
import os
import socket
from collections import deque
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeAlias

from vision_core.clock import NS_PER_S
from vision_core.errors import ServiceError
from vision_core.net.control_files import path_for
from vision_core.net.unix_peers import process_and_user

Answer: TypeAlias = tuple[dict[str, Any], tuple[int, ...]]
"""An answer's JSON object, and the descriptors that go with it."""
MAX_CONNECTIONS = 4
"""Open at the same time; more wait in the backlog."""
MAX_PER_S = 50
"""Connections that are accepted in a second."""
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
        self._accepted: deque[int] = deque(maxlen=MAX_PER_S)
        """When the newest connections were accepted [ns]."""
        self._listener = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
        self._listener.setblocking(False)
        try:
            self._path = path_for(name)
            for path in self._path.parent.glob(f"*{self._path.suffix}"):
                _remove_abandoned(path)
            self._listener.bind(str(self._path))
            self._listener.listen(BACKLOG)
        except OSError as error:
            self._listener.close()
            raise ServiceError(
                f"control socket {name}", found=error.strerror or str(error), accepted="one service for each port"
            ) from None

    def descriptors(self, now: int) -> Iterator[int]:
        """Descriptors to wait for at an instant: when one is readable, call ``serve``."""
        is_calm = len(self._accepted) < MAX_PER_S or now - self._accepted[0] > NS_PER_S
        if is_calm and len(self._open) < MAX_CONNECTIONS:
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
        self._path.unlink(missing_ok=True)

    def _accept(self, now: int) -> None:
        try:
            peer, _ = self._listener.accept()
        except OSError:  # the peer has closed it already
            return
        self._accepted.append(now)
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


def _remove_abandoned(path: Path) -> None:
    """Delete the socket of a service that was killed; one that is listened at stays."""
    with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as peer:
        peer.setblocking(False)
        try:
            peer.connect(str(path))
        except ConnectionRefusedError:
            path.unlink(missing_ok=True)
        except OSError:
            return


def _decoded(line: bytes) -> object:
    """The request; None when it is not valid JSON."""
    try:
        return json.loads(line)
    except (ValueError, RecursionError):
        return None
