"""A client that does everything right, but for what a test says."""

import contextlib
import socket
import threading
import time
from dataclasses import dataclass
from types import TracebackType
from typing import Self

SILENCE_S = 0.5
KEEP_S = 0.3


@dataclass(frozen=True)
class Habits:
    """What it does; the defaults are right."""

    init: bytes = b"(init blue 3)"
    period_s: float = 0.3
    repeats: bool = True
    ends_with: bytes = b"nothing"
    """It ends when it reads a message that begins so."""
    ends_of_silence: bool = False
    returns_cookie: bool = True
    answers: bytes = b""
    """What it sends when it does not understand."""
    answers_pings: bool = True
    keeps_alive: bool = True
    asks_again: bool = True
    """When its session has gone silent."""
    obeys_replaced: bool = True
    asks_mirror: bool = True
    connects_to_main: bool = False
    bye_to_main: bool = False
    floods: bool = False


class Robot(threading.Thread):
    """Runs until it is left, or ends by itself."""

    def __init__(self, port: int, habits: Habits) -> None:
        super().__init__()
        self.habits = habits
        self._main = ("127.0.0.1", port)
        self._server = self._main
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._socket.settimeout(0.02)
        if habits.connects_to_main:
            self._socket.connect(self._main)
        self._left = threading.Event()
        self._is_open = False
        self._asked = self._heard = self._kept = 0.0

    def __enter__(self) -> Self:
        self.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._left.set()
        self.join()

    def run(self) -> None:
        with self._socket:
            while not self._left.is_set():
                self._ask_if_due()
                with contextlib.suppress(OSError):
                    data, source = self._socket.recvfrom(4096)
                    if self._take(data, source):
                        return
                if self.habits.ends_of_silence and self._is_open and self._silent_s() > SILENCE_S / 2:
                    return
            self._send(b"(bye)", self._main if self.habits.bye_to_main else self._server)

    def _silent_s(self) -> float:
        return time.monotonic() - self._heard

    def _send(self, data: bytes, to: tuple[str, int]) -> None:
        with contextlib.suppress(OSError):
            self._socket.send(data) if self.habits.connects_to_main else self._socket.sendto(data, to)

    def _ask_if_due(self) -> None:
        now, habits = time.monotonic(), self.habits
        if self._is_open and self._silent_s() > SILENCE_S and habits.asks_again:
            self._is_open = False
        may_ask = habits.repeats or not self._asked
        if not self._is_open and may_ask and now - self._asked >= habits.period_s:
            self._asked = now
            self._send(habits.init, self._main)
        if self._is_open and habits.keeps_alive and now - self._kept >= KEEP_S:
            self._kept = now
            self._send(b"(mirror)" if habits.asks_mirror else b"(ping)", self._server)
        if habits.floods:
            for _ in range(20):
                self._send(b"(ping)", self._server)

    def _take(self, data: bytes, source: tuple[str, int]) -> bool:
        """Read a message; is it the end?"""
        habits = self.habits
        if data.startswith(habits.ends_with):
            return True
        if data.startswith(b"(error replaced") and habits.obeys_replaced:
            self._is_open, self._asked = True, time.monotonic() + 60.0
            self._heard = self._kept = self._asked
        elif data.startswith(b"(error "):
            self._is_open &= not habits.asks_again
        elif data.startswith(b"(challenge ") and len(data) > 20 and habits.returns_cookie:
            self._send(habits.init[:-1] + b" (cookie %s))" % data[11:-1], self._main)
        elif data.startswith(b"(ping") and habits.answers_pings:
            self._send(data, source)
        elif data.startswith((b"(init blue 3 ", b"(see ")):
            self._is_open, self._heard, self._server = True, time.monotonic(), source
        elif habits.answers:
            self._send(habits.answers, source)
        return False
