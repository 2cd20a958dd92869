"""The sockets of an examination: they speak text, and write down every datagram."""

import re
import socket
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from typing import NamedTuple

from vision_core.examination.way import Place
from vision_core.protocol.options import MAX_DATAGRAM
from vision_core.protocol.s_expressions import parse_forms

PATIENCE_S = 1.0
"""For an answer."""
VIEW_S = 3.0
"""For a view: a server that is busy leaves images out."""
QUIET_S = 0.3
"""Without a datagram for so long, none is coming."""
ATTEMPTS = 3
SHOWN = 160
"""Longest part of a datagram that is kept for people [characters]."""


class Broken(Exception):
    """The server breaks the rule: what was expected, and what came."""


class Skipped(Exception):
    """The server cannot be held to the rule now, and why."""


class Received(NamedTuple):
    """A datagram of the server."""

    text: str
    port: int

    @property
    def is_view(self) -> bool:
        """Is it a view? Views may come between any two other messages."""
        return self.text.startswith("(see ")


@dataclass
class Probe:
    """Where the server is, the two robots that are used, and what has been said."""

    place: Place
    team: str = "blue"
    number: int = 1
    other: int = 2
    exchange: list[str] = field(default_factory=list)

    @property
    def port(self) -> int:
        """The main port."""
        return self.place.address[1]

    @property
    def robot(self) -> str:
        """The robot as the wire names it."""
        return f"{self.team} {self.number}"

    @contextmanager
    def client(self) -> Iterator["Client"]:
        """A client with a socket of its own; at its end it says bye wherever it has been served."""
        with socket.socket(self.place.family, socket.SOCK_DGRAM) as opened:
            client = Client(self, opened)
            yield client
            client.leave()

    def init(self, options: str = "", number: int | None = None) -> str:
        """An init for one of the robots."""
        return f"(init {self.team} {number or self.number}{f' {options}' if options else ''})"


class Client:
    """One socket."""

    def __init__(self, probe: Probe, opened: socket.socket) -> None:
        self._probe = probe
        self._socket = opened
        self.served_from = 0
        """The port that views come from; 0: init was not answered yet."""

    def send(self, text: str, port: int | None = None) -> None:
        """Send to the port that serves this client, at first the main one."""
        to = port or self.served_from or self._probe.port
        self._probe.exchange.append(f"{to:>5} <- {shown(text)}")
        self._socket.sendto(text.encode("latin-1"), (self._probe.place.address[0], to))

    def receive(self, patience_s: float = PATIENCE_S) -> Received | None:
        """The next datagram; None when none came. Raises Broken for one that no message may be."""
        self._socket.settimeout(patience_s)
        try:
            data, source = self._socket.recvfrom(65535)
        except OSError:
            return None
        received = Received(data.decode("latin-1"), source[1])
        self._probe.exchange.append(f"{received.port:>5} -> {shown(received.text)}")
        if len(data) > MAX_DATAGRAM:
            raise Broken(f"one of at most {MAX_DATAGRAM} bytes expected; {len(data)} bytes came")
        if not received.is_view and len(parse_forms(data.rstrip(b"\0")) or ()) != 1:
            raise Broken(f"one form per datagram expected; {shown(received.text)} came")
        return received

    def answer(self, patience_s: float = PATIENCE_S) -> Received | None:
        """The next datagram that is no view."""
        end = time.monotonic() + patience_s
        while (left_s := end - time.monotonic()) > 0.0:
            received = self.receive(left_s)
            if received is not None and not received.is_view:
                return received
        return None

    def ask(self, text: str, port: int | None = None) -> Received:
        """Send, and again when no answer comes, since datagrams get lost. Raises Broken when none comes at all."""
        for _ in range(ATTEMPTS):
            self.send(text, port)
            if (answer := self.answer()) is not None:
                return answer
        raise Broken(f"an answer to {shown(text)} expected; none came")

    def expect(self, text: str, pattern: str, port: int | None = None) -> Received:
        """Ask for an answer of a form. Raises Broken."""
        answer = self.ask(text, port)
        if not re.fullmatch(pattern, answer.text):
            raise Broken(f"{pattern} expected after {shown(text)}; {shown(answer.text)} came")
        return answer

    def expect_error(self, text: str, error: str, port: int | None = None) -> None:
        """Ask for an error."""
        self.expect(text, rf"\(error {error}\)", port)

    def expect_silence(self, text: str) -> None:
        """Nothing but views may come. Raises Broken."""
        self.send(text)
        if (answer := self.answer(QUIET_S)) is not None:
            raise Broken(f"silence expected after {shown(text)}; {shown(answer.text)} came")

    def open(self, options: str = "", number: int | None = None, end: str = "") -> Received:
        """Open a session of version 1 and return its answer. end: NUL, if it shall end with it. Raises Skipped."""
        answer = self.ask(self._probe.init(options, number) + end, self._probe.port)
        return self._opened(answer)

    def open_2(self, options: str = "") -> Received:
        """Open a session of version 2 and return its answer. Raises Broken, or Skipped."""
        init = self._probe.init(f"(version 2) {options}".strip())
        answer = self.ask(init, self._probe.port)
        if answer.text.startswith("(challenge "):
            answer = self.ask(f"{init[:-1]} (cookie {answer.text[11:-1]}))", self._probe.port)
            if answer.text.startswith("(challenge "):
                raise Broken(f"an answer to the cookie expected; {shown(answer.text)} came")
        elif answer.text.startswith("(init "):
            self._opened(answer)
            raise Skipped("the server speaks version 1")
        return self._opened(answer)

    def view(self) -> Received:
        """The next view. Raises Skipped: the camera need not see the robot."""
        end = time.monotonic() + VIEW_S
        while (left_s := end - time.monotonic()) > 0.0:
            received = self.receive(left_s)
            if received is not None and received.is_view:
                return received
        raise Skipped("no view comes: does the camera see the robot?")

    def views(self, count: int) -> list[Received]:
        """The next views."""
        return [self.view() for _ in range(count)]

    def quiet_after_bye(self) -> Received | None:
        """What still comes when all that was under way has arrived; None: nothing."""
        self.answer(QUIET_S)
        return self.receive(QUIET_S)

    def leave(self) -> None:
        """Say bye, and wait until nothing comes any more."""
        if self.served_from:
            self.send(f"(bye {self._probe.team} {self._probe.number})")
            self.send(f"(bye {self._probe.team} {self._probe.other})")
            with suppress(Broken):
                while self.receive(QUIET_S) is not None:
                    pass

    def close(self) -> None:
        """Close the socket without a word, as a program that crashes."""
        self._socket.close()
        self.served_from = 0

    def _opened(self, answer: Received) -> Received:
        if not answer.text.startswith("(init "):
            raise Skipped(f"the session was not opened: {shown(answer.text)}")
        self.served_from = answer.port
        return answer


def shown(text: str) -> str:
    """A datagram for people: NUL as \\0, and what is long is cut."""
    short = text if len(text) <= SHOWN else f"{text[:SHOWN]}... ({len(text)} characters)"
    return short.replace("\0", "\\0")
