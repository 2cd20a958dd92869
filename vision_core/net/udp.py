"""UDP sockets of the server: standard library only, no protocol. No call blocks."""

import contextlib
import errno
import socket
import struct
from collections.abc import Iterator
from dataclasses import dataclass
from enum import Enum
from typing import TypeAlias

from vision_core.arrival_stamps import STAMP_SPACE, age_ns, stamp_arrivals
from vision_core.errors import ServiceError
from vision_core.net.error_queue import report_errors, reported_errors
from vision_core.net.kernel_filter import attach_filter, drop_all, dropped

Address: TypeAlias = tuple[str, int, int]
"""Host, port, and the scope of an IPv6 link-local address (0 elsewhere)."""

MAX_RECEIVED = 2048
"""A longer datagram is cut off; it is over every limit anyway [bytes]."""
SHARED_BUFFER = 1 << 20
"""Receive buffer of an unconnected socket [bytes]: a flood shall not push out another client's init."""
SEND_BUFFER = 16384
"""Send buffer of a session [bytes]: a few views. Older ones are of no use to the client."""
DEFAULT_HOPS = -1
"""The system's number of routers that a datagram may pass (ip(7), ipv6(7))."""
DSCP_EF = 46 << 2
"""Expedited forwarding (RFC 3246), as the TOS byte."""
TAKEN = "another program has it"
ANY_PORT_ATTEMPTS = 50
IP_PKTINFO = getattr(socket, "IP_PKTINFO", 8)
"""Linux's number, for Python versions whose socket module does not name it."""
IN_PKTINFO = struct.Struct("=i4s4s")
IN6_PKTINFO = struct.Struct("=16si")
ANCILLARY = socket.CMSG_SPACE(IN6_PKTINFO.size) + STAMP_SPACE


class SendResult(Enum):
    """The result of sending a datagram."""

    SENT = "sent"
    DROPPED = "dropped"
    """The buffer is full or the network is down: the datagram is lost, the session stays."""
    REFUSED = "refused"
    """The client's computer reports a closed port."""
    UNREACHABLE = "unreachable"
    """The network reports that no computer has the client's address."""


@dataclass(frozen=True, slots=True)
class Datagram:
    """A datagram that was received."""

    data: bytes
    peer: Address
    local: str
    """Our address that it was sent to."""
    age_ns: int = 0
    """How long ago it arrived."""


def open_server_sockets(host: str, udp_port: int, session_port: int) -> tuple[socket.socket, socket.socket]:
    """The main socket and the unconnected one of the session port, bound and non-blocking.

    session_port 0: udp_port + 1; udp_port 0: any free pair. Raises ServiceError when they cannot be opened.
    """
    if udp_port == 65535 and session_port == 0:
        raise ServiceError("a session port of udp_port + 1", found="udp_port 65535", accepted="udp_port below 65535")
    if udp_port or session_port:
        main = _open_shared(host, udp_port)
        return main, _open_second(main, host, session_port or udp_port + 1)
    for _ in range(ANY_PORT_ATTEMPTS):
        main = _open_shared(host, 0)
        with contextlib.suppress(ServiceError):
            return main, _open_second(main, host, min(main.getsockname()[1] + 1, 65535))
    raise ServiceError(f"two UDP ports on {host or 'all addresses'}", found="none free", accepted="a free pair")


def open_sink() -> socket.socket:
    """A socket on loopback that is connected to itself and drops whatever it is sent."""
    sink = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    sink.setblocking(False)
    drop_all(sink)
    sink.bind(("127.0.0.1", 0))
    sink.connect(sink.getsockname())
    return sink


def adopted(descriptor: int) -> socket.socket:
    """The socket of a descriptor that the supervisor has passed on to this process."""
    return socket.socket(fileno=descriptor)


