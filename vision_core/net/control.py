"""The client side of a service's control socket: read its database, restart a process or all of it.

The service "pslv/<port of its page>" listens at a Unix socket in a folder that only its own user and root can enter:
see ``control_files``. A request is one line of JSON, and so is the answer; the answer to "attach" also passes a
read-only descriptor of the database.
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
from vision_core.net.control_files import names, paths_of
from vision_core.net.unix_peers import process_and_user
from vision_core.rtdb.layout import RecordSpec
from vision_core.rtdb.store import Store

TIMEOUT_S = 2.0
"""For each step of an exchange."""
CHUNK = 65536
MAX_ANSWER = 1 << 20


class Attached:
    """Read access to the database of a running service."""

    def __init__(self, name: str, store: Store, pid: int, boot: Instant) -> None:
        self.name = name
        self.store = store
        self.pid = pid
        """Process id of the supervisor."""
        self.boot = boot
        self._supervisor = os.pidfd_open(pid)

    def runs(self) -> bool:
        """Does the service still run? If not, its records stay readable."""
        return not select.select([self._supervisor], [], [], 0.0)[0]

    def close(self) -> None:
        """End the access; the store must not be used afterwards."""
        self.store.close()
        os.close(self._supervisor)


def attach_to(name: str) -> Attached:
    """Map the database of a running service, "pslv/8000". Raises ServiceError."""
    answer, descriptors, process = _ask(name, {"do": "attach"})
    try:
        store = Store([RecordSpec(**spec) for spec in answer["records"]], descriptors[0], read_only=True)
        return Attached(name, store, process, Instant(answer["boot"]))
    except (LookupError, TypeError, ValueError, OSError) as error:
        raise ServiceError(
            f"service {name}", found=f"an answer that cannot be read: {error!r}", accepted="a service of this version"
        ) from None
    finally:
        for descriptor in descriptors:
            os.close(descriptor)


def restart(name: str, process: str) -> None:
    """Start a disabled process of a service again. Raises ServiceError."""
    _ask(name, {"do": "restart", "name": process})


def restart_service(name: str) -> None:
    """Ask for a restart of a whole service; its record ``processes`` says what becomes of it. Raises ServiceError."""
    _ask(name, {"do": "restart"})


def running_services() -> list[str]:
    """Names of all services of this machine that answer this user."""
    found = []
    for name in names():
        with contextlib.suppress(ServiceError):
            attach_to(name).close()
            found.append(name)
    return found


def _accepting() -> list[str]:
    """Names of the services that accept a connection."""
    found = []
    for name in names():
        with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as peer, contextlib.suppress(OSError):
            peer.setblocking(False)
            _connect(peer, name)
            found.append(name)
    return found


def _connect(peer: socket.socket, name: str) -> None:
    """Raises OSError when no service of this name listens, ValueError for what cannot be a name."""
    paths = paths_of(name)
    if not paths:
        raise FileNotFoundError(errno.ENOENT, "it does not run, or it belongs to another user")
    for path in paths[:-1]:
        with contextlib.suppress(OSError):
            return peer.connect(str(path))
    return peer.connect(str(paths[-1]))


def _ask(name: str, request: dict[str, Any]) -> tuple[dict[str, Any], list[int], int]:
    """A service's answer, the descriptors passed with it, its process id. Raises ServiceError, also if refused."""
    asked = f"{request['do']} {request.get('name', '')}".strip() + f" at service {name}"
    try:
        text, descriptors, process = _exchange(name, json.dumps(request).encode() + b"\n")
    except (OSError, ValueError) as error:
        found = getattr(error, "strerror", None) or str(error)
        accepted = ", ".join(_accepting()) or "a running service; none runs now: pslv serve"
        raise ServiceError(asked, found=found, accepted=accepted) from None
    try:
        answer = json.loads(text)
        if not isinstance(answer, dict):
            raise ValueError
    except ValueError:
        answer = {"error": "no answer", "accepted": "the service's own user, or root"}
    if "error" in answer:
        for descriptor in descriptors:
            os.close(descriptor)
        raise ServiceError(asked, found=str(answer["error"]), accepted=str(answer.get("accepted", "")))
    return answer, descriptors, process


def _exchange(name: str, request: bytes) -> tuple[bytes, list[int], int]:
    """Send a line; returns the line received, the descriptors passed with it, and the process id. Raises OSError."""
    with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as peer:
        peer.settimeout(TIMEOUT_S)
        _connect(peer, name)
        process, user = process_and_user(peer)
        if user not in (os.geteuid(), 0) and os.geteuid() != 0:
            raise PermissionError(errno.EPERM, "it belongs to another user")
        peer.sendall(request)
        text, descriptors, _, _ = socket.recv_fds(peer, CHUNK, 1)
        while text and not text.endswith(b"\n") and len(text) < MAX_ANSWER:
            more = peer.recv(CHUNK)
            if not more:
                break
            text += more
    return text, descriptors, process
