"""All sessions of a server: datagrams and instants in, replies and events out.

Whoever owns the sockets feeds ``receive`` with every datagram, its sender and the port it came to,
``refused`` when a client's machine answered that nobody listens, and ``expire`` now and then. It carries
out the events in order: opens, moves and closes the sockets of sessions, and sends the replies.
"""

import json
from collections.abc import Iterator
from dataclasses import dataclass
from typing import TypeAlias

from vision_core.clock import Instant, seconds_between
from vision_core.errors import SettingsError
from vision_core.models.mirror import check_span
from vision_core.protocol.admission import Admission
from vision_core.protocol.codec import MAX_COMMAND, decode_commands, encode
from vision_core.protocol.error_codes import ErrorName
from vision_core.protocol.lifecycle import Change, Peer, Port, Session, State
from vision_core.protocol.messages import Bye, Command, Error, Faulty, Init, InitReply, Lag, Warn
from vision_core.protocol.rate_limits import Allowance, Sources, TokenBucket
from vision_core.types.objects import Team

INITS_PER_S = 50.0
INIT_BURST = 50
UNHEARD_INITS = 3
REPEAT_S = 10.0
"""The same init within so long of the last one is a repetition."""
AT_ONCE_S = 2.0
"""A refusal within so long of an init means that the client cannot hear the port; later, that it is gone."""
AMPLIFICATION = 3
"""No reply to an address that is not admitted is longer than so many times its request."""
OFTEN = frozenset({ErrorName.ILLEGAL_FORM, ErrorName.UNKNOWN_COMMAND, ErrorName.NOT_CONNECTED, ErrorName.RATE_LIMITED})
"""Errors that one source hears once in 5 s; it hears precisely, each time, what is wrong with its init."""
SNAPSHOT = 1


@dataclass(frozen=True, slots=True)
class Arrival:
    """Where a datagram came to."""

    port: Port
    local: str
    """Our address."""


@dataclass(frozen=True, slots=True)
class Reply:
    """Send this: through the session's socket, or, where there is none, from where the request came to."""

    data: bytes
    to: Peer
    via: Arrival
    session: Session | None = None


@dataclass(frozen=True, slots=True)
class SessionOpened:
    session: Session


@dataclass(frozen=True, slots=True)
class SessionMoved:
    """The session's port has changed."""

    session: Session


@dataclass(frozen=True, slots=True)
class SessionClosed:
    session: Session
    reason: Change


@dataclass(frozen=True, slots=True)
class Refused:
    """Somebody was refused: for the operator's eyes."""

    peer: Peer
    error: ErrorName


Event: TypeAlias = Reply | SessionOpened | SessionMoved | SessionClosed | Refused


@dataclass(frozen=True, slots=True)
class Rules:
    """What a server fixes."""

    boot: Instant
    """Where Time is 0."""
    numbers: int
    """Robots per team that may connect."""
    lease_s: float
    diagonal_m: float
    """Of the field: a client's mirror must be of use on it."""
    admission: Admission


@dataclass(slots=True)
class Counts:
    """Datagrams since the start."""

    received: int = 0
    ignored: int = 0
    """Too long, no command, or said by a server."""
    limited: int = 0
    """Over the sender's allowance."""
    turned_away: int = 0
    """Not admitted."""


