"""All sessions of a server: datagrams and instants in, replies and events out.

The owner of the sockets (``vision_core.net.server``) calls ``receive`` for every datagram, ``refused`` when a client's
computer reports a closed port, and ``expire`` once a second or so. It applies the events in order: it opens, moves and
closes the sockets of sessions, and sends the replies.
"""

import json
from collections.abc import Iterator
from dataclasses import replace

from vision_core.clock import NS_PER_US, Instant, seconds_between
from vision_core.protocol.commands import MAX_COMMAND, decode_commands
from vision_core.protocol.door import Door
from vision_core.protocol.driving import Drive
from vision_core.protocol.encoding import Answer
from vision_core.protocol.error_codes import ErrorCode
from vision_core.protocol.events import (
    Driven,
    Endpoint,
    Event,
    LagReported,
    Reply,
    Sender,
    SessionChanged,
    SessionClosed,
    SessionMoved,
    SessionOpened,
    SyncAsked,
    answer,
    refusal,
    reply_to,
)
from vision_core.protocol.lifecycle import Claim, Peer, Port, Session, SessionState, SessionTrigger
from vision_core.protocol.messages import (
    FIXED_BY_MATCH,
    UNKNOWN_OPTION,
    Bye,
    Command,
    ErrorReply,
    Hear,
    Init,
    InitReply,
    InvalidCommand,
    LagReport,
    MirrorQuery,
    MirrorReply,
    MonitorInit,
    Ok,
    Ping,
    Pong,
    Reconnect,
    Request,
    RobotCommand,
    Set,
    Sync,
    WarningReply,
)
from vision_core.protocol.monitors import Monitors
from vision_core.protocol.options import encode_mirror, options_from_forms
from vision_core.protocol.proofs import NO_PROOF
from vision_core.protocol.rate_limits import DRIVE_RATE, INVALID, RateLimiter
from vision_core.protocol.rules import SessionRules
from vision_core.types.datagrams import DatagramCounts
from vision_core.types.objects import Team

UNHEARD_INITS = 3
"""After so many equal inits the client is taken not to receive from the session port."""
REPEAT_S = 10.0
"""An equal init that comes so soon after the last one is a repetition."""
AT_ONCE_S = 2.0
"""A closed port reported so soon after an init: the client does not receive from this port. Later: it has ended."""
CLAIM_S = 1.0
"""For so long the owner of a robot may answer when another client on its computer asks for the robot."""
LIMITED_ERRORS = frozenset(
    {
        ErrorCode.ILLEGAL_FORM,
        ErrorCode.UNKNOWN_COMMAND,
        ErrorCode.NOT_CONNECTED,
        ErrorCode.RATE_LIMITED,
        ErrorCode.NOT_ADMITTED,
        ErrorCode.ILLEGAL_DRIVE,
        ErrorCode.NO_DRIVE,
    }
)
"""Errors that one sender is told at most once in 5 s. The others, about an init, it is told each time."""
SNAPSHOT = 4
"""Version of the form of a snapshot."""


