"""All sessions of a server: datagrams and instants in, replies and events out.

The owner of the sockets (``vision_core.net.server``) calls ``receive`` for every datagram, ``refused`` when a client's
computer reports a closed port, and ``expire`` once a second or so. It applies the events in order: it opens, moves and
closes the sockets of sessions, and sends the replies.
"""

import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import TypeAlias

from vision_core.clock import Instant, seconds_between
from vision_core.errors import SettingsError
from vision_core.models.mirror import Mirror, check_span
from vision_core.protocol.admission import Admission
from vision_core.protocol.codec import MAX_COMMAND, decode_commands, encode
from vision_core.protocol.error_codes import ErrorCode
from vision_core.protocol.lifecycle import Peer, Port, Session, SessionState, SessionTrigger
from vision_core.protocol.messages import (
    FIXED_BY_MATCH,
    Bye,
    Command,
    ErrorReply,
    Init,
    InitReply,
    InvalidCommand,
    LagReport,
    MirrorQuery,
    MirrorReply,
    Request,
    WarningReply,
)
from vision_core.protocol.rate_limits import (
    AMPLIFICATION,
    DATAGRAM,
    INVALID,
    Rate,
    RateLimiter,
    RateLimiterTable,
    SharedBudget,
    TokenBucket,
)
from vision_core.types.objects import Team

ALL_DATAGRAMS_RATE = Rate(400.0, 400)
"""Datagrams of all admitted addresses that have no session."""
ALL_INITS_RATE = Rate(100.0, 100)
"""Inits of all addresses; a session that repeats its init is not counted."""
STRANGER_RATE = Rate(50.0, 50)
"""Datagrams of addresses that are not admitted: as many are read, the others are dropped unread."""
UNHEARD_INITS = 3
"""After so many equal inits the client is taken not to receive from the session port."""
REPEAT_S = 10.0
"""An equal init that comes so soon after the last one is a repetition."""
AT_ONCE_S = 2.0
"""A closed port reported so soon after an init: the client does not receive from this port. Later: it has ended."""
LIMITED_ERRORS = frozenset(
    {
        ErrorCode.ILLEGAL_FORM,
        ErrorCode.UNKNOWN_COMMAND,
        ErrorCode.NOT_CONNECTED,
        ErrorCode.RATE_LIMITED,
        ErrorCode.NOT_ADMITTED,
    }
)
"""Errors that one sender is told at most once in 5 s. The others, about an init, it is told each time."""
SNAPSHOT = 2
"""Version of the form of a snapshot."""


@dataclass(frozen=True, slots=True)
class Endpoint:
    """Where a datagram arrived, and where its answer is sent from."""

    port: Port
    local: str
    """Our address."""


@dataclass(frozen=True, slots=True)
class Reply:
    """Send this through the session's socket; without a session, from where the request arrived."""

    data: bytes
    to: Peer
    via: Endpoint
    session: Session | None = None


@dataclass(frozen=True, slots=True)
class SessionOpened:
    """There is a new session."""

    session: Session


@dataclass(frozen=True, slots=True)
class SessionMoved:
    """The session's port has changed."""

    session: Session


@dataclass(frozen=True, slots=True)
class SessionChanged:
    """The client has asked for other options, or another end of its messages."""

    session: Session


@dataclass(frozen=True, slots=True)
class SessionClosed:
    """The session has ended."""

    session: Session
    reason: SessionTrigger


@dataclass(frozen=True, slots=True)
class LagReported:
    """A client has reported its share of the lag."""

    session: Session
    report: LagReport
    at: Instant


@dataclass(frozen=True, slots=True)
class RequestRefused:
    """A request was refused; the operator is shown it."""

    peer: Peer
    error: ErrorCode
    team: Team | None = None
    """Of the robot that an init named."""
    number: int | None = None


Event: TypeAlias = Reply | SessionOpened | SessionMoved | SessionChanged | SessionClosed | LagReported | RequestRefused


