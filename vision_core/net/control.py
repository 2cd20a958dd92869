"""Looking at a running service from outside: the client side of its control socket.

The service listens at an abstract Unix socket, "pslv/<port of its page>", and answers its own user and root. A request
is a line of JSON; so is the answer, with the database's descriptor where that was asked for, to look at only.
"""

import contextlib
import errno
import json
import os
import select
import socket
from typing import Any

from vision_core.clock import Instant
from vision_core.errors import ServiceError
from vision_core.net.unix_peers import process_and_user
from vision_core.rtdb.layout import RecordSpec
from vision_core.rtdb.store import Store

PREFIX = "pslv/"
"""Of the names of services."""
PATIENCE_S = 2.0
CHUNK = 65536
MAX_ANSWER = 1 << 20
LISTENING = "00010000"
"""Flags of a socket in /proc/net/unix that waits for connections."""


class Attached:
    """A hold on a running service's database, to look at it."""

    def __init__(self, name: str, store: Store, pid: int, boot: Instant) -> None:
        self.name = name
        self.store = store
        self.pid = pid
        """Of the supervisor."""
        self.boot = boot
        self._supervisor = os.pidfd_open(pid)

    def runs(self) -> bool:
        """Does the service still run? What it has written stays readable when it does not."""
        return not select.select([self._supervisor], [], [], 0.0)[0]

    def close(self) -> None:
        """Let go of it; the store must not be used after."""
        self.store.close()
        os.close(self._supervisor)


def attach_to(name: str) -> Attached:
    """Map the database of a running service, "pslv/8000". Raises ServiceError."""
    told, descriptors, process = _ask(name, {"do": "attach"})
    try:
        store = Store([RecordSpec(**spec) for spec in told["records"]], descriptors[0], read_only=True)
        return Attached(name, store, process, Instant(told["boot"]))
    except (LookupError, TypeError, ValueError, OSError) as error:
        raise ServiceError(
            f"service {name}", found=f"an answer that is none: {error!r}", accepted="a service"
        ) from None
    finally:
        for descriptor in descriptors:
            os.close(descriptor)


def restart(name: str, process: str) -> None:
    """Have a service try a disabled process again. Raises ServiceError."""
    _, descriptors, _ = _ask(name, {"do": "restart", "name": process})
    for descriptor in descriptors:
        os.close(descriptor)


def running_services() -> list[str]:
    """The names of all services of this machine that answer us."""
    found = []
    for name in _listening():
        with contextlib.suppress(ServiceError):
            attach_to(name).close()
            found.append(name)
    return found


def _listening() -> list[str]:
    """Names of abstract sockets that may be services."""
    with open("/proc/net/unix", encoding="utf-8", errors="replace") as sockets:  # noqa: PTH123 (as light as attachment)
        lines = [line.split(maxsplit=7) for line in sockets]
    paths = {line[7].strip() for line in lines if len(line) == 8 and line[3] == LISTENING}
    return sorted(path[1:] for path in paths if path.startswith(f"@{PREFIX}"))


def _ask(name: str, request: dict[str, Any]) -> tuple[dict[str, Any], list[int], int]:
    """A service's answer, the descriptors that came with it, its process. Raises ServiceError, also when refused."""
    asked = f"{request['do']} {request.get('name', '')}".strip() + f" at service {name}"
    try:
        text, descriptors, process = _exchange(name, json.dumps(request).encode() + b"\n")
    except (OSError, ValueError) as error:
        found = getattr(error, "strerror", None) or str(error)
        accepted = ", ".join(_listening()) or "a service that runs, and none does: pslv serve"
        raise ServiceError(asked, found=found, accepted=accepted) from None
    try:
        told = json.loads(text)
        if not isinstance(told, dict):
            raise ValueError
    except ValueError:
        told = {"error": "no answer", "accepted": "the service's own user, or root"}
    if "error" in told:
        for descriptor in descriptors:
            os.close(descriptor)
        raise ServiceError(asked, found=str(told["error"]), accepted=str(told.get("accepted", "")))
    return told, descriptors, process


def _exchange(name: str, request: bytes) -> tuple[bytes, list[int], int]:
    """Say a line, and hear one, from which process. Raises OSError."""
    with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as peer:
        peer.settimeout(PATIENCE_S)
        peer.connect(f"\0{name}")
        process, user = process_and_user(peer)
        if user not in (os.geteuid(), 0) and os.geteuid() != 0:
            raise PermissionError(errno.EPERM, "it is another user's")
        peer.sendall(request)
        text, descriptors, _, _ = socket.recv_fds(peer, CHUNK, 1)
        while text and not text.endswith(b"\n") and len(text) < MAX_ANSWER:
            more = peer.recv(CHUNK)
            if not more:
                break
            text += more
    return text, descriptors, process
