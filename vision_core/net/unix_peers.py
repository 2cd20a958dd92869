"""The process and user at the other end of a Unix socket, as the kernel reports them."""

import socket
import struct

_CREDENTIALS = struct.Struct("3i")


def process_and_user(peer: socket.socket) -> tuple[int, int]:
    """Process id and user id of the socket's other end; the process id is that of our own namespace."""
    credentials = peer.getsockopt(socket.SOL_SOCKET, socket.SO_PEERCRED, _CREDENTIALS.size)
    process, user, _group = _CREDENTIALS.unpack(credentials)
    return process, user
