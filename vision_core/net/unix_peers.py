"""Who is at the other end of a Unix socket, as the kernel tells."""

import socket
import struct

_CREDENTIALS = struct.Struct("3i")


def process_and_user(peer: socket.socket) -> tuple[int, int]:
    """Process and user of who connected, or of who listens; process numbers as they are seen from here."""
    told = peer.getsockopt(socket.SOL_SOCKET, socket.SO_PEERCRED, _CREDENTIALS.size)
    process, user, _group = _CREDENTIALS.unpack(told)
    return process, user