class SharedSocket:
    """An unconnected socket: it receives from every sender."""

    def __init__(self, bound: socket.socket) -> None:
        self._socket = bound
        self._sessions: set[SessionSocket] = set()
        self._local = str(bound.getsockname()[0])
        self._wildcard = self._local in ("0.0.0.0", "::")  # noqa: S104 (compared, not bound)

    def fileno(self) -> int:
        """The socket's descriptor."""
        return self._socket.fileno()

    @property
    def socket(self) -> socket.socket:
        """The socket itself."""
        return self._socket

    def receive(self) -> Datagram | None:
        """The next datagram; None when there is none, or the network has reported an error."""
        try:
            data, ancillary, _, source = self._socket.recvmsg(MAX_RECEIVED, ANCILLARY)
        except OSError:
            return None
        return Datagram(data, _address(source), self._local_address(ancillary), age_ns(ancillary))

    def send(self, data: bytes, peer: Address, local: str) -> SendResult:
        """Send to a client, from our address that its request was sent to."""
        ancillary = _source_address(self._socket.family, local) if self._wildcard else []
        try:
            self._socket.sendmsg([data], ancillary, 0, _sockaddr(self._socket.family, peer))
        except OSError:
            return SendResult.DROPPED
        return SendResult.SENT

    @property
    def dropped(self) -> int:
        """Datagrams that the kernel has dropped: see ``kernel_filter``."""
        return dropped(self._socket)

    def open_session(self, local: str, peer: Address) -> "SessionSocket":
        """A socket on the same port that is connected to a client. local: our address that the client knows.

        Raises OSError when the system has no socket left, or the address is not ours.
        """
        opened = SessionSocket(self._socket.family, self._sessions)
        own = (local, self._socket.getsockname()[1], peer[2])
        with self._shared_by(opened):
            opened.connect(own, peer)
        self._sessions.add(opened)
        return opened

    @contextlib.contextmanager
    def _shared_by(self, opened: "SessionSocket") -> Iterator[None]:
        """Let a new socket of ours bind to this port. No other program can: sharing is on only for this moment.

        Linux lets two UDP sockets have a port if SO_REUSEADDR is set on both. A socket whose flag is cleared
        afterwards keeps its place, and a program that comes later is told that the port is in use.
        """
        sockets = (self._socket, opened.socket, *(session.socket for session in self._sessions))
        try:
            for one in sockets:
                one.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            yield
        except OSError:
            opened.close()
            raise
        finally:
            for one in sockets:
                if one.fileno() >= 0:
                    one.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 0)

    def _local_address(self, ancillary: list[tuple[int, int, bytes]]) -> str:
        for level, kind, content in ancillary:
            if (level, kind) == (socket.IPPROTO_IP, IP_PKTINFO) and len(content) >= IN_PKTINFO.size:
                return socket.inet_ntoa(IN_PKTINFO.unpack_from(content)[2])
            if (level, kind) == (socket.IPPROTO_IPV6, socket.IPV6_PKTINFO) and len(content) >= IN6_PKTINFO.size:
                return socket.inet_ntop(socket.AF_INET6, IN6_PKTINFO.unpack_from(content)[0])
        return self._local


class SessionSocket:
    """A socket of one session: on one of the server's ports, connected to the client.

    Between bind and connect it may receive a datagram of another sender; so every datagram names its sender.
    ``SharedSocket.open_session`` makes it.
    """

    def __init__(self, family: int, siblings: "set[SessionSocket]") -> None:
        """siblings: the open sessions' sockets of its port; it leaves them when it is closed."""
        self._siblings = siblings
        self._local = ""
        self.socket = socket.socket(family, socket.SOCK_DGRAM)
        """The socket itself."""

    def connect(self, own: Address, peer: Address) -> None:
        """Bind to an address and port of ours, and connect to the client. Raises OSError."""
        self._local = own[0]
        self.socket.setblocking(False)
        self.socket.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, SEND_BUFFER)
        _request_low_delay(self.socket)
        stamp_arrivals(self.socket)
        report_errors(self.socket)
        self.socket.bind(_sockaddr(self.socket.family, own))
        self.socket.connect(_sockaddr(self.socket.family, peer))

    def fileno(self) -> int:
        """The socket's descriptor."""
        return self.socket.fileno()

    def stay_local(self, local: bool) -> None:
        """Let datagrams end at the first router, or not."""
        hops = 1 if local else DEFAULT_HOPS
        if self.socket.family == socket.AF_INET6:
            self.socket.setsockopt(socket.IPPROTO_IPV6, socket.IPV6_UNICAST_HOPS, hops)
        else:
            self.socket.setsockopt(socket.IPPROTO_IP, socket.IP_TTL, hops)

    def close(self) -> None:
        """Close the socket."""
        self._siblings.discard(self)
        self.socket.close()

    def send(self, data: bytes) -> SendResult:
        """Send to the client, without waiting."""
        try:
            self.socket.send(data)
        except ConnectionRefusedError:
            return SendResult.REFUSED
        except OSError:  # EWOULDBLOCK, ENOBUFS, ENETUNREACH, EHOSTUNREACH, ENETDOWN; EINVAL: our address is gone
            return SendResult.DROPPED
        return SendResult.SENT

    def receive(self) -> Datagram | SendResult | None:
        """The next datagram; REFUSED or UNREACHABLE when the network reports that; None when there is nothing."""
        try:
            data, ancillary, _, source = self.socket.recvmsg(MAX_RECEIVED, STAMP_SPACE)
        except OSError as error:
            reported = {error.errno, *reported_errors(self.socket)}
            if errno.ECONNREFUSED in reported:
                return SendResult.REFUSED
            return SendResult.UNREACHABLE if errno.EHOSTUNREACH in reported else None
        return Datagram(data, _address(source), self._local, age_ns(ancillary))