class Sessions:
    """The server's side of the protocol, without sockets."""

    def __init__(self, rules: Rules) -> None:
        self.rules = rules
        self.mode = "play_on"
        self.counts = Counts()
        self._by_robot: dict[tuple[Team, int], Session] = {}
        self._sources = Sources()
        self._inits = TokenBucket(INITS_PER_S, INIT_BURST)

    def __iter__(self) -> Iterator[Session]:
        return iter(tuple(self._by_robot.values()))

    def __len__(self) -> int:
        return len(self._by_robot)

    def receive(self, datagram: bytes, peer: Peer, arrival: Arrival, now: Instant) -> list[Event]:
        """What a datagram leads to."""
        self.counts.received += 1
        owned = [session for session in self if session.peer == peer]
        if len(datagram) > MAX_COMMAND:
            self.counts.ignored += 1
            return []
        allowance = owned[0].allowance if owned else self._sources.of(peer.host)
        if not allowance.bucket.take(now):
            self.counts.limited += 1
            return []
        request = decode_commands(datagram)
        if request is None:
            self.counts.ignored += 1
            return []
        if not owned and not self.rules.admission.admits(peer.host):
            return self._turn_away(len(datagram), request.nul, peer, arrival, allowance, now)
        for session in owned:
            session.heard = now
            if arrival.port is Port.SESSION:
                session.inits = 0
                session.step(Change.SPOKE)
        events: list[Event] = []
        for command in request.commands:
            outcome = self._obey(command, request.nul, peer, arrival, now)
            if isinstance(outcome, ErrorName):
                if outcome not in OFTEN or allowance.may_complain(outcome, now):
                    events += [_error(outcome, request.nul, peer, arrival), Refused(peer, outcome)]
                break
            events += outcome
        return events

    def refused(self, session: Session, now: Instant) -> list[Event]:
        """A client's machine says that nobody listens where this session sends to."""
        at_once = seconds_between(session.inited, now) <= AT_ONCE_S
        return self._step(session, Change.REFUSED_AT_ONCE if at_once else Change.REFUSED)

    def close(self, session: Session, reason: Change = Change.STOPPED) -> list[Event]:
        """End a session."""
        return self._step(session, reason)

    def not_opened(self, session: Session) -> list[Event]:
        """There is no socket for a session: tell its client, and forget it."""
        full = _error(ErrorName.SERVER_FULL, session.nul, session.peer, Arrival(Port.MAIN, session.local))
        return [*self.close(session), full, Refused(session.peer, ErrorName.SERVER_FULL)]

    def expire(self, now: Instant) -> list[Event]:
        """End the sessions whose client was silent for the lease."""
        events: list[Event] = []
        for session in self:
            if seconds_between(session.heard, now) > self.rules.lease_s:
                events += self._step(session, Change.SILENT)
        return events

    def snapshot(self) -> bytes:
        """All sessions as JSON, for ``restore`` in another process."""
        sessions = [session.to_plain() for session in self]
        return json.dumps({"snapshot": SNAPSHOT, "boot": self.rules.boot, "sessions": sessions}).encode("ascii")

    @staticmethod
    def restore(rules: Rules, snapshot: bytes) -> "Sessions":
        """Go on where another process stopped. Raises ValueError unless it is a snapshot of the same boot."""
        restored = Sessions(rules)
        try:
            plain = json.loads(snapshot)
            if (plain["snapshot"], plain["boot"]) != (SNAPSHOT, rules.boot):
                raise ValueError(f"a snapshot of format {plain['snapshot']}, boot {plain['boot']}")
            for one in plain["sessions"]:
                session = Session.from_plain(one, rules.boot)
                restored._by_robot[session.team, session.number] = session
        except (KeyError, TypeError, AttributeError) as error:
            raise ValueError(f"not a snapshot of sessions: {error!r}") from None
        return restored

    def _turn_away(
        self, length: int, nul: bool, peer: Peer, arrival: Arrival, allowance: Allowance, now: Instant
    ) -> list[Event]:
        """One short error now and then, and never more than three times what was sent."""
        self.counts.turned_away += 1
        reply = _error(ErrorName.NOT_ADMITTED, nul, peer, arrival)
        if not allowance.may_complain(ErrorName.NOT_ADMITTED, now):
            return []
        told = [reply] if len(reply.data) <= AMPLIFICATION * length else []
        return [*told, Refused(peer, ErrorName.NOT_ADMITTED)]

    def _obey(self, command: Command, nul: bool, peer: Peer, arrival: Arrival, now: Instant) -> list[Event] | ErrorName:
        match command:
            case Init():
                return self._init(command, nul, peer, arrival, now)
            case Bye() | Lag():
                session = self._addressed(command, peer)
                if isinstance(session, ErrorName):
                    return session
                if isinstance(command, Bye):
                    return self._step(session, Change.LEFT)
                session.note_report(command, now)
                return []
            case Faulty(error):
                return error

    def _addressed(self, command: Bye | Lag, peer: Peer) -> Session | ErrorName:
        """Which of a client's sessions a command is about: the one it names, or its only one."""
        owned = [session for session in self if session.peer == peer]
        if command.team is not None:
            owned = [session for session in owned if (session.team, session.number) == (command.team, command.number)]
        elif len(owned) > 1:
            return ErrorName.ILLEGAL_FORM
        return owned[0] if owned else ErrorName.NOT_CONNECTED

    def _init(self, init: Init, nul: bool, peer: Peer, arrival: Arrival, now: Instant) -> list[Event] | ErrorName:
        if not self._inits.take(now):
            return ErrorName.RATE_LIMITED
        if init.number > self.rules.numbers:
            return ErrorName.ILLEGAL_NUMBER
        if init.options.mirror is not None:
            try:
                check_span(init.options.mirror, self.rules.diagonal_m)
            except SettingsError:
                return ErrorName.ILLEGAL_MIRROR
        holder = self._by_robot.get((init.team, init.number))
        if holder is not None and holder.peer == peer:
            return self._repeated(holder, init, nul, now)
        if holder is not None and holder.peer.host != peer.host:
            return ErrorName.ALREADY_CONNECTED
        return [*self._take_from(holder), *self._open(init, nul, peer, arrival, now)]

    def _take_from(self, holder: Session | None) -> list[Event]:
        """The owner's computer has a newer client: the old one hears it and goes."""
        if holder is None:
            return []
        told = _error(ErrorName.REPLACED, holder.nul, holder.peer, _arrival_of(holder), holder)
        return [told, *self._step(holder, Change.REPLACED)]

    def _open(self, init: Init, nul: bool, peer: Peer, arrival: Arrival, now: Instant) -> list[Event]:
        state = State.SAME_PORT if init.options.port_same else State.TRYING
        session = Session(init, nul, peer, arrival.local, now, self.rules.boot, state, heard=now, inited=now)
        self._by_robot[init.team, init.number] = session
        return [SessionOpened(session), *self._answers(session)]

    def _repeated(self, session: Session, init: Init, nul: bool, now: Instant) -> list[Event]:
        """The answer was lost, or the client started anew on the same port, perhaps with other options."""
        same = init == session.init and seconds_between(session.inited, now) <= REPEAT_S
        session.inits = session.inits + 1 if same else 1
        session.init, session.nul, session.inited = init, nul, now
        moved: list[Event] = []
        if init.options.port_same or session.inits >= UNHEARD_INITS:
            moved = self._step(session, Change.UNHEARD)
        return moved or self._answers(session)

    def _step(self, session: Session, change: Change) -> list[Event]:
        if not session.step(change):
            return []
        if session.state is State.CLOSED:
            del self._by_robot[session.team, session.number]
            return [SessionClosed(session, change)]
        return [SessionMoved(session), *self._answers(session)]

    def _answers(self, session: Session) -> list[Event]:
        messages: list[InitReply | Warn] = [InitReply(session.team, session.number, self.mode)]
        if session.init.unknown_options:
            messages.append(Warn("unknown_option"))
        end = b"\0" if session.nul else b""
        return [Reply(encode(message) + end, session.peer, _arrival_of(session), session) for message in messages]


def _arrival_of(session: Session) -> Arrival:
    return Arrival(session.port, session.local)


def _error(name: ErrorName, nul: bool, to: Peer, via: Arrival, session: Session | None = None) -> Reply:
    return Reply(encode(Error(name)) + (b"\0" if nul else b""), to, via, session)
