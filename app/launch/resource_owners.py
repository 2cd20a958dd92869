"""The process that has a port, a device or a camera's lock. A process that we may not inspect is not found."""

import os
import socket
from collections.abc import Collection
from pathlib import Path

from vision_core.capture.devices import device_path
from vision_core.errors import ServiceError
from vision_core.net.unix_peers import process_and_user

PREFIX = "pslv-camera/"
"""Begins the names of the sockets that lock cameras."""
TCP_LISTENING, UDP_BOUND = "0A", "07"
BACKLOG = 64
PATIENCE_S = 0.5
MAX_COMMAND = 120


def port_holder(kind: str, port: int) -> str | None:
    """The process that has bound a port, "process 1234 (python -m app.main serve)"; None when none is found.

    kind: "tcp" or "udp".
    """
    sockets = {f"socket:[{inode}]" for inode in _inodes(kind, port)}
    return _first(_holders(sockets)) if sockets else None


def device_holder(path: str) -> str | None:
    """Another process that has a device open; None when none is found."""
    return _first(_holders({os.path.realpath(path)}) - {os.getpid()})


def lock_camera(device: str) -> socket.socket:
    """Hold a camera for this service until the socket is closed. device: as of ``device_path``.

    Raises SourceError when there is no such camera, and ServiceError naming the service that holds it. The lock is an
    abstract socket: it vanishes with its process.
    """
    path = os.path.realpath(device_path(device))
    lock = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
    try:
        lock.bind(f"\0{PREFIX}{path}")
        lock.listen(BACKLOG)
    except OSError as error:
        lock.close()
        holder = _lock_holder(path)
        found = f"{holder} holds it" if holder else error.strerror or str(error)
        raise ServiceError(f"camera {path}", found=found, accepted="a camera that no other service uses") from None
    return lock


def _lock_holder(path: str) -> str | None:
    """The process that holds a camera's lock."""
    with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as peer:
        peer.settimeout(PATIENCE_S)
        try:
            peer.connect(f"\0{PREFIX}{path}")
            process, _ = process_and_user(peer)
        except OSError:
            return None
    return _in_words(process)


def _inodes(kind: str, port: int) -> set[str]:
    """Inodes of the sockets of this machine that are bound to a port: listening ones, for TCP."""
    wanted = TCP_LISTENING if kind == "tcp" else UDP_BOUND
    found = set()
    for table in (kind, f"{kind}6"):
        try:
            lines = Path(f"/proc/net/{table}").read_text(encoding="ascii").splitlines()[1:]
        except OSError:
            continue
        for line in lines:
            fields = line.split()
            if int(fields[1].rpartition(":")[2], 16) == port and fields[3] == wanted:
                found.add(fields[9])
    return found


def _holders(targets: Collection[str]) -> set[int]:
    """Processes with a descriptor that leads to one of the targets."""
    return {int(entry.name) for entry in Path("/proc").iterdir() if entry.name.isdigit() and _holds(entry, targets)}


def _holds(process: Path, targets: Collection[str]) -> bool:
    try:
        return any(_target(descriptor) in targets for descriptor in (process / "fd").iterdir())
    except OSError:  # it has ended, or belongs to another user
        return False


def _target(descriptor: Path) -> str:
    """The target of a descriptor; empty when it was closed meanwhile."""
    try:
        return str(descriptor.readlink())
    except OSError:
        return ""


def _first(pids: set[int]) -> str | None:
    """The process from which the others inherited what they hold."""
    ancestors = [pid for pid in sorted(pids) if _parent(pid) not in pids]
    return _in_words(ancestors[0]) if ancestors else None


def _parent(pid: int) -> int:
    try:
        return int(Path(f"/proc/{pid}/stat").read_text(errors="replace").rpartition(")")[2].split()[1])
    except (OSError, IndexError):
        return 0


def _in_words(pid: int) -> str:
    """A process and its command."""
    try:
        words = Path(f"/proc/{pid}/cmdline").read_bytes().decode(errors="replace").rstrip("\0").split("\0")
    except OSError:
        words = [""]
    command = " ".join([Path(words[0]).name, *words[1:]])
    shown = "".join(letter if letter.isprintable() else "?" for letter in command)[:MAX_COMMAND]
    return f"process {pid} ({shown})" if shown else f"process {pid}"