class Sessions:
    """The server's side of the protocol, without sockets."""

    def __init__(self, rules: SessionRules) -> None:
        self.mode = "play_on"
        """Play mode in answers to init."""
        self.counts = DatagramCounts()
        self._by_robot: dict[tuple[Team, int], Session] = {}
        self._door = Door(rules)
        self.monitors = Monitors(self._door)

    @property
    def rules(self) -> SessionRules:
        """What the server prescribes."""
        return self._door.rules

    def __iter__(self) -> Iterator[Session]:
        return iter(tuple(self._by_robot.values()))

    def __len__(self) -> int:
        return len(self._by_robot)

    def receive(
        self, datagram: bytes, peer: Peer, endpoint: Endpoint, now: Instant, arrived: Instant | None = None
    ) -> list[Event]:
        """The events that follow from a datagram. arrived: when the kernel received it; None: now."""
        self.counts.received += 1
        if len(datagram) > MAX_COMMAND:
            self.counts.ignored += 1
            return []
        owned, monitor = self._owned_by(peer), self.monitors.get(peer)
        known = owned[0] if owned else monitor
        if known is None and not self.rules.admission.admits(peer.host):
            return self._turn_away(datagram, Sender(peer, endpoint, now, now))
        limiter = known.limiter if known else self._door.limiter(peer.host)
        if not self._door.lets_in(limiter, now, known=known is not None):
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
        if monitor is not None:
            monitor.heard = now
        return self._dispatch_all(request, limiter, Sender(peer, endpoint, now, arrived or now))

    def refused(self, session: Session, now: Instant) -> list[Event]:
        """The computer of a session's client reports that the port is closed."""
        at_once = seconds_between(session.inited, now) <= AT_ONCE_S and session.claim is None
        return self._step(session, SessionTrigger.REFUSED_AT_ONCE if at_once else SessionTrigger.REFUSED, now)

    def close(self, session: Session, now: Instant, reason: SessionTrigger = SessionTrigger.STOPPED) -> list[Event]:
        """End a session."""
        return self._step(session, reason, now)

    def apply(self, rules: SessionRules, mode: str, now: Instant) -> list[Event]:
        """Go on with other rules of the same boot; mode: of the play. Sessions that they do not allow end."""
        before, mode_before = self.rules, self.mode
        self._door.rules, self.mode = rules, mode
        events = self.monitors.recheck(key_changed=rules.monitor_key != before.monitor_key)
        for session in self:
            mirror, was_fixed, granted = before.mirror_of(session), before.fixes(session), session.options
            session.options = rules.granted(session.init.options)
            session.has_key &= rules.keys.get(session.team) == before.keys.get(session.team)
            if not self._door.admits(session.init, session.peer, has_key=session.has_key):
                events += self.end(session, ErrorCode.NOT_ADMITTED, now)
                continue
            if session.number > rules.numbers:
                events += self.end(session, ErrorCode.ILLEGAL_NUMBER, now)
                continue
            if rules.fixes(session) and not was_fixed:
                events.append(reply_to(session, WarningReply(FIXED_BY_MATCH)))
            if session.version > 1 and session.options != granted:
                events.append(self._granted(session, now))
            if session.version > 1 and (after := rules.mirror_of(session)) != mirror:
                events.append(self._hear(session, now, "mirror", encode_mirror(after)))
        return events + (self.tell(mode, now) if mode != mode_before else [])

    def tell(self, word: str, now: Instant) -> list[Event]:
        """Tell every session of version 2, and every monitor, a word of the referee: a play mode, ``vision_lost``,
        ``vision_back``."""
        heard = [self._hear(session, now, "referee", word) for session in self if session.version > 1]
        return [*heard, *self.monitors.tell(self._heard(now, "referee", word))]

    def end(self, session: Session, why: ErrorCode, now: Instant) -> list[Event]:
        """End a session and tell its client why."""
        return [reply_to(session, ErrorReply(why)), *self.close(session, now)]

    def not_opened(self, session: Session, now: Instant) -> list[Event]:
        """There is no socket for a session: end it and tell its client."""
        full = answer(ErrorReply(ErrorCode.SERVER_FULL), session.nul, session.peer, Endpoint(Port.MAIN, session.local))
        return [*self.close(session, now), full, refusal(ErrorCode.SERVER_FULL, session.peer, session.init)]

    def expire(self, now: Instant) -> list[Event]:
        """End sessions and monitors that have sent nothing for the lease, and decide the claims to robots."""
        self.monitors.expire(now)
        events: list[Event] = []
        for session in self:
            if seconds_between(session.heard, now) > self.rules.lease_of(session):
                events += self._step(session, SessionTrigger.SILENT, now)
            elif session.claim is not None and seconds_between(session.claim.at, now) > CLAIM_S:
                events += self._decide_claim(session, session.claim, now)
        return events

    def snapshot(self) -> bytes:
        """All sessions as JSON in one line, for ``restore`` in another process."""
        sessions = [session.to_plain() for session in self]
        plain = {"snapshot": SNAPSHOT, "boot": self.rules.boot, "sessions": sessions}
        return json.dumps({**plain, "monitors": self.monitors.to_plain()}).encode("ascii")

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
                session.options = rules.granted(session.init.options)
                restored._by_robot[session.team, session.number] = session
            restored.monitors.restore(plain["monitors"])
        except (KeyError, TypeError, AttributeError) as error:
            raise ValueError(f"not a snapshot of sessions: {error!r}") from None
        return restored

    def _owned_by(self, peer: Peer) -> list[Session]:
        """The sessions of a client's socket, one per robot."""
        return [session for session in self._by_robot.values() if session.peer == peer]

    def _turn_away(self, datagram: bytes, sender: Sender) -> list[Event]:
        """Answer an address that is not admitted. With the key of its team it is answered like any other."""
        self.counts.turned_away += 1
        if not self._door.hears_stranger(sender.now):
            self.counts.limited += 1
            return []
        request = decode_commands(datagram)
        if request is None:
            self.counts.ignored += 1
            return []
        command = request.commands[0]
        if isinstance(command, Init | Reconnect | MonitorInit) and command.proof.key:
            challenge = self._door.challenge(command, request.nul, sender)
            if challenge or self._door.holds_key(command):
                one = Request((command,), request.nul)
                return challenge or self._dispatch_all(one, self._door.limiter(sender.peer.host), sender)
        return self._door.turn_away(request, len(datagram), sender)

    def _dispatch_all(self, request: Request, limiter: RateLimiter, sender: Sender) -> list[Event]:
        """The events that follow from the commands of a datagram, up to the first that is refused."""
        events: list[Event] = []
        for command in request.commands:
            rate = DRIVE_RATE if isinstance(command, Drive) else None
            if limiter.take(_name_of(command), sender.now, rate):
                result = self._dispatch(command, request.nul, sender)
            else:
                result = ErrorCode.RATE_LIMITED
            if isinstance(result, ErrorCode):
                if result not in LIMITED_ERRORS or limiter.may_complain(result, sender.now):
                    error = answer(ErrorReply(result), request.nul, sender.peer, sender.endpoint)
                    events += [error, refusal(result, sender.peer, command)]
                break
            events += result
        return events

    def _dispatch(self, command: Command, nul: bool, sender: Sender) -> list[Event] | ErrorCode:
        """The events that follow from a command, or why it is refused."""
        match command:
            case InvalidCommand(error):
                return error
            case Init():
                return self._init(command, nul, sender)
            case Reconnect():
                return self._reconnect(command, nul, sender)
            case MonitorInit():
                return self.monitors.open(command, nul, sender, self.mode)
            case Bye(None) if not self._owned_by(sender.peer) and self.monitors.close(sender.peer):
                return []
            case Ping(number):
                return [answer(Pong(number), nul, sender.peer, sender.endpoint)]
            case Sync():
                owned = self._owned_by(sender.peer)
                return [SyncAsked(owned[0], command, sender.arrived)] if owned else ErrorCode.NOT_CONNECTED
        session = self._addressed(command, sender.peer)
        return session if isinstance(session, ErrorCode) else self._of_session(session, command, sender.now)

    def _of_session(self, session: Session, command: RobotCommand, now: Instant) -> list[Event] | ErrorCode:
        """The events that follow from a command about a session."""
        match command:
            case Bye():
                return self._step(session, SessionTrigger.LEFT, now)
            case LagReport():
                return [LagReported(session, command, now)]
            case MirrorQuery(team, number):
                return [reply_to(session, MirrorReply(self.rules.mirror_of(session), team, number))]
            case Set():
                return self._set(session, command)
            case Drive():
                return self._drive(session, command, now)

    def _drive(self, session: Session, drive: Drive, now: Instant) -> list[Event] | ErrorCode:
        """A command for the robot of a session, which answers nothing when it is taken."""
        limits = self.rules.drives.get((session.team, session.number))
        if limits is None:
            return ErrorCode.NO_DRIVE
        return [Driven(session, drive, now)] if limits.allow(drive) else ErrorCode.ILLEGAL_DRIVE

    def _addressed(self, command: RobotCommand, peer: Peer) -> Session | ErrorCode:
        """The session that a command is about: that of the robot it names, or the only one of the client's socket."""
        owned = self._owned_by(peer)
        if command.team is not None:
            owned = [session for session in owned if (session.team, session.number) == (command.team, command.number)]
        elif len(owned) > 1:
            return ErrorCode.ILLEGAL_FORM
        return owned[0] if owned else ErrorCode.NOT_CONNECTED

    def _init(self, init: Init, nul: bool, sender: Sender) -> list[Event] | ErrorCode:
        holder = self._by_robot.get((init.team, init.number))
        own = holder if holder is not None and holder.peer == sender.peer else None
        if own is None and not self._door.takes_init(sender):
            return ErrorCode.RATE_LIMITED
        if challenge := self._door.challenge(init, nul, sender):
            return challenge
        if own is not None and init.options.version < own.version:  # a forged sender returns no cookie
            return ErrorCode.ILLEGAL_OPTION
        has_key = self._door.holds_key(init)
        error = self._door.refuses(init, sender.peer, has_key=has_key or (own is not None and own.has_key))
        if error is not None:
            return error
        if holder is None:
            return self._open(init, nul, sender, has_key=has_key)
        if own is not None:
            return self._repeat(own, init, nul, sender)
        return self._take_over(holder, init, nul, sender, has_key=has_key)

    def _take_over(
        self, holder: Session, init: Init, nul: bool, sender: Sender, *, has_key: bool
    ) -> list[Event] | ErrorCode:
        """Another client asks for a robot that has a session."""
        same_computer = holder.peer.host == sender.peer.host
        proven = same_computer and init.options.version > 1  # by its cookie
        if has_key or proven or holder.is_forsaken(sender.now):
            return [*self._replace(holder, sender.now), *self._open(init, nul, sender, has_key=has_key)]
        return self._claim(holder, init, nul, sender) if same_computer else ErrorCode.ALREADY_CONNECTED

    def _reconnect(self, command: Reconnect, nul: bool, sender: Sender) -> list[Event] | ErrorCode:
        """A team's client goes on with its robot from another address; its options stay."""
        if challenge := self._door.challenge(command, nul, sender):
            return challenge
        if not self._door.holds_key(command):
            return ErrorCode.WRONG_KEY
        holder = self._by_robot.get((command.team, command.number))
        if holder is None:
            return ErrorCode.NOT_CONNECTED
        if holder.peer == sender.peer:
            return [*self._answers(holder, sender.now)]
        init = holder.init
        return [*self._replace(holder, sender.now), *self._open(init, nul, sender, has_key=True)]

    def _replace(self, holder: Session, now: Instant) -> list[Event]:
        """Tell a client that a newer one takes the robot over, and end its session."""
        holder.claim = None
        return [reply_to(holder, ErrorReply(ErrorCode.REPLACED)), *self._step(holder, SessionTrigger.REPLACED, now)]

    def _claim(self, holder: Session, init: Init, nul: bool, sender: Sender) -> list[Event]:
        """Another client on the owner's computer asks for the robot. Whoever sent this may have forged its sender, so
        the owner is asked first: if its program has ended, its computer refuses the question."""
        earlier = holder.claim
        at = earlier.at if earlier is not None and earlier.peer == sender.peer else sender.now
        holder.claim = Claim(init, nul, sender.peer, sender.endpoint.port, sender.endpoint.local, at)
        question = Ping() if holder.version > 1 else InitReply(holder.team, holder.number, self.mode)
        return [reply_to(holder, question)]

    def _decide_claim(self, holder: Session, claim: Claim, now: Instant) -> list[Event]:
        """The time for an answer is over. A client of version 2 answers a ping; silence of version 1 says nothing."""
        holder.claim = None
        if holder.version > 1 and holder.heard <= claim.at:
            return [*self._replace(holder, now), *self._open_claim(claim, now)]
        refused = answer(
            ErrorReply(ErrorCode.ALREADY_CONNECTED), claim.nul, claim.peer, Endpoint(claim.port, claim.local)
        )
        return [refused, refusal(ErrorCode.ALREADY_CONNECTED, claim.peer, claim.init)]

    def _open_claim(self, claim: Claim, now: Instant) -> list[Event]:
        sender = Sender(claim.peer, Endpoint(claim.port, claim.local), now, now)
        return self._open(claim.init, claim.nul, sender, has_key=False)

    def _open(self, init: Init, nul: bool, sender: Sender, *, has_key: bool) -> list[Event]:
        state = SessionState.SAME_PORT if init.options.port_same else SessionState.TRYING
        init, now = replace(init, proof=NO_PROOF), sender.now
        session = Session(init, nul, sender.peer, sender.endpoint.local, now, state, heard=now, inited=now)
        session.options, session.has_key = self.rules.granted(init.options), has_key
        self._by_robot[init.team, init.number] = session
        return [SessionOpened(session), *self._answers(session, now)]

    def _repeat(self, session: Session, init: Init, nul: bool, sender: Sender) -> list[Event]:
        """Answer an init of the same client again: the answer was lost, the client asks for other options, or it has
        found us at another of our addresses."""
        now, local = sender.now, sender.endpoint.local
        equal = init == session.init and seconds_between(session.inited, now) <= REPEAT_S
        session.inits = session.inits + 1 if equal else 1
        changed, elsewhere = (init, nul) != (session.init, session.nul), local != session.local
        session.init, session.nul, session.inited = replace(init, proof=NO_PROOF), nul, now
        session.options, session.local = self.rules.granted(init.options), local
        moved: list[Event] = []
        if init.options.port_same or session.inits >= UNHEARD_INITS:
            moved = self._step(session, SessionTrigger.UNHEARD, now)
        if not moved:
            moved = [*([SessionMoved(session)] if elsewhere else []), *self._answers(session, now)]
        return [*([SessionChanged(session)] if changed else []), *moved]

    def _set(self, session: Session, command: Set) -> list[Event] | ErrorCode:
        """Other options for a session. Version and port are fixed by its init."""
        asked = session.init.options
        found = options_from_forms(command.forms, asked)
        if isinstance(found, ErrorCode):
            return found
        options, unknown = found
        if (options.version, options.port_same) != (asked.version, asked.port_same):
            return ErrorCode.ILLEGAL_OPTION
        if not self._door.shows_field(options):
            return ErrorCode.ILLEGAL_MIRROR
        session.init = replace(session.init, options=options)
        session.options = self.rules.granted(options)
        messages: list[Answer] = [Ok("set"), *self._warnings(session, unknown=unknown)]
        return [SessionChanged(session), *(reply_to(session, message) for message in messages)]

    def _step(self, session: Session, trigger: SessionTrigger, now: Instant) -> list[Event]:
        if not session.step(trigger):
            return []
        if session.state is not SessionState.CLOSED:
            return [SessionMoved(session), *self._answers(session, now)]
        del self._by_robot[session.team, session.number]
        claim, session.claim = session.claim, None
        return [SessionClosed(session, trigger), *(self._open_claim(claim, now) if claim else [])]

    def _answers(self, session: Session, now: Instant) -> list[Reply]:
        """The answer to an init."""
        warnings = self._warnings(session, unknown=session.init.unknown_options)
        return [self._granted(session, now), *(reply_to(session, warning) for warning in warnings)]

    def _granted(self, session: Session, now: Instant) -> Reply:
        """What a session has; in version 2 also what its views are like."""
        facts = self.rules.facts_of(session, now) if session.version > 1 else None
        return reply_to(session, InitReply(session.team, session.number, self.mode, facts))

    def _warnings(self, session: Session, *, unknown: bool) -> list[Answer]:
        names = [UNKNOWN_OPTION] * unknown + [FIXED_BY_MATCH] * self.rules.fixes(session)
        return [WarningReply(name) for name in names]

    def _hear(self, session: Session, now: Instant, sender: str, *words: str) -> Reply:
        return reply_to(session, self._heard(now, sender, *words))

    def _heard(self, now: Instant, sender: str, *words: str) -> Hear:
        return Hear((now - self.rules.boot) // NS_PER_US, sender, words)


def _name_of(command: Command) -> str:
    """The name that a command is counted under."""
    match command:
        case InvalidCommand():
            return INVALID
        case LagReport():
            return "lag"
        case MirrorQuery():
            return "mirror"
        case Drive(team=team, number=number):
            return f"drive {team} {number}"
    return type(command).__name__.lower()
