"""When a datagram arrived, as Linux stamps it (SO_TIMESTAMPNS).

The stamp is of the time of day. It is turned into an age at once, so that a step of the time of day between two
datagrams does no harm. Under load a program reads a datagram milliseconds after it arrived; the stamp does not wait.
"""

import contextlib
import socket
import struct
import sys
import time
from collections.abc import Sequence

from vision_core.clock import NS_PER_S

SO_TIMESTAMPNS = getattr(socket, "SO_TIMESTAMPNS", 35)
"""Linux's number, for Python versions whose socket module does not name it."""
TIMESPEC = struct.Struct("@ll")
STAMP_SPACE = socket.CMSG_SPACE(TIMESPEC.size) if hasattr(socket, "CMSG_SPACE") else 0
"""Room for the stamp in the ancillary data of ``recvmsg`` [bytes]."""
MAX_AGE_NS = 10 * NS_PER_S
"""An older stamp is taken for a step of the time of day."""


def stamp_arrivals(datagrams: socket.socket) -> None:
    """Have the system note when each datagram arrives, where it can."""
    if sys.platform == "linux":
        with contextlib.suppress(OSError):
            datagrams.setsockopt(socket.SOL_SOCKET, SO_TIMESTAMPNS, 1)


def age_ns(ancillary: Sequence[tuple[int, int, bytes]]) -> int:
    """How long ago a datagram arrived [ns], from the ancillary data of ``recvmsg``; 0 if it has no stamp."""
    for level, kind, content in ancillary:
        if (level, kind, len(content)) == (socket.SOL_SOCKET, SO_TIMESTAMPNS, TIMESPEC.size):
            seconds, ns = TIMESPEC.unpack(content)
            age = time.time_ns() - (seconds * NS_PER_S + ns)
            return age if 0 <= age <= MAX_AGE_NS else 0
    return 0