def _open_shared(host: str, port: int) -> socket.socket:
    family, sockaddr = _resolved(host, port)
    opened = socket.socket(family, socket.SOCK_DGRAM)
    try:
        opened.setblocking(False)
        opened.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, SHARED_BUFFER)
        _report_local_address(opened)
        _request_low_delay(opened)
        stamp_arrivals(opened)
        attach_filter(opened)
        opened.bind(sockaddr)
    except OSError as error:
        opened.close()
        raise _no_port(host, port, error) from None
    return opened


def _open_second(main: socket.socket, host: str, port: int) -> socket.socket:
    try:
        return _open_shared(host, port)
    except ServiceError:
        main.close()
        raise


def _resolved(host: str, port: int) -> tuple[int, tuple[str | int, ...]]:
    try:
        found = socket.getaddrinfo(host or None, port, type=socket.SOCK_DGRAM, flags=socket.AI_PASSIVE)
    except (OSError, ValueError) as error:  # ValueError: no legal host name
        raise ServiceError(f"UDP address {host!r}", found=str(error), accepted="an address of this machine") from None
    family, _, _, _, sockaddr = min(found, key=lambda info: info[0] != socket.AF_INET)
    return family, (str(sockaddr[0]), *(int(part) for part in sockaddr[1:]))


def _no_port(host: str, port: int, error: OSError) -> ServiceError:
    accepted = "a port above 1023, or the right to open this one" if error.errno == errno.EACCES else "a free port"
    if error.errno == errno.EADDRNOTAVAIL:
        accepted = "an address of this machine"
    found = TAKEN if error.errno == errno.EADDRINUSE else error.strerror or str(error)
    return ServiceError(f"UDP port {port} of {host or 'all addresses'}", found=found, accepted=accepted)


def _report_local_address(opened: socket.socket) -> None:
    """Have the kernel say which of our addresses each datagram was sent to."""
    if opened.family == socket.AF_INET6:
        opened.setsockopt(socket.IPPROTO_IPV6, socket.IPV6_RECVPKTINFO, 1)
    else:
        opened.setsockopt(socket.IPPROTO_IP, IP_PKTINFO, 1)


def _request_low_delay(opened: socket.socket) -> None:
    """Ask the network for low delay; not every network grants it."""
    with contextlib.suppress(OSError):
        if opened.family == socket.AF_INET6:
            opened.setsockopt(socket.IPPROTO_IPV6, socket.IPV6_TCLASS, DSCP_EF)
        else:
            opened.setsockopt(socket.IPPROTO_IP, socket.IP_TOS, DSCP_EF)


def _address(source: tuple[str | int, ...]) -> Address:
    return str(source[0]), int(source[1]), int(source[3]) if len(source) == 4 else 0


def _sockaddr(family: int, address: Address) -> tuple[str | int, ...]:
    host, port, scope = address
    return (host, port, 0, scope) if family == socket.AF_INET6 else (host, port)


def _source_address(family: int, local: str) -> list[tuple[int, int, bytes]]:
    if family == socket.AF_INET6:
        content = IN6_PKTINFO.pack(socket.inet_pton(socket.AF_INET6, local), 0)
        return [(socket.IPPROTO_IPV6, socket.IPV6_PKTINFO, content)]
    content = IN_PKTINFO.pack(0, socket.inet_aton(local), bytes(4))
    return [(socket.IPPROTO_IP, IP_PKTINFO, content)]
