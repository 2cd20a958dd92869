"""A server for clients: one that plays, and one that says what a test wants."""

import socket
import threading
from collections.abc import Callable
from types import TracebackType
from typing import Self


class ScriptedServer:
    """Answers each datagram with what a function makes of it, from its own port or through another socket."""

    def __init__(self, answer: Callable[[bytes], list[bytes]], through: socket.socket | None = None) -> None:
        self.heard: list[bytes] = []
        self._answer = answer
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._socket.bind(("127.0.0.1", 0))
        self._socket.settimeout(0.05)
        self._through = through or self._socket
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._run)
        self.port: int = self._socket.getsockname()[1]

    def __enter__(self) -> Self:
        self._thread.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._stop.set()
        self._thread.join()
        self._socket.close()

    def _run(self) -> None:
        while True:
            try:
                data, client = self._socket.recvfrom(2048)
            except TimeoutError:
                if self._stop.is_set():  # what was sent before the end is heard
                    return
                continue
            self.heard.append(data)
            for reply in self._answer(data):
                self._through.sendto(reply, client)
