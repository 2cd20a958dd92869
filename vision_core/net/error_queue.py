"""What the network reports of a socket's datagrams: ICMP, and a local network that finds nobody at an address.

Without IP_RECVERR Linux reports a closed port only, not that a computer does not exist (ip(7)). With it every report
waits in the socket's error queue, and makes the socket readable, until it is read.
"""

import contextlib
import socket
import struct

IP_RECVERR, IPV6_RECVERR, MSG_ERRQUEUE = 11, 25, 0x2000
"""Linux's numbers; the socket module does not name the first two in every version."""
SWITCHES = ((socket.IPPROTO_IP, IP_RECVERR), (socket.IPPROTO_IPV6, IPV6_RECVERR))
ERROR = struct.Struct("=I")
"""The first word of ``struct sock_extended_err``: an errno."""
SPACE = socket.CMSG_SPACE(64) + socket.CMSG_SPACE(64)
"""For the error with the address of who reports it, and for a time stamp [bytes]."""
AT_ONCE = 64
"""Reports read by one call."""


def report_errors(opened: socket.socket) -> None:
    """Have the kernel report every error of a socket; where it cannot, closed ports are reported as ever."""
    for level, option in SWITCHES:
        with contextlib.suppress(OSError):  # the other family's
            opened.setsockopt(level, option, 1)


def reported_errors(opened: socket.socket) -> frozenset[int]:
    """Read the reports that wait; returns their errnos."""
    found = set()
    with contextlib.suppress(OSError):  # no more of them
        for _ in range(AT_ONCE):
            _, ancillary, _, _ = opened.recvmsg(0, SPACE, MSG_ERRQUEUE)
            found |= {ERROR.unpack_from(content)[0] for level, kind, content in ancillary if (level, kind) in SWITCHES}
    return frozenset(found)
