"""What follows from a datagram or an instant: the owner of the sockets carries it out, in order."""

from dataclasses import dataclass
from typing import TypeAlias

from vision_core.clock import Instant
from vision_core.protocol.driving import Drive
from vision_core.protocol.encoding import Answer, encode
from vision_core.protocol.error_codes import ErrorCode
from vision_core.protocol.lifecycle import Peer, Port, Session, SessionTrigger
from vision_core.protocol.messages import Command, Init, LagReport, Ping, Reconnect, Sync
from vision_core.types.objects import Team


@dataclass(frozen=True, slots=True)
class Endpoint:
    """Where a datagram arrived, and where its answer is sent from."""

    port: Port
    local: str
    """Our address."""


@dataclass(frozen=True, slots=True)
class Sender:
    """Who sent a datagram, whereto, and when."""

    peer: Peer
    endpoint: Endpoint
    now: Instant
    arrived: Instant
    """When the kernel received it."""


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
class Driven:
    """A client drives its robot."""

    session: Session
    drive: Drive
    at: Instant


@dataclass(frozen=True, slots=True)
class SyncAsked:
    """A client asks for the clock: the answer is stamped at the moment when it is sent."""

    session: Session
    sync: Sync
    arrived: Instant


@dataclass(frozen=True, slots=True)
class RequestRefused:
    """A request was refused; the operator is shown it."""

    peer: Peer
    error: ErrorCode
    team: Team | None = None
    """Of the robot that an init named."""
    number: int | None = None


Event: TypeAlias = (
    Reply
    | SessionOpened
    | SessionMoved
    | SessionChanged
    | SessionClosed
    | LagReported
    | Driven
    | SyncAsked
    | RequestRefused
)


def reply_to(session: Session, message: Answer | Ping) -> Reply:
    """A message to the client of a session."""
    data = encode(message) + (b"\0" if session.nul else b"")
    return Reply(data, session.peer, Endpoint(session.port, session.local), session)


def answer(message: Answer, nul: bool, to: Peer, via: Endpoint) -> Reply:
    """A message to an address, whether or not it has a session."""
    return Reply(encode(message) + (b"\0" if nul else b""), to, via)


def refusal(error: ErrorCode, peer: Peer, command: Command) -> RequestRefused:
    """For the operator: what was refused, and for which robot."""
    if isinstance(command, (Init, Reconnect)):
        return RequestRefused(peer, error, command.team, command.number)
    return RequestRefused(peer, error)
