"""A server for one client, with faults on demand."""

import contextlib
import select
import socket
from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from typing import NamedTuple

from vision_core.clock import Clock, Instant, after, seconds_between
from vision_core.errors import ServiceError
from vision_core.examination.trial.program import Program
from vision_core.examination.trial.scenery import unseen, view_of
from vision_core.examination.trial.weather import Way
from vision_core.models.mirror import PAPER_MIRROR, Mirror
from vision_core.protocol.admission import Admission
from vision_core.protocol.encoding import encode
from vision_core.protocol.events import Endpoint, Event, Reply, SessionOpened, SyncAsked
from vision_core.protocol.lifecycle import Peer, Port, Session
from vision_core.protocol.messages import MAX_NUMBER, SyncReply
from vision_core.protocol.rules import ServerFacts, SessionRules
from vision_core.protocol.session import Sessions
from vision_core.types.objects import Team

PERIOD_S = 1 / 30
LEASE_S = 4.0
"""Of version 2, as the client is told: short, so that the trial is."""
MOST = 2048
TURN_DEG = 3
"""From view to view."""
ROBOTS = [(team, number) for team in Team for number in range(1, MAX_NUMBER + 1)]


class Heard(NamedTuple):
    """A datagram of the client."""

    at: Instant
    data: bytes
    port: Port
    peer: Peer
    same_port: bool
    """The client was served from the main port."""


@dataclass(frozen=True, slots=True)
class TrialRules(SessionRules):
    """Rules with a short lease."""

    def lease_of(self, session: Session) -> float:
        """The same for every session of version 2."""
        return self.lease_s if session.version == 1 else LEASE_S


