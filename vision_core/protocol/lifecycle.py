"""One session: its protocol state, and its form as plain data.

A session begins by answering from the session port. A client that does not receive from that port repeats its init,
or its computer refuses the first answer; the session then answers from the port that the init was sent to.
``TRANSITIONS`` holds every transition; a trigger that is not in it changes nothing.

What a session was sent, and when it is due again, is not here but in its row of ``vision_core.net.delivery``.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from types import MappingProxyType
from typing import Any, NamedTuple

from vision_core.clock import Instant, seconds_between
from vision_core.protocol.commands import decode_commands
from vision_core.protocol.encoding import encode
from vision_core.protocol.messages import Init
from vision_core.protocol.options import HIGHEST_VERSION, PAPER_OPTIONS, Options
from vision_core.protocol.rate_limits import RateLimiter
from vision_core.types.objects import Team

FORSAKEN_S = 10.0
"""For so long after the network has said that no computer has an address, another client may have the robot. The kernel
asks the local network three times, once a second, before it says so (arp(7)); while views are sent it asks again."""


class Peer(NamedTuple):
    """A client's address. The scope is that of an IPv6 link-local address, 0 elsewhere."""

    host: str
    port: int
    scope: int = 0


class Port(StrEnum):
    """The server's two ports."""

    MAIN = "main"
    SESSION = "session"


class SessionState(StrEnum):
    """Which port a session answers from, and whether its client is known to receive from there."""

    TRYING = "trying"
    """Answers come from the session port; whether the client receives them is not known."""
    SETTLED = "settled"
    """The client has sent something to the session port."""
    SAME_PORT = "same_port"
    """Answers come from the main port."""
    CLOSED = "closed"


class SessionTrigger(StrEnum):
    """What may change a session's state."""

    SPOKE = "spoke"
    """A datagram came to the session port."""
    UNHEARD = "unheard"
    """The same init came for the third time, or with ``(port same)``."""
    REFUSED_AT_ONCE = "refused_at_once"
    """The client's computer reports a closed port, right after an init."""
    REFUSED = "refused"
    """The client's computer reports a closed port later: the client has ended."""
    LEFT = "left"
    """``(bye)``."""
    SILENT = "silent"
    """No datagram of the client came within the lease."""
    REPLACED = "replaced"
    """A newer client has the robot."""
    STOPPED = "stopped"
    """The operator ended it, the match ended, or there is no socket for it."""


TRANSITIONS: Mapping[tuple[SessionState, SessionTrigger], SessionState] = MappingProxyType(
    {
        (SessionState.TRYING, SessionTrigger.SPOKE): SessionState.SETTLED,
        (SessionState.TRYING, SessionTrigger.UNHEARD): SessionState.SAME_PORT,
        (SessionState.SETTLED, SessionTrigger.UNHEARD): SessionState.SAME_PORT,
        (SessionState.TRYING, SessionTrigger.REFUSED_AT_ONCE): SessionState.SAME_PORT,
        (SessionState.SETTLED, SessionTrigger.REFUSED_AT_ONCE): SessionState.CLOSED,
        (SessionState.SAME_PORT, SessionTrigger.REFUSED_AT_ONCE): SessionState.CLOSED,
    }
    | {
        (state, trigger): SessionState.CLOSED
        for state in (SessionState.TRYING, SessionState.SETTLED, SessionState.SAME_PORT)
        for trigger in (
            SessionTrigger.REFUSED,
            SessionTrigger.LEFT,
            SessionTrigger.SILENT,
            SessionTrigger.REPLACED,
            SessionTrigger.STOPPED,
        )
    }
)


@dataclass(frozen=True, slots=True)
class Claim:
    """Another client on the owner's computer asks for the robot: it waits until the owner fails to answer."""

    init: Init
    nul: bool
    peer: Peer
    port: Port
    """Where the claim arrived, and our address there."""
    local: str
    at: Instant


@dataclass(slots=True, eq=False)
class Session:
    """The protocol state of one client's control of one robot. Only ``Sessions`` changes it."""

    init: Init
    nul: bool
    """Messages end with NUL."""
    peer: Peer
    local: str
    """Our address that the init came to."""
    opened: Instant
    state: SessionState
    heard: Instant
    """Last datagram of the client."""
    inited: Instant
    """Last init."""
    inits: int = 1
    """Equal inits in a row, with no other datagram in between."""
    limiter: RateLimiter = field(default_factory=RateLimiter)
    options: Options = PAPER_OPTIONS
    """What the client gets of what it asks for: ``SessionRules.granted``."""
    has_key: bool = False
    """It was opened with the team's key, so its address need not be admitted."""
    claim: Claim | None = None
    unreachable: Instant | None = None
    """When the network said last that no computer has the client's address."""

    @property
    def version(self) -> int:
        """Of the protocol, as the client speaks it."""
        return min(self.init.options.version, HIGHEST_VERSION)

    @property
    def team(self) -> Team:
        """Team of the robot."""
        return self.init.team

    @property
    def number(self) -> int:
        """Number of the robot."""
        return self.init.number

    @property
    def port(self) -> Port:
        """The port that its messages come from."""
        return Port.MAIN if self.state is SessionState.SAME_PORT else Port.SESSION

    def step(self, trigger: SessionTrigger) -> bool:
        """Follow the table of transitions; did the state change?"""
        after = TRANSITIONS.get((self.state, trigger), self.state)
        changed, self.state = after is not self.state, after
        return changed

    def is_forsaken(self, now: Instant) -> bool:
        """Was the client never heard, and is nothing at its address? Its init may have had a forged sender."""
        if self.state is not SessionState.TRYING or self.unreachable is None:
            return False
        return seconds_between(self.unreachable, now) <= FORSAKEN_S

    def to_plain(self) -> dict[str, Any]:
        """Everything that a restarted server needs, as JSON types. Rate limits and claims begin anew there."""
        return {
            "init": encode(self.init).decode("ascii"),
            "unknown_options": self.init.unknown_options,
            "nul": self.nul,
            "peer": list(self.peer),
            "local": self.local,
            "state": self.state.value,
            "opened": self.opened,
            "heard": self.heard,
            "inited": self.inited,
            "inits": self.inits,
            "has_key": self.has_key,
        }

    @staticmethod
    def from_plain(plain: Mapping[str, Any]) -> "Session":
        """The inverse. Raises KeyError, TypeError or ValueError for anything else."""
        request = decode_commands(plain["init"].encode("ascii"))
        if request is None or not isinstance(init := request.commands[0], Init):
            raise ValueError(f"init of a session: {plain['init']!r}")
        host, port, scope = plain["peer"]
        return Session(
            Init(init.team, init.number, init.options, bool(plain["unknown_options"])),
            bool(plain["nul"]),
            Peer(str(host), int(port), int(scope)),
            str(plain["local"]),
            opened=Instant(plain["opened"]),
            state=SessionState(plain["state"]),
            heard=Instant(plain["heard"]),
            inited=Instant(plain["inited"]),
            inits=int(plain["inits"]),
            has_key=bool(plain["has_key"]),
        )