@dataclass(frozen=True, slots=True)
class SessionRules:
    """What a server prescribes."""

    boot: Instant
    """Where Time is 0."""
    numbers: int
    """Robots per team that may connect."""
    lease_s: float
    """A session ends when its client has sent nothing for so long."""
    diagonal_m: float
    """Of the field: a client's mirror must reach so far."""
    mirrors: Mapping[tuple[Team, int], Mirror]
    """Of each robot, by team and number."""
    admission: Admission
    own_mirrors: bool = True
    """Clients may choose another mirror; not in a match."""

    def mirror_of(self, session: Session) -> Mirror:
        """The mirror through which a session's robot sees."""
        own = session.init.options.mirror if self.own_mirrors else None
        return own or self.mirrors[session.team, session.number]

    def fixes(self, session: Session) -> bool:
        """Does the match fix something that a session's client has asked for?"""
        return session.init.options.mirror is not None and not self.own_mirrors


@dataclass(slots=True)
class DatagramCounts:
    """Datagrams since the start."""

    received: int = 0
    ignored: int = 0
    """Too long, without a command, or a message of a server."""
    limited: int = 0
    """Over a rate limit, and dropped unread."""
    turned_away: int = 0
    """From addresses that are not admitted."""


class Sessions:
    """The server's side of the protocol, without sockets."""

    def __init__(self, rules: SessionRules) -> None:
        self.rules = rules
        self.mode = "play_on"
        """Play mode in answers to init."""
        self.counts = DatagramCounts()
        self._by_robot: dict[tuple[Team, int], Session] = {}
        self._limiters = RateLimiterTable()
        self._stranger_limiters = RateLimiterTable()  # a table of its own: strangers cannot push others out of theirs
        self._datagrams = SharedBudget("datagrams", ALL_DATAGRAMS_RATE)
        self._inits = SharedBudget("inits", ALL_INITS_RATE)
        self._strangers = TokenBucket(STRANGER_RATE)

    def __iter__(self) -> Iterator[Session]:
        return iter(tuple(self._by_robot.values()))

    def __len__(self) -> int:
        return len(self._by_robot)

    def receive(self, datagram: bytes, peer: Peer, endpoint: Endpoint, now: Instant) -> list[Event]:
        """The events that follow from a datagram."""
        self.counts.received += 1
        if len(datagram) > MAX_COMMAND:
            self.counts.ignored += 1
            return []
        owned = self._owned_by(peer)
        if not owned and not self.rules.admission.admits(peer.host):
            return self._turn_away(datagram, peer, endpoint, now)
        limiter = owned[0].limiter if owned else self._limiters.of(peer.host)
        if not (limiter.take(DATAGRAM, now) and (owned or self._datagrams.take(limiter, now))):
            self.counts.limited += 1
            return []
        request = decode_commands(datagram)
        if request is None:
            self.counts.ignored += 1
            return []
        for session in owned:
            session.heard = now
            if endpoint.port is Port.SESSION:
                session.inits = 0
                session.step(SessionTrigger.SPOKE)
        return self._dispatch_all(request, limiter, peer, endpoint, now)

    def refused(self, session: Session, now: Instant) -> list[Event]:
        """The computer of a session's client reports that the port is closed."""
        at_once = seconds_between(session.inited, now) <= AT_ONCE_S
        return self._step(session, SessionTrigger.REFUSED_AT_ONCE if at_once else SessionTrigger.REFUSED)

    def close(self, session: Session, reason: SessionTrigger = SessionTrigger.STOPPED) -> list[Event]:
        """End a session."""
        return self._step(session, reason)

    def apply(self, rules: SessionRules, mode: str) -> list[Event]:
        """Go on with other rules of the same boot; mode: of the play. Sessions that they do not allow end."""
        before = self.rules
        self.rules, self.mode = rules, mode
        events: list[Event] = []
        for session in self:
            if not rules.admission.admits_as(session.peer.host, session.team, session.number):
                events += self.end(session, ErrorCode.NOT_ADMITTED)
            elif session.number > rules.numbers:
                events += self.end(session, ErrorCode.ILLEGAL_NUMBER)
            elif rules.fixes(session) and not before.fixes(session):
                events.append(_reply(WarningReply(FIXED_BY_MATCH), session))
        return events

    def end(self, session: Session, why: ErrorCode) -> list[Event]:
        """End a session and tell its client why."""
        return [_reply(ErrorReply(why), session), *self.close(session)]

    def not_opened(self, session: Session) -> list[Event]:
        """There is no socket for a session: end it and tell its client."""
        full = _error(ErrorCode.SERVER_FULL, session.nul, session.peer, Endpoint(Port.MAIN, session.local))
        return [*self.close(session), full, _refusal(ErrorCode.SERVER_FULL, session.peer, session.init)]

    def expire(self, now: Instant) -> list[Event]:
        """End the sessions whose client has sent nothing for the lease."""
        events: list[Event] = []
        for session in self:
            if seconds_between(session.heard, now) > self.rules.lease_s:
                events += self._step(session, SessionTrigger.SILENT)
        return events

    def snapshot(self) -> bytes:
        """All sessions as JSON in one line, for ``restore`` in another process."""
        sessions = [session.to_plain() for session in self]
        return json.dumps({"snapshot": SNAPSHOT, "boot": self.rules.boot, "sessions": sessions}).encode("ascii")

    @staticmethod
    def restore(rules: SessionRules, snapshot: bytes) -> "Sessions":
        """The sessions of a snapshot. Raises ValueError unless it is one of this version and the same boot."""
        restored = Sessions(rules)
        try:
            plain = json.loads(snapshot)
            if (plain["snapshot"], plain["boot"]) != (SNAPSHOT, rules.boot):
                raise ValueError(f"a snapshot of version {plain['snapshot']}, boot {plain['boot']}")
            for one in plain["sessions"]:
                session = Session.from_plain(one)
                restored._by_robot[session.team, session.number] = session
        except (KeyError, TypeError, AttributeError) as error:
            raise ValueError(f"not a snapshot of sessions: {error!r}") from None
        return restored

    def _owned_by(self, peer: Peer) -> list[Session]:
        """The sessions of a client's socket, one per robot."""
        return [session for session in self._by_robot.values() if session.peer == peer]

    def _turn_away(self, datagram: bytes, peer: Peer, endpoint: Endpoint, now: Instant) -> list[Event]:
        """The answer to an address that is not admitted: an error at most once in 5 s, or silence."""
        self.counts.turned_away += 1
        if not self._strangers.take(now):
            self.counts.limited += 1
            return []
        request = decode_commands(datagram)
        if request is None:
            return []
        refusal = _refusal(ErrorCode.NOT_ADMITTED, peer, request.commands[0])
        reply = _error(ErrorCode.NOT_ADMITTED, request.nul, peer, endpoint)
        limiter = self._stranger_limiters.of(peer.host)
        too_long = len(reply.data) > AMPLIFICATION * len(datagram)
        is_silent = too_long or not limiter.may_complain(ErrorCode.NOT_ADMITTED, now)
        return [refusal] if is_silent else [reply, refusal]

    def _dispatch_all(
        self, request: Request, limiter: RateLimiter, peer: Peer, endpoint: Endpoint, now: Instant
    ) -> list[Event]:
        """The events that follow from the commands of a datagram, up to the first that is refused."""
        events: list[Event] = []
        for command in request.commands:
            if limiter.take(_name_of(command), now):
                result = self._dispatch(command, request.nul, peer, endpoint, now)
            else:
                result = ErrorCode.RATE_LIMITED
            if isinstance(result, ErrorCode):
                if result not in LIMITED_ERRORS or limiter.may_complain(result, now):
                    events += [_error(result, request.nul, peer, endpoint), _refusal(result, peer, command)]
                break
            events += result
        return events

    def _dispatch(
        self, command: Command, nul: bool, peer: Peer, endpoint: Endpoint, now: Instant
    ) -> list[Event] | ErrorCode:
        """The events that follow from a command, or why it is refused."""
        match command:
            case InvalidCommand(error):
                return error
            case Init():
                return self._init(command, nul, peer, endpoint, now)
        session = self._addressed(command, peer)
        if isinstance(session, ErrorCode):
            return session
        match command:
            case Bye():
                return self._step(session, SessionTrigger.LEFT)
            case LagReport():
                return [LagReported(session, command, now)]
            case MirrorQuery(team, number):
                return [_reply(MirrorReply(self.rules.mirror_of(session), team, number), session)]

    def _addressed(self, command: Bye | LagReport | MirrorQuery, peer: Peer) -> Session | ErrorCode:
        """The session that a command is about: that of the robot it names, or the only one of the client's socket."""
        owned = self._owned_by(peer)
        if command.team is not None:
            owned = [session for session in owned if (session.team, session.number) == (command.team, command.number)]
        elif len(owned) > 1:
            return ErrorCode.ILLEGAL_FORM
        return owned[0] if owned else ErrorCode.NOT_CONNECTED

    def _init(self, init: Init, nul: bool, peer: Peer, endpoint: Endpoint, now: Instant) -> list[Event] | ErrorCode:
        holder = self._by_robot.get((init.team, init.number))
        repeated = holder is not None and holder.peer == peer
        if not repeated and not self._inits.take(self._limiters.of(peer.host), now):
            return ErrorCode.RATE_LIMITED
        if init.number > self.rules.numbers:
            return ErrorCode.ILLEGAL_NUMBER
        if not self.rules.admission.admits_as(peer.host, init.team, init.number):
            return ErrorCode.NOT_ADMITTED
        if init.options.mirror is not None:
            try:
                check_span(init.options.mirror, self.rules.diagonal_m)
            except SettingsError:
                return ErrorCode.ILLEGAL_MIRROR
        if holder is None:
            return self._open(init, nul, peer, endpoint, now)
        if holder.peer == peer:
            return self._repeat(holder, init, nul, now)
        if holder.peer.host != peer.host:
            return ErrorCode.ALREADY_CONNECTED
        return [*self._replace(holder), *self._open(init, nul, peer, endpoint, now)]

    def _replace(self, holder: Session) -> list[Event]:
        """Tell a client that a newer one on its computer takes the robot over, and end its session."""
        reply = _reply(ErrorReply(ErrorCode.REPLACED), holder)
        return [reply, *self._step(holder, SessionTrigger.REPLACED)]

    def _open(self, init: Init, nul: bool, peer: Peer, endpoint: Endpoint, now: Instant) -> list[Event]:
        state = SessionState.SAME_PORT if init.options.port_same else SessionState.TRYING
        session = Session(init, nul, peer, endpoint.local, now, state, heard=now, inited=now)
        self._by_robot[init.team, init.number] = session
        return [SessionOpened(session), *self._answers(session)]

    def _repeat(self, session: Session, init: Init, nul: bool, now: Instant) -> list[Event]:
        """Answer an init of the same client again: the answer was lost, or the client asks for other options."""
        equal = init == session.init and seconds_between(session.inited, now) <= REPEAT_S
        session.inits = session.inits + 1 if equal else 1
        changed = (init, nul) != (session.init, session.nul)
        session.init, session.nul, session.inited = init, nul, now
        moved: list[Event] = []
        if init.options.port_same or session.inits >= UNHEARD_INITS:
            moved = self._step(session, SessionTrigger.UNHEARD)
        return [*([SessionChanged(session)] if changed else []), *(moved or self._answers(session))]

    def _step(self, session: Session, trigger: SessionTrigger) -> list[Event]:
        if not session.step(trigger):
            return []
        if session.state is SessionState.CLOSED:
            del self._by_robot[session.team, session.number]
            return [SessionClosed(session, trigger)]
        return [SessionMoved(session), *self._answers(session)]

    def _answers(self, session: Session) -> list[Reply]:
        """The answer to an init."""
        answers = [_reply(InitReply(session.team, session.number, self.mode), session)]
        if session.init.unknown_options:
            answers.append(_reply(WarningReply("unknown_option"), session))
        if self.rules.fixes(session):
            answers.append(_reply(WarningReply(FIXED_BY_MATCH), session))
        return answers


def _name_of(command: Command) -> str:
    """The name that a command is counted under."""
    match command:
        case Init():
            return "init"
        case Bye():
            return "bye"
        case LagReport():
            return "lag"
        case MirrorQuery():
            return "mirror"
        case InvalidCommand():
            return INVALID


def _reply(message: InitReply | MirrorReply | ErrorReply | WarningReply, session: Session) -> Reply:
    """A message to the client of a session."""
    endpoint = Endpoint(session.port, session.local)
    return Reply(encode(message) + (b"\0" if session.nul else b""), session.peer, endpoint, session)


def _refusal(error: ErrorCode, peer: Peer, command: Command) -> RequestRefused:
    """For the operator: what was refused, and for which robot."""
    if isinstance(command, Init):
        return RequestRefused(peer, error, command.team, command.number)
    return RequestRefused(peer, error)


def _error(code: ErrorCode, nul: bool, to: Peer, via: Endpoint) -> Reply:
    """An error to an address, whether or not it has a session."""
    return Reply(encode(ErrorReply(code)) + (b"\0" if nul else b""), to, via)
