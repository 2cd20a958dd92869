"""Helper process: the clients of both teams, each with its own socket.

    python -m bench.receiver UDP_PORT CLIENTS_PER_TEAM        until standard input ends

Every client sends one init message, with (time us), and never reconnects, whatever happens to the service. The
arrival of a datagram is the instant at which the kernel put it into the client's socket. Prints JSON:

    {"policy", "clients", "ports", "disordered", "errors", "views"}

"ports" are the server's ports from which views came; "disordered" counts the views whose Time is not greater than that
of the client's previous view; "errors" are all messages that are no views. "views" is [[time_us, clients, first_ns,
last_ns], ...]: for each Time the number of clients that received its view, and the first and the last arrival [ns of
CLOCK_MONOTONIC].
"""

import contextlib
import json
import select
import socket
import sys
import time
from collections.abc import Iterator

from bench.helpers import OBSERVER_PRIORITY, READY, has_stdin_ended, request_realtime
from vision_core.arrival_stamps import SO_TIMESTAMPNS, TIMESPEC, stamp_arrivals
from vision_core.clock import NS_PER_S
from vision_core.protocol.encoding import encode
from vision_core.protocol.messages import Init
from vision_core.protocol.options import Options
from vision_core.types.objects import Team

LOOPBACK = "127.0.0.1"
REPLY_TIMEOUT_S = 5.0
MAX_DATAGRAM = 4096
ANCILLARY = socket.CMSG_SPACE(TIMESPEC.size)
POLL_TIMEOUT_S = 0.1
"""Longest time between two checks of standard input."""
SEE = b"(see "
BUFFER_BYTES = 1 << 20
"""Size of each socket's receive buffer."""


class Receiver:
    """The clients of both teams."""

    def __init__(self, udp_port: int, per_team: int) -> None:
        """Connect all clients. Raises RuntimeError when the server does not accept one."""
        self.views: dict[int, list[int]] = {}
        """Time [us] -> number of clients, first and last arrival [ns]."""
        self.ports: set[int] = set()
        self.disordered = 0
        self.errors: list[str] = []
        self._poller = select.epoll()
        self._sockets: dict[int, socket.socket] = {}
        self._newest: dict[int, int] = {}
        for team in Team:
            for number in range(1, per_team + 1):
                self._connect(udp_port, Init(team, number, Options(time="us")))

    @property
    def clients(self) -> int:
        """Number of clients."""
        return len(self._sockets)

    def _connect(self, udp_port: int, init: Init) -> None:
        client = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        client.bind((LOOPBACK, 0))
        client.settimeout(REPLY_TIMEOUT_S)
        client.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, BUFFER_BYTES)
        client.sendto(encode(init), (LOOPBACK, udp_port))
        reply = client.recv(MAX_DATAGRAM)
        if not reply.startswith(b"(init"):
            raise RuntimeError(f"init {init.team} {init.number}: the reply is {reply!r}; (init ...) was expected")
        stamp_arrivals(client)
        client.setblocking(False)
        self._sockets[client.fileno()], self._newest[client.fileno()] = client, -1
        self._poller.register(client.fileno(), select.EPOLLIN)

    def receive(self, timeout_s: float) -> None:
        """Receive all datagrams that have arrived; wait for the first, up to a timeout [s]."""
        ready = self._poller.poll(timeout_s)
        offset = monotonic_from_realtime()
        for descriptor, _ in ready:
            for datagram, arrived, port in _datagrams(self._sockets[descriptor], offset):
                self.ports.add(port)
                self._count(descriptor, datagram, arrived)

    def _count(self, descriptor: int, datagram: bytes, arrived: int) -> None:
        if not datagram.startswith(SEE):
            self.errors.append(datagram.decode("ascii", "replace"))
            return
        time_us = int(datagram[len(SEE) : datagram.index(b" ", len(SEE))].replace(b".", b""))
        self.disordered += time_us <= self._newest[descriptor]
        self._newest[descriptor] = time_us
        view = self.views.setdefault(time_us, [0, arrived, arrived])
        view[0] += 1
        view[1], view[2] = min(view[1], arrived), max(view[2], arrived)


def monotonic_from_realtime() -> int:
    """CLOCK_MONOTONIC minus CLOCK_REALTIME [ns], from the quickest of three readings of both clocks."""
    best, offset = NS_PER_S, 0
    for _ in range(3):
        before, real, after = time.monotonic_ns(), time.time_ns(), time.monotonic_ns()
        if after - before < best:
            best, offset = after - before, (before + after) // 2 - real
    return offset


def _datagrams(client: socket.socket, offset: int) -> Iterator[tuple[bytes, int, int]]:
    """All datagrams that wait in a socket: bytes, arrival [ns of CLOCK_MONOTONIC], the server's port."""
    with contextlib.suppress(BlockingIOError):
        while True:
            datagram, ancillary, _, source = client.recvmsg(MAX_DATAGRAM, ANCILLARY)
            arrived = time.monotonic_ns()
            for level, kind, data in ancillary:
                if (level, kind) == (socket.SOL_SOCKET, SO_TIMESTAMPNS):
                    seconds, nanoseconds = TIMESPEC.unpack(data[: TIMESPEC.size])
                    arrived = seconds * NS_PER_S + nanoseconds + offset
            yield datagram, arrived, source[1]


def main(udp_port: int, per_team: int) -> None:
    """Connect all clients, receive until standard input ends, print the report."""
    receiver = Receiver(udp_port, per_team)
    policy = request_realtime(OBSERVER_PRIORITY)
    print(READY, flush=True)
    while not has_stdin_ended():
        receiver.receive(POLL_TIMEOUT_S)
    views = [[time_us, *view] for time_us, view in receiver.views.items()]
    report = {"policy": policy, "clients": receiver.clients, "ports": sorted(receiver.ports), "views": views}
    print(json.dumps(report | {"disordered": receiver.disordered, "errors": receiver.errors}))


if __name__ == "__main__":
    main(*map(int, sys.argv[1:3]))
