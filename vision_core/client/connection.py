"""A robot's session with a server."""

import contextlib
import socket
from collections.abc import Iterator
from types import TracebackType
from typing import Self

from vision_core.client.lag import LagReports, SockAddress, receive_stamped, stamp_arrivals
from vision_core.client.view import View, view_from_see
from vision_core.clock import Clock, Instant, MonotonicClock, after, seconds_between
from vision_core.errors import ConnectionRefused
from vision_core.models.mirror import PAPER_MIRROR, Mirror
from vision_core.protocol.codec import MAX_ANSWER, decode_message, encode
from vision_core.protocol.error_codes import MEANINGS
from vision_core.protocol.messages import Bye, Error, Init, InitReply, See, ServerMessage
from vision_core.protocol.options import PAPER_OPTIONS, Options
from vision_core.types.objects import Team

RETRY_S = 0.3
"""Between two attempts to connect."""
KEEPALIVE_S = 60.0
"""The server drops whom it does not hear for its lease (10 minutes)."""
SILENCE_S = 1.0
"""Nothing heard for so long: ask the server's session port every second."""
RESTART_S = 3.0
"""Nothing heard for so long: the server was perhaps restarted, ask its main port."""
PATIENCE_S = 1.0
MAX_AT_ONCE = 1000
"""More than a socket's buffer holds: draining it ends, whatever comes in [datagrams]."""


def connect(
    host: str,
    port: int,
    team: Team | str,
    number: int,
    *,
    options: Options = PAPER_OPTIONS,
    mirror: Mirror = PAPER_MIRROR,
    timeout_s: float = 5.0,
    clock: Clock | None = None,
) -> "Connection":
    """Ask a server for a robot's views.

    mirror: that of the server's field. Every ``View.mm`` and ``ball_mm`` depends on it, and version 1 of the
    protocol does not tell it: look it up in the preset (``config/fields``, section ``mirror``) unless the field
    is at most 3 m long, whose mirror is the default. Or ask for a mirror of your own, ``options.mirror``: the
    server then looks through that one, it goes before ``mirror``, and distances are right on any field.

    Raises ConnectionRefused when the server refuses, with its reason, or does not answer in time, and
    ValueError for a team that is none.
    """
    connection = Connection(host, port, Init(Team(team), number, options), mirror, clock or MonotonicClock())
    try:
        connection.open(timeout_s)
    except BaseException:
        connection.close()
        raise
    return connection


