"""The clients of both teams in one process: a socket for each, and when the kernel put each datagram into it.

    python -m bench.receiver UDP_PORT NUMBERS        until standard input ends

Every socket says init once, with (time us), and nothing ever after: whatever happens to the service, no client
reconnects. Prints JSON: {"policy", "clients", "ports": of the server that views came from, "disordered": views whose
Time was not greater than the one before, "errors": other messages, "views": [[Time_us, clients, first_ns, last_ns],
...]}: per Time how many clients got it, and the instants [ns of CLOCK_MONOTONIC] of the first and the last.
"""

import contextlib
import json
import select
import socket
import sys
import time
from collections.abc import Iterator

from bench.helpers import BELOW_SERVE, READY, keep_time, told_to_end
from vision_core.client.lag import SO_TIMESTAMPNS, TIMESPEC, stamp_arrivals
from vision_core.clock import NS_PER_S
from vision_core.protocol.codec import encode
from vision_core.protocol.messages import Init
from vision_core.protocol.options import Options
from vision_core.types.objects import Team

LOOPBACK = "127.0.0.1"
PATIENCE_S = 5.0
LONGEST = 4096
ANCILLARY = socket.CMSG_SPACE(TIMESPEC.size)
NAP_S = 0.1
"""Between two looks at standard input, when nothing comes."""
SEE = b"(see "
ROOM = 1 << 20
"""Of a socket's buffer [bytes]."""


class Receiver:
    """All clients."""

    def __init__(self, udp_port: int, numbers: int) -> None:
        self.views: dict[int, list[int]] = {}
        self.ports: set[int] = set()
        self.disordered = 0
        self.errors: list[str] = []
        self._poller = select.epoll()
        self._sockets: dict[int, socket.socket] = {}
        self._newest: dict[int, int] = {}
        for team in Team:
            for number in range(1, numbers + 1):
                self._open(udp_port, Init(team, number, Options(time="us")))

    @property
    def clients(self) -> int:
        """How many they are."""
        return len(self._sockets)

    def _open(self, udp_port: int, init: Init) -> None:
        """Raises RuntimeError when the server does not answer init with init."""
        client = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        client.bind((LOOPBACK, 0))
        client.settimeout(PATIENCE_S)
        client.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, ROOM)
        client.sendto(encode(init), (LOOPBACK, udp_port))
        answer = client.recv(LONGEST)
        if not answer.startswith(b"(init"):
            raise RuntimeError(f"init {init.team} {init.number}: {answer!r} was answered; (init ...) was expected")
        stamp_arrivals(client)
        client.setblocking(False)
        self._sockets[client.fileno()], self._newest[client.fileno()] = client, -1
        self._poller.register(client.fileno(), select.EPOLLIN)

    def wait(self, timeout_s: float) -> None:
        """Take what has come."""
        ready = self._poller.poll(timeout_s)
        offset = monotonic_from_real()
        for descriptor, _ in ready:
            for datagram, arrived, port in _datagrams(self._sockets[descriptor], offset):
                self.ports.add(port)
                self._take(descriptor, datagram, arrived)

    def _take(self, descriptor: int, datagram: bytes, arrived: int) -> None:
        if not datagram.startswith(SEE):
            self.errors.append(datagram.decode("ascii", "replace"))
            return
        time_us = int(datagram[len(SEE) : datagram.index(b" ", len(SEE))].replace(b".", b""))
        self.disordered += time_us <= self._newest[descriptor]
        self._newest[descriptor] = time_us
        view = self.views.setdefault(time_us, [0, arrived, arrived])
        view[0] += 1
        view[1], view[2] = min(view[1], arrived), max(view[2], arrived)


def monotonic_from_real() -> int:
    """What to add to an instant of CLOCK_REALTIME for CLOCK_MONOTONIC [ns], from the closest of three readings."""
    best, offset = NS_PER_S, 0
    for _ in range(3):
        before, real, behind = time.monotonic_ns(), time.time_ns(), time.monotonic_ns()
        if behind - before < best:
            best, offset = behind - before, (before + behind) // 2 - real
    return offset


def _datagrams(client: socket.socket, offset: int) -> Iterator[tuple[bytes, int, int]]:
    """Everything in a socket: bytes, instant of arrival, the server's port."""
    with contextlib.suppress(BlockingIOError):
        while True:
            datagram, ancillary, _, source = client.recvmsg(LONGEST, ANCILLARY)
            arrived = time.monotonic_ns()
            for level, kind, data in ancillary:
                if (level, kind) == (socket.SOL_SOCKET, SO_TIMESTAMPNS):
                    seconds, nanoseconds = TIMESPEC.unpack(data[: TIMESPEC.size])
                    arrived = seconds * NS_PER_S + nanoseconds + offset
            yield datagram, arrived, source[1]


def main(udp_port: int, numbers: int) -> None:
    """Connect, listen, report."""
    receiver = Receiver(udp_port, numbers)
    policy = keep_time(BELOW_SERVE)
    print(READY, flush=True)
    while not told_to_end():
        receiver.wait(NAP_S)
    views = [[time_us, *view] for time_us, view in receiver.views.items()]
    told = {"policy": policy, "clients": receiver.clients, "ports": sorted(receiver.ports), "views": views}
    print(json.dumps(told | {"disordered": receiver.disordered, "errors": receiver.errors}))


if __name__ == "__main__":
    main(*map(int, sys.argv[1:3]))
