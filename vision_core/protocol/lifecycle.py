"""One session: its state, when it wants a ``see``, and its form as plain data.

A session begins by answering from the session port. A client that cannot hear that port shows it by
repeating its init, or its machine refuses the first answer: then the session goes over to the port that
init was sent to. The table holds every transition; what is not in it changes nothing.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from types import MappingProxyType
from typing import Any, NamedTuple

from vision_core.clock import NS_PER_S, Instant, seconds_between
from vision_core.protocol.codec import decode_commands, encode
from vision_core.protocol.messages import MAX_LAG_S, Init, Lag
from vision_core.protocol.rate_limits import Allowance
from vision_core.types.objects import Team

NS_PER_TICK = {"ms": 1_000_000, "us": 1_000}
NS_PER_US = 1_000
NEVER = Instant(-1)
REPORT_PERIOD_S = 0.5
"""A client's reports that come faster than this are passed over."""


class Peer(NamedTuple):
    """A client's address. The scope is that of an IPv6 link-local address, 0 elsewhere."""

    host: str
    port: int
    scope: int = 0


class Port(StrEnum):
    """The server's two ports."""

    MAIN = "main"
    SESSION = "session"


class State(StrEnum):
    TRYING = "trying"
    """Answers come from the session port; whether the client hears them is not known."""
    SETTLED = "settled"
    """The client has spoken to the session port."""
    SAME_PORT = "same_port"
    """Answers come from the main port."""
    CLOSED = "closed"


class Change(StrEnum):
    SPOKE = "spoke"
    """A datagram came to the session port."""
    UNHEARD = "unheard"
    """The same init for the third time, or ``(port same)``."""
    REFUSED_AT_ONCE = "refused_at_once"
    """The client's machine refuses what we send, right after an init."""
    REFUSED = "refused"
    """It refuses later: the client is gone."""
    LEFT = "left"
    """``(bye)``."""
    SILENT = "silent"
    """Nothing was heard for the lease."""
    REPLACED = "replaced"
    """A newer client has the robot."""
    STOPPED = "stopped"
    """The operator, the end of the match, or no socket for it."""


TRANSITIONS: Mapping[tuple[State, Change], State] = MappingProxyType(
    {
        (State.TRYING, Change.SPOKE): State.SETTLED,
        (State.TRYING, Change.UNHEARD): State.SAME_PORT,
        (State.SETTLED, Change.UNHEARD): State.SAME_PORT,
        (State.TRYING, Change.REFUSED_AT_ONCE): State.SAME_PORT,
        (State.SETTLED, Change.REFUSED_AT_ONCE): State.CLOSED,
        (State.SAME_PORT, Change.REFUSED_AT_ONCE): State.CLOSED,
    }
    | {
        (state, change): State.CLOSED
        for state in (State.TRYING, State.SETTLED, State.SAME_PORT)
        for change in (Change.REFUSED, Change.LEFT, Change.SILENT, Change.REPLACED, Change.STOPPED)
    }
)


@dataclass(slots=True, eq=False)
class Session:
    """A client's hold on one robot. Changed by ``Sessions`` alone; others read."""

    init: Init
    nul: bool
    """Messages end with NUL."""
    peer: Peer
    local: str
    """Our address that the init came to."""
    opened: Instant
    boot: Instant
    state: State
    heard: Instant
    """Last datagram of the client."""
    inited: Instant
    """Last init."""
    inits: int = 1
    """The same init in a row, with nothing else heard in between."""
    served: Instant = NEVER
    """Grab of the last view that was sent."""
    served_at: Instant = NEVER
    """When it was sent; NEVER also for one that an earlier process sent."""
    due: Instant = NEVER
    """With a rate: the next view's place on its grid."""
    network_s: float | None = None
    """Lag of the network, one way: half the round trip of the last view and the report on it."""
    client_s: float | None = None
    """Lag of the client, as it reports it."""
    reported: Instant = NEVER
    """Last report of the client."""
    allowance: Allowance = field(default_factory=Allowance)

    @property
    def team(self) -> Team:
        return self.init.team

    @property
    def number(self) -> int:
        return self.init.number

    @property
    def port(self) -> Port:
        """Where its views come from."""
        return Port.MAIN if self.state is State.SAME_PORT else Port.SESSION

    def wants(self, at: Instant) -> bool:
        """Should it get a view grabbed at an instant? Its Time must grow as printed, and its rate hold."""
        tick_ns = NS_PER_TICK[self.init.options.time]
        if self.served != NEVER and (at - self.boot) // tick_ns <= (self.served - self.boot) // tick_ns:
            return False
        rate_hz = self.init.options.rate_hz
        return rate_hz is None or at >= self.due - NS_PER_S // (2 * rate_hz)

    def note_report(self, lag: Lag, now: Instant) -> None:
        """A client's report on the last view that was sent; one that is late, absurd or too early changes nothing."""
        tick_ns = NS_PER_TICK[self.init.options.time]
        printed_us = (self.served - self.boot) // tick_ns * tick_ns // NS_PER_US
        if self.served_at == NEVER or lag.time_us != printed_us:
            return
        if not all(0.0 <= share_s <= MAX_LAG_S for share_s in (lag.hold_s, lag.client_s or 0.0)):
            return
        if self.reported != NEVER and seconds_between(self.reported, now) < REPORT_PERIOD_S:
            return
        self.network_s = max(seconds_between(self.served_at, now) - lag.hold_s, 0.0) / 2.0
        self.client_s, self.reported = lag.client_s, now

    def note_served(self, at: Instant) -> None:
        """A view grabbed at an instant was sent."""
        self.served = at
        if rate_hz := self.init.options.rate_hz:
            self.due = Instant(max(self.due, at) + NS_PER_S // rate_hz)

    def step(self, change: Change) -> bool:
        """Follow the table; did the state change?"""
        after = TRANSITIONS.get((self.state, change), self.state)
        changed, self.state = after is not self.state, after
        return changed

    def to_plain(self) -> dict[str, Any]:
        """Everything that a restarted server needs, as JSON types."""
        return {
            "init": encode(self.init).decode("ascii"),
            "nul": self.nul,
            "peer": list(self.peer),
            "local": self.local,
            "state": self.state.value,
            "opened": self.opened,
            "heard": self.heard,
            "inited": self.inited,
            "inits": self.inits,
            "served": self.served,
            "due": self.due,
        }

    @staticmethod
    def from_plain(plain: Mapping[str, Any], boot: Instant) -> "Session":
        """The inverse. Raises KeyError, TypeError or ValueError for anything else."""
        request = decode_commands(plain["init"].encode("ascii"))
        if request is None or not isinstance(request.commands[0], Init):
            raise ValueError(f"no init: {plain['init']!r}")
        host, port, scope = plain["peer"]
        return Session(
            request.commands[0],
            bool(plain["nul"]),
            Peer(str(host), int(port), int(scope)),
            str(plain["local"]),
            opened=Instant(plain["opened"]),
            boot=boot,
            state=State(plain["state"]),
            heard=Instant(plain["heard"]),
            inited=Instant(plain["inited"]),
            inits=int(plain["inits"]),
            served=Instant(plain["served"]),
            due=Instant(plain["due"]),
        )
