"""Monitors: programs that are sent the whole field instead of a robot's view, as score boards and analyses.

In practice any address that may connect may have it. In a match it needs the referee's key, since nothing may give a
team the world. A monitor always returns a cookie first, and its traffic stays on the port that it asked at.
"""

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

from vision_core.clock import Instant, seconds_between
from vision_core.protocol.door import Door
from vision_core.protocol.encoding import Answer
from vision_core.protocol.error_codes import ErrorCode
from vision_core.protocol.events import Endpoint, Event, Sender, answer
from vision_core.protocol.lifecycle import Peer, Port
from vision_core.protocol.messages import ErrorReply, MonitorFacts, MonitorInit, MonitorReply
from vision_core.protocol.options import HIGHEST_VERSION
from vision_core.protocol.rate_limits import RateLimiter
from vision_core.protocol.rules import VERSION_2_LEASE_S

MAX_MONITORS = 8


@dataclass(slots=True)
class Monitor:
    """One program."""

    peer: Peer
    endpoint: Endpoint
    """Where it asked, and what it is sent from."""
    nul: bool
    """Messages end with NUL."""
    has_key: bool
    heard: Instant
    limiter: RateLimiter = field(default_factory=RateLimiter)


class Monitors:
    """The monitors of a server, without sockets. At most ``MAX_MONITORS``."""

    def __init__(self, door: Door) -> None:
        self._door = door
        self._by_peer: dict[Peer, Monitor] = {}

    def __iter__(self) -> Iterator[Monitor]:
        return iter(tuple(self._by_peer.values()))

    def __len__(self) -> int:
        return len(self._by_peer)

    def get(self, peer: Peer) -> Monitor | None:
        """The monitor at an address; None: there is none."""
        return self._by_peer.get(peer)

    def open(self, command: MonitorInit, nul: bool, sender: Sender, mode: str) -> list[Event] | ErrorCode:
        """Answer ``dispinit``. mode: of the play."""
        if challenge := self._door.challenge(command, nul, sender):
            return challenge
        has_key = self._door.holds_key(command)
        if command.proof.key and not has_key:
            return ErrorCode.WRONG_KEY
        if not self._door.admits_monitor(sender.peer, has_key=has_key):
            return ErrorCode.NOT_ADMITTED
        if sender.peer not in self._by_peer and len(self._by_peer) == MAX_MONITORS:
            return ErrorCode.SERVER_FULL
        monitor = Monitor(sender.peer, sender.endpoint, nul, has_key, sender.now)
        self._by_peer[sender.peer] = monitor
        return [self._to(monitor, MonitorReply(mode, self._facts(sender.now)))]

    def close(self, peer: Peer) -> bool:
        """Forget the monitor at an address; was there one?"""
        return self._by_peer.pop(peer, None) is not None

    def tell(self, message: Answer) -> list[Event]:
        """A message to all."""
        return [self._to(monitor, message) for monitor in self]

    def expire(self, now: Instant) -> None:
        """Forget those that were silent for the lease."""
        for monitor in self:
            if seconds_between(monitor.heard, now) > VERSION_2_LEASE_S:
                self.close(monitor.peer)

    def recheck(self, *, key_changed: bool) -> list[Event]:
        """After a change of the rules: end those that they do not allow."""
        events: list[Event] = []
        for monitor in self:
            monitor.has_key &= not key_changed
            if not self._door.admits_monitor(monitor.peer, has_key=monitor.has_key):
                self.close(monitor.peer)
                events.append(self._to(monitor, ErrorReply(ErrorCode.NOT_ADMITTED)))
        return events

    def to_plain(self) -> list[dict[str, Any]]:
        """Everything that a restarted server needs, as JSON types."""
        return [
            {
                "peer": list(monitor.peer),
                "port": monitor.endpoint.port.value,
                "local": monitor.endpoint.local,
                "nul": monitor.nul,
                "has_key": monitor.has_key,
                "heard": monitor.heard,
            }
            for monitor in self
        ]

    def restore(self, plain: list[dict[str, Any]]) -> None:
        """The inverse. Raises KeyError, TypeError or ValueError for anything else."""
        for one in plain:
            host, port, scope = one["peer"]
            peer = Peer(str(host), int(port), int(scope))
            endpoint = Endpoint(Port(one["port"]), str(one["local"]))
            self._by_peer[peer] = Monitor(peer, endpoint, one["nul"], one["has_key"], Instant(one["heard"]))

    def _to(self, monitor: Monitor, message: Answer) -> Event:
        return answer(message, monitor.nul, monitor.peer, monitor.endpoint)

    def _facts(self, now: Instant) -> MonitorFacts:
        rules = self._door.rules
        return MonitorFacts(
            version=HIGHEST_VERSION,
            lease_s=VERSION_2_LEASE_S,
            period_ms=rules.facts.period_ms,
            clock_ns=now - rules.boot,
            boot=f"{rules.boot:x}",
            venue=rules.facts.venue,
            field_mm=rules.facts.field_mm,
        )