class Connection:
    """An open session: iterate it, or ask for the latest view. Closing it says bye."""

    def __init__(self, host: str, port: int, init: Init, mirror: Mirror, clock: Clock) -> None:
        self.init = init
        self.mirror = init.options.mirror or mirror
        self.mode = ""
        """Play mode in the server's last answer."""
        self._name = f"{init.team} {init.number} at {host}:{port}"
        self._clock = clock
        family, self._main = _resolved(self._name, host, port)
        self._server = self._main
        self._socket = socket.socket(family, socket.SOCK_DGRAM)
        stamp_arrivals(self._socket)
        self._heard = self._asked = self._arrived = clock.now()
        self._lag = LagReports(self._heard)
        self._time_us = -1

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def __iter__(self) -> Iterator[View]:
        """Views as they come, for ever. Raises ConnectionRefused when the server ends the session."""
        while True:
            view = self.receive(PATIENCE_S)
            if view is not None:
                yield view

    @property
    def port(self) -> int:
        """UDP port of the server that the last datagram came from; views come from there."""
        return int(self._server[1])

    @property
    def silent_s(self) -> float:
        """How long nothing was heard."""
        return seconds_between(self._heard, self._clock.now())

    def open(self, timeout_s: float) -> None:
        """Send init until the server answers. Raises ConnectionRefused."""
        deadline = after(self._clock.now(), timeout_s)
        while self._clock.now() < deadline:
            self._ask(self._main)
            again = min(after(self._clock.now(), RETRY_S), deadline)
            while (message := self._next_message(again)) is not None:
                if isinstance(message, InitReply | See):
                    return
        raise ConnectionRefused(
            self._name,
            found=f"no answer within {timeout_s:g} s",
            accepted="the address of a running server (pslv serve) that admits this computer",
        )

    def receive(self, timeout_s: float) -> View | None:
        """The next view; None when none came in time. Raises ConnectionRefused when the server ends the session."""
        self._lag.view_used(self._clock.now())
        deadline = after(self._clock.now(), timeout_s)
        while True:
            self._stay()
            message = self._next_message(min(deadline, after(self._clock.now(), SILENCE_S)))
            if isinstance(message, See):
                return self._view(message)
            if self._clock.now() >= deadline:
                return None

    def latest(self) -> View | None:
        """The newest view that has come, without waiting; None when there is no new one. Raises ConnectionRefused."""
        self._lag.view_used(self._clock.now())
        self._stay()
        newest = None
        for _ in range(MAX_AT_ONCE):
            message = self._next_message(self._clock.now())
            if message is None:
                break
            newest = message if isinstance(message, See) else newest
        return self._view(newest) if newest else None

    def close(self) -> None:
        """Say bye and let go of the socket."""
        with contextlib.suppress(OSError):
            self._send(encode(Bye()), self._server)
        self._socket.close()

    def _view(self, newest: See) -> View:
        """The view of the last datagram that was taken; about once a second the server hears how long it took."""
        report = self._lag.view_arrived(newest.time_us, self._arrived, self._clock.now())
        if report is not None:
            self._send(encode(report), self._server)
        return view_from_see(newest, self.init.options, self.mirror)

    def _stay(self) -> None:
        """Ask again when it is time to: the server must hear us, and may have been restarted."""
        asked_s = seconds_between(self._asked, self._clock.now())
        if asked_s >= KEEPALIVE_S or min(self.silent_s, asked_s) >= SILENCE_S:
            self._ask(self._main if self.silent_s >= RESTART_S else self._server)

    def _ask(self, server: SockAddress) -> None:
        self._asked = self._clock.now()
        self._send(encode(self.init), server)

    def _send(self, data: bytes, server: SockAddress) -> None:
        with contextlib.suppress(OSError):  # the network is away: silence tells
            self._socket.sendto(data, server)

    def _next_message(self, deadline: Instant) -> ServerMessage | None:
        """The next message of the server that says something new, until an instant."""
        for _ in range(MAX_AT_ONCE):
            received = self._next_datagram(deadline)
            if received is None:
                return None
            data, source, age_ns = received
            message = decode_message(data) if source[0] == self._main[0] else None
            if isinstance(message, Error) and self._lag.explains(message.name):
                continue
            if isinstance(message, Error):
                meaning = MEANINGS.get(message.name, "see the server's documentation")
                raise ConnectionRefused(self._name, found=f"error {message.name}: {meaning}")
            if isinstance(message, InitReply) and (message.team, message.number) != (self.init.team, self.init.number):
                continue
            if isinstance(message, See) and message.time_us <= self._time_us:
                continue
            if message is not None:
                self._note(message, source, age_ns)
                return message
        return None

    def _note(self, message: ServerMessage, source: SockAddress, age_ns: int) -> None:
        self._server, self._heard = source, self._clock.now()
        if isinstance(message, See):
            self._time_us, self._arrived = message.time_us, Instant(self._heard - age_ns)
        elif isinstance(message, InitReply):
            self.mode = message.mode
            self._time_us = -1  # perhaps another server, whose Time began anew

    def _next_datagram(self, deadline: Instant) -> tuple[bytes, SockAddress, int] | None:
        self._socket.settimeout(max(seconds_between(self._clock.now(), deadline), 0.0))
        try:
            return receive_stamped(self._socket, MAX_ANSWER + 1)
        except OSError:  # timeout; or, on some systems, a report that a port was closed
            return None


def _resolved(name: str, host: str, port: int) -> tuple[int, SockAddress]:
    if not 0 < port < 65536:
        raise ConnectionRefused(name, found=f"port {port}", accepted="a port of 1..65535")
    try:
        found = socket.getaddrinfo(host, port, type=socket.SOCK_DGRAM)
    except (socket.gaierror, UnicodeError) as error:
        raise ConnectionRefused(name, found=str(error), accepted="a host name or address, and a port") from None
    family, _, _, _, address = min(found, key=lambda info: info[0] != socket.AF_INET)
    return family, address
