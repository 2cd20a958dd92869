"""A robot's session with a server."""

import asyncio
import contextlib
import logging
import socket
from collections.abc import AsyncIterator, Callable, Iterator
from dataclasses import replace
from types import TracebackType
from typing import Self

from vision_core.arrival_stamps import stamp_arrivals
from vision_core.client.addresses import resolved
from vision_core.client.clock_sync import ClockSync, ServerTime
from vision_core.client.driving import Robot, checked, limits_of, robot_of
from vision_core.client.following import ViewThread
from vision_core.client.lag import Lag, LagReports, SockAddress, lag_of, receive_stamped
from vision_core.client.refusals import mirror_unknown, no_answer
from vision_core.client.view import View, view_from_see
from vision_core.clock import Clock, Instant, after, seconds_between
from vision_core.errors import ConnectionRefused
from vision_core.models.mirror import Mirror
from vision_core.protocol.answers import MAX_ANSWER, decode_message
from vision_core.protocol.driving import Drive, DriveLimits
from vision_core.protocol.encoding import encode
from vision_core.protocol.error_codes import MEANINGS, TRANSIENT, ErrorCode
from vision_core.protocol.messages import (
    FIXED_BY_MATCH,
    PLAY_MODES,
    Bye,
    Challenge,
    ErrorReply,
    Hear,
    Init,
    InitReply,
    MirrorQuery,
    MirrorReply,
    Ping,
    See,
    ServerMessage,
    SessionFacts,
    SyncReply,
    WarningReply,
)
from vision_core.protocol.options import Options, mirror_from_words

RETRY_S = 0.5
"""Between two attempts to connect, or to learn the mirror."""
KEEPALIVE_S = 60.0
"""Between two signs of life, if the server does not tell its lease; a third of the lease if it does."""
SILENCE_S = 1.0
"""Nothing received for so long: ask the server's session port, once a second."""
RESTART_S = 3.0
"""Nothing received for so long: the server may have been restarted, ask its main port."""
MIRROR_TIMEOUT_S = 5.0
"""For learning the mirror of a server that was restarted."""
PATIENCE_S = 1.0
MAX_AT_ONCE = 1000
"""Datagrams read by one call: more than a socket's buffer holds."""

log = logging.getLogger("vision_core.client")


