"""An address translation between a client and a server: as a router or a container's bridge has it."""

import contextlib
import select
import socket
import threading
from types import TracebackType
from typing import Self

Address = tuple[str, int]


class Nat:
    """Gives each client an address of its own outside. Only where a client has sent to may answer."""

    def __init__(self, server: Address, outside: str = "127.0.0.1") -> None:
        self._server, self._outside = server, outside
        self._inside = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._inside.bind(("127.0.0.1", 0))
        self._doors: dict[Address, socket.socket] = {}
        self._lock = threading.Lock()
        self._left = threading.Event()
        self._thread = threading.Thread(target=self._run)
        self.port = int(self._inside.getsockname()[1])
        """Where clients take the server for."""

    def __enter__(self) -> Self:
        self._thread.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._left.set()
        self._thread.join()
        self.forget()
        self._inside.close()

    def forget(self) -> None:
        """Every client gets another address with its next datagram."""
        with self._lock:
            for door in self._doors.values():
                door.close()
            self._doors.clear()

    def _run(self) -> None:
        while not self._left.is_set():
            with contextlib.suppress(OSError, ValueError):  # a door was closed meanwhile: what was in it is lost
                self._pass_on()

    def _pass_on(self) -> None:
        with self._lock:
            doors = dict(self._doors)
        ready, _, _ = select.select([self._inside, *doors.values()], [], [], 0.02)
        if self._inside in ready:
            data, client = self._inside.recvfrom(2048)
            self._door(client).send(data)
        for client, door in doors.items():
            if door in ready:
                self._inside.sendto(door.recv(2048), client)

    def _door(self, client: Address) -> socket.socket:
        with self._lock:
            if client not in self._doors:
                door = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
                door.bind((self._outside, 0))
                door.connect(self._server)  # the session port's datagrams do not come in
                self._doors[client] = door
            return self._doors[client]