class TrialServer:
    """Two ports, one client at a time, and views of a robot that turns."""

    def __init__(self, host: str, port: int, program: Program, clock: Clock, seed: int = 1) -> None:
        """port 0: any free one. Raises ServiceError when it is taken."""
        self.clock, self.program = clock, program
        self.heard: list[Heard] = []
        self.way = Way(seed)
        self.is_deaf = False
        """Whatever comes is noted, and gets no answer."""
        self.sees_robot = True
        self.view_at: Instant | None = None
        """When the last view was sent."""
        self.is_gone = False
        """The client's computer has said that its port is closed."""
        self._host = host
        self._sockets: dict[Port, socket.socket] = {}
        self._open(port, port + 1 if port else 0)
        self._next_view = clock.now()
        self._turn = 0
        self.begin()

    @property
    def port(self) -> int:
        """The main port."""
        return int(self._sockets[Port.MAIN].getsockname()[1])

    @property
    def session(self) -> Session | None:
        """The client's session."""
        return next(iter(self.sessions), None)

    def begin(self, mirror: Mirror = PAPER_MIRROR) -> None:
        """A start of the server: Time begins anew, and nobody has a session."""
        ports = {port: int(one.getsockname()[1]) for port, one in self._sockets.items()}
        facts = ServerFacts(ports, PERIOD_S * 1e3, dict.fromkeys(Team, 90.0), "trial", (2800.0, 2300.0))
        admission = Admission.from_subnets(["0.0.0.0/0", "::/0"])
        mirrors = dict.fromkeys(ROBOTS, mirror)
        self.boot = self.clock.now()
        self.sessions = Sessions(TrialRules(self.boot, MAX_NUMBER, 600.0, 3.6, mirrors, admission, facts))
        self.is_gone = False

    def change_mirror(self, mirror: Mirror) -> None:
        """The operator changes every robot's mirror."""
        rules = replace(self.sessions.rules, mirrors=dict.fromkeys(ROBOTS, mirror))
        self._apply(self.sessions.apply(rules, self.sessions.mode, self.clock.now()))

    def go_down(self) -> None:
        """The ports are closed, as when a server has ended."""
        self._down_from = self.port, int(self._sockets[Port.SESSION].getsockname()[1])
        self.close()
        self.way.clear()
        self.begin()

    def come_up(self) -> None:
        """The ports are open again."""
        self._open(*self._down_from)
        self.begin()

    def close(self) -> None:
        """Close both ports."""
        for one in self._sockets.values():
            one.close()
        self._sockets.clear()

    def say(self, data: bytes) -> None:
        """Send anything to the client."""
        self.way.put(data, self.clock.now())

    def answer(self, heard: Heard, data: bytes) -> None:
        """Answer a datagram that has no session, whatever the weather."""
        with contextlib.suppress(OSError):
            self._sockets[heard.port].sendto(data, (heard.peer.host, heard.peer.port))

    def end_session(self, error: bytes) -> None:
        """Tell the client an error and end its session."""
        session = self.session
        if session is not None:
            self.say(b"(error %s)" % error)
            self._deliver()
            self.sessions.close(session, self.clock.now())

    def play(self, seconds: float, until: Callable[[], bool] = lambda: False) -> bool:
        """Serve for some seconds, or until something holds; returns whether it came to hold."""
        end = after(self.clock.now(), seconds)
        while (now := self.clock.now()) < end and not until():
            pause_s = min(seconds_between(now, end), max(seconds_between(now, self._next_view), 0.0), 0.01)
            ready, _, _ = select.select(list(self._sockets.values()), [], [], pause_s)
            for port, one in self._sockets.items():
                if one in ready:
                    self._receive(port, one)
            self._show_if_due()
            self._deliver()
            self._apply(self.sessions.expire(self.clock.now()))
        return until()

    def since(self, start: Instant) -> list[Heard]:
        """What the client has sent since."""
        return [heard for heard in self.heard if heard.at >= start]

    def _open(self, main: int, session: int) -> None:
        try:
            for kind, number in ((Port.MAIN, main), (Port.SESSION, session)):
                one = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
                self._sockets[kind] = one
                one.setblocking(False)
                one.bind((self._host, number))
        except OSError as error:
            self.close()
            accepted = "two free ports, one after the other (--port)"
            raise ServiceError(
                f"UDP ports {main} and {session} of {self._host}", found=str(error), accepted=accepted
            ) from None

    def _receive(self, port: Port, one: socket.socket) -> None:
        now = self.clock.now()
        try:
            data, source = one.recvfrom(MOST)
        except OSError as error:
            self._note_refusal(error)
            return
        peer = Peer(str(source[0]), int(source[1]))
        self.heard.append(Heard(now, data, port, peer, self.session is not None and self.session.port is Port.MAIN))
        if not self.is_deaf:
            self._apply(self.sessions.receive(data, peer, Endpoint(port, self._host), now, now))

    def _note_refusal(self, error: OSError) -> None:
        if isinstance(error, ConnectionRefusedError) and self.session is not None:
            self._apply(self.sessions.refused(self.session, self.clock.now()))
            self.is_gone = self.session is None

    def _apply(self, events: Iterable[Event]) -> None:
        for event in events:
            match event:
                case SessionOpened(session):
                    self.is_gone = False
                    self._sockets[Port.SESSION].connect((session.peer.host, session.peer.port))
                case Reply(data, to, via, None):
                    with contextlib.suppress(OSError):
                        self._sockets[via.port].sendto(data, (to.host, to.port))
                case Reply(data):
                    self.say(data)
                case SyncAsked(session, sync, arrived):
                    reply = SyncReply(sync.id, sync.t1_ns, arrived - self.boot, self.clock.now() - self.boot)
                    self.say(encode(reply) + (b"\0" if session.nul else b""))

    def _show_if_due(self) -> None:
        now, session = self.clock.now(), self.session
        if session is None or now < self._next_view:
            return
        self._next_view = after(now, PERIOD_S)
        self._turn += TURN_DEG
        if not self.sees_robot and session.version == 1:
            return
        self.view_at, time_ns = now, now - self.boot
        if self.sees_robot:
            self.say(view_of(session, self.sessions.rules.mirror_of(session), self._turn, time_ns))
        else:
            self.say(unseen(session, time_ns))

    def _deliver(self) -> None:
        """Hand the client what has arrived at it."""
        for data in self.way.arrived(self.clock.now()):
            session = self.session
            if session is None:
                continue
            to = (session.peer.host, session.peer.port)
            try:
                if session.port is Port.MAIN:
                    self._sockets[Port.MAIN].sendto(data, to)
                else:
                    self._sockets[Port.SESSION].send(data)
            except OSError as error:
                self._note_refusal(error)