class Connection:
    """An open session: iterate it, or ask for the latest view. Closing it sends bye."""

    def __init__(self, host: str, port: int, init: Init, mirror: Mirror | None, clock: Clock) -> None:
        self.init = init
        self.mode = ""
        """Play mode, as the server told it last."""
        self.sees = True
        """False while the server says that its camera delivers nothing: ``(hear Time referee vision_lost)``."""
        self.facts: SessionFacts | None = None
        """What the server has told of the session; None: its version is 1."""
        self.options = init.options
        """As the server grants them: a match gives all robots the same types, field of view and resolution."""
        self.last_error = ""
        """Error in the server's last message, as "not_ready"; empty when it was no error."""
        self._given_mirror = init.options.mirror or mirror
        self._mirror = self._given_mirror
        self._address = f"{host}:{port}"
        self._name = f"{init.team} {init.number} at {self._address}"
        self._clock = clock
        family, self._main = resolved(self._name, host, port)
        self._server = self._main
        self._socket = socket.socket(family, socket.SOCK_DGRAM)
        stamp_arrivals(self._socket)
        self._heard_at = self._asked_at = self._arrived_at = self._mirror_due_at = clock.now()
        self._lag = LagReports(self._heard_at)
        self._sync = ClockSync()
        self._time_us = -1
        self._shows_key = False
        """An address that is not admitted was refused; the answer to the key is not there yet."""
        self.restarts = 0
        """How often the server was found to have been restarted: its Time has begun anew."""
        self._is_silent = False
        self._thread: ViewThread | None = None

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()
        if self._thread is not None and kind is None:
            self._thread.wait()

    def __iter__(self) -> Iterator[View]:
        """The newest view each time, without end: a slow program misses views, and sees none late.

        Raises ConnectionRefused when the server ends the session.
        """
        while True:
            view = self.newest(PATIENCE_S)
            if view is not None:
                yield view

    async def __aiter__(self) -> AsyncIterator[View]:
        """As iteration, for a program of asyncio: a thread waits for the views. Nothing else may read meanwhile."""
        while True:
            view = await asyncio.to_thread(self.newest, PATIENCE_S)
            if view is not None:
                yield view

    def on_view(self, callback: Callable[[View], object]) -> ViewThread:
        """Call a function with the newest view, from a thread of its own, until the connection is closed.

        Nothing else may read views meanwhile. When the function raises, or the server ends the session, the thread
        ends: its error is logged, and raised by ``wait`` of what is returned and by the end of the ``with`` block.
        Raises RuntimeError when a function is called already.
        """
        if self._thread is not None and self._thread.runs:
            raise RuntimeError("views are given to a function already: stop that first")
        self._thread = ViewThread(self.newest, callback)
        self._thread.start()  # the function may close the connection at once, which ends the thread
        return self._thread

    @property
    def mirror(self) -> Mirror:
        """The mirror that the views are decoded with. Raises ConnectionRefused while it is not known."""
        if self._mirror is None:
            raise mirror_unknown(self._name)
        return self._mirror

    @property
    def port(self) -> int:
        """UDP port of the server that the last datagram came from; views come from there."""
        return int(self._server[1])

    @property
    def silent_s(self) -> float:
        """Time since the last datagram of the server."""
        return seconds_between(self._heard_at, self._clock.now())

    def server_time(self) -> ServerTime:
        """What the server's clock shows now. It becomes known, and stays exact, while views are read; a server of
        version 1 does not tell it."""
        return self._sync.server_time(self._clock.now())

    def open(self, timeout_s: float) -> None:
        """Send init until the server answers, and learn its mirror. Raises ConnectionRefused."""
        deadline = after(self._clock.now(), timeout_s)
        answered = waiting = False
        while self._clock.now() < deadline:
            if answered:
                self._send(encode(MirrorQuery()), self._server)
            else:
                self._ask(self._main)
            again_at = min(after(self._clock.now(), RETRY_S), deadline)
            while (message := self._next_message(again_at)) is not None:
                answered |= isinstance(message, InitReply | See)
                if answered and self._mirror is not None:
                    return
                if self.last_error == ErrorCode.NOT_READY:
                    if not waiting:
                        log.warning("%s: the server still prepares; waiting until it is ready", self._name)
                    waiting, deadline = True, after(self._clock.now(), timeout_s)
        raise (
            mirror_unknown(self._name) if answered else no_answer(self._name, self._address, self.last_error, timeout_s)
        )

    @property
    def lag(self) -> Lag | None:
        """The lag of the last view that was used, C until the program asked for the next one; None as ``View.lag``."""
        return self._lag.last

    def newest(self, timeout_s: float) -> View | None:
        """The newest view that has arrived, or else the next; None when none came in time. Raises as ``receive``."""
        return self.latest() or self.receive(timeout_s)

    def receive(self, timeout_s: float) -> View | None:
        """The next view; None when none came in time. Raises ConnectionRefused when the server ends the session."""
        self._lag.view_used(self._clock.now())
        deadline = after(self._clock.now(), timeout_s)
        while True:
            self._ask_if_due()
            message = self._next_message(min(deadline, self._next_question()))
            if isinstance(message, See) and self._mirror is not None:
                return self._view(message, self._mirror)
            if self._clock.now() >= deadline:
                return None

    def latest(self) -> View | None:
        """The newest view, without waiting; None when no new one has arrived. Raises ConnectionRefused."""
        self._lag.view_used(self._clock.now())
        self._ask_if_due()
        newest = None
        for _ in range(MAX_AT_ONCE):
            message = self._next_message(self._clock.now())
            if message is None:
                break
            newest = message if isinstance(message, See) else newest
        return self._view(newest, self._mirror) if newest and self._mirror else None

    @property
    def limits(self) -> DriveLimits:
        """What the robot can do. Raises ConnectionRefused when no program drives it, since it is a real one."""
        return limits_of(self._name, self.facts)

    @property
    def robot(self) -> Robot:
        """What a controller may know of the robot. Raises ConnectionRefused as ``limits``."""
        return robot_of(self._name, self.init, self.facts)

    def drive(self, vx: float, vy: float, omega: float, kick: float | None = None, dribble: bool = False) -> None:
        """Drive the robot of a simulated venue: forward, to the left [m/s] and anticlockwise [rad/s], in its own frame.

        The command holds until the next one, for half a second; then the robot stops. kick: kick the ball with this
        speed [m/s] as soon as it is at the front. dribble: hold the ball at the front. Raises ValueError for a command
        beyond ``limits``, and ConnectionRefused as ``limits``.
        """
        self._send(checked(Drive(vx, vy, omega, kick or 0.0, dribble), self.limits), self._server)

    def follow(self, drive: Drive) -> None:
        """Drive as near to a command as the robot can. Raises ValueError for nan, ConnectionRefused as ``limits``."""
        self._send(checked(self.limits.clipped(drive), self.limits), self._server)

    def close(self) -> None:
        """End the thread of ``on_view``, send bye and close the socket."""
        if self._thread is not None:
            self._thread.stop()
        with contextlib.suppress(OSError):
            self._send(encode(Bye()), self._server)
        self._socket.close()

    def _view(self, newest: See, mirror: Mirror) -> View:
        """The view of the datagram that was received last. About once a second the server is sent a lag report, and
        asked for the mirror, which the operator may have changed."""
        report = self._lag.view_arrived(newest.time_us, self._arrived_at, self._clock.now())
        if report is not None:
            self._send(encode(report) + self._mirror_query(), self._server)
        time_s, bound_s = self.server_time()
        view = view_from_see(newest, self.options, mirror)
        held_s = seconds_between(self._arrived_at, self._clock.now())
        lag = lag_of(view.time_s, view.extras.server_age_s, self._sync.server_time(self._arrived_at), held_s)
        self._lag.view_given(lag)
        return replace(view, age_s=time_s - view.time_s, age_bound_s=bound_s, lag=lag)

    def _ask_if_due(self) -> None:
        """Keep the session alive, find a server that was restarted, and learn its mirror and its clock."""
        now = self._clock.now()
        if (question := self._sync.question(now)) is not None:
            self._send(encode(question), self._server)
        asked_s = seconds_between(self._asked_at, now)
        if self.silent_s >= RESTART_S and not self._is_silent:
            self._is_silent = True
            log.warning("%s: no answer for %g s; asking until there is one", self._name, RESTART_S)
        if min(self.silent_s, asked_s) >= SILENCE_S:
            self._ask(self._main if self.silent_s >= RESTART_S else self._server)
        elif asked_s >= (self.facts.lease_s / 3.0 if self.facts else KEEPALIVE_S):
            self._ask(self._server)
        elif self._mirror is None and asked_s >= RETRY_S:
            if now > self._mirror_due_at:
                raise mirror_unknown(self._name)
            self._asked_at = now
            self._send(encode(MirrorQuery()), self._server)

    def _next_question(self) -> Instant:
        """When it may be time to ask again, if nothing arrives before."""
        patience = after(self._clock.now(), SILENCE_S if self._mirror is not None else RETRY_S)
        return patience if self._sync.due is None else min(patience, self._sync.due)

    def _ask(self, server: SockAddress) -> None:
        """Send init; the same datagram asks for the mirror, unless one was given."""
        self._asked_at = self._clock.now()
        self._send(encode(self.init) + self._mirror_query(), server)

    def _mirror_query(self) -> bytes:
        return b"" if self._given_mirror is not None else encode(MirrorQuery())

    def _send(self, data: bytes, server: SockAddress) -> None:
        with contextlib.suppress(OSError):  # the network is down: the server's silence shows it
            self._socket.sendto(data, server)

    def _next_message(self, deadline: Instant) -> ServerMessage | None:
        """The next message of the server, until an instant. Raises ConnectionRefused for an error that is final.

        Skips older views than the last one, and what is not for this robot.
        """
        for _ in range(MAX_AT_ONCE):
            received = self._next_datagram(deadline)
            if received is None:
                return None
            data, source, age_ns = received
            message = decode_message(data) if source[0] == self._main[0] else None
            if message is None or self._is_to_be_skipped(message):
                continue
            if isinstance(message, ErrorReply):
                self._raise_if_final(message.name)
                self.last_error = message.name
                return message
            self._note(message, source, age_ns)
            return message
        return None

    def _is_to_be_skipped(self, message: ServerMessage) -> bool:
        robot = self.init.team, self.init.number
        match message:
            case InitReply(team, number):
                return (team, number) != robot
            case MirrorReply(_, team, number):
                return team is not None and (team, number) != robot
            case See():
                return message.time_us <= self._time_us
            case ErrorReply(name):
                return self._lag.explains(name)
        return False

    def _raise_if_final(self, error: str) -> None:
        """Raise ConnectionRefused for an error after which it is of no use to ask again."""
        if error in TRANSIENT:
            return
        if error == ErrorCode.NOT_ADMITTED and self.init.proof.key and self.facts and not self._shows_key:
            self._shows_key = True  # this computer's address has changed: an init shows the key
            self._ask(self._main)
            return
        if error == ErrorCode.UNKNOWN_COMMAND and self._mirror is None:
            raise mirror_unknown(self._name)
        meaning = MEANINGS.get(error, "see the server's documentation")
        raise ConnectionRefused(self._name, found=f"error {error}: {meaning}", code=error)

    def _note(self, message: ServerMessage, source: SockAddress, age_ns: int) -> None:
        self._server, self._heard_at, self.last_error = source, self._clock.now(), ""
        if self._is_silent:
            self._is_silent = False
            log.warning("%s: the server answers again", self._name)
        match message:
            case See():
                self._time_us, self._arrived_at = message.time_us, Instant(self._heard_at - age_ns)
            case Challenge(cookie):
                self.init = replace(self.init, proof=replace(self.init.proof, cookie=cookie))
                self._ask(source)
            case Ping():
                self._send(encode(message), source)
            case Hear():
                self._note_heard(message)
            case SyncReply():
                self._sync.answered(message, Instant(self._heard_at - age_ns), self._heard_at)
            case InitReply():
                self._note_boot(message.facts)
                self._sync.begin(message.facts.boot if message.facts else None, self._heard_at)
                self.mode, self.facts, self.sees = message.mode, message.facts, True
                self._shows_key = False
                self.options = _granted(self.init.options, message.facts)
                # the server may have been restarted: its Time begins anew, and its field may have another mirror
                self._time_us = -1
                self._mirror = self._given_mirror or (message.facts.mirror if message.facts else None)
                self._mirror_due_at = after(self._heard_at, MIRROR_TIMEOUT_S)
            case MirrorReply():
                self._mirror = self._given_mirror or message.mirror
            case WarningReply(name) if name == FIXED_BY_MATCH:
                self._given_mirror = self._mirror = None  # the server tells which one it is
                self._mirror_due_at = after(self._heard_at, MIRROR_TIMEOUT_S)

    def _note_boot(self, facts: SessionFacts | None) -> None:
        """Say when the server has been restarted; a server of version 1 does not tell."""
        if self.facts and facts and facts.boot != self.facts.boot:
            self.restarts += 1
            log.warning("%s: the server was restarted; its time begins anew", self._name)

    def _note_heard(self, heard: Hear) -> None:
        match heard:
            case Hear(_, "referee", (mode,)) if mode in PLAY_MODES:
                self.mode = mode
            case Hear(_, "referee", ("vision_lost" | "vision_back" as word,)):
                self.sees = word == "vision_back"
            case Hear(_, "mirror", words) if mirror := mirror_from_words(words):
                self._mirror = self._given_mirror or mirror

    def _next_datagram(self, deadline: Instant) -> tuple[bytes, SockAddress, int] | None:
        self._socket.settimeout(max(seconds_between(self._clock.now(), deadline), 0.0))
        try:
            return receive_stamped(self._socket, MAX_ANSWER + 1)
        except OSError:  # a timeout; on some systems also the report that a port is closed
            return None


def _granted(asked: Options, facts: SessionFacts | None) -> Options:
    """The options that views are decoded with; a server of version 1 grants what it is asked for."""
    if facts is None:
        return asked
    return replace(
        asked,
        types=facts.types,
        fov_deg=facts.fov_deg,
        center_deg=facts.center_deg,
        resolution_deg=facts.resolution_deg,
    )
