"""Edge codes, rules, simple views, and a network in memory."""

from collections import deque
from collections.abc import Mapping
from dataclasses import replace
from types import MappingProxyType

import numpy as np

from vision_core.clock import Instant, ManualClock
from vision_core.models.mirror import PAPER_MIRROR
from vision_core.protocol.admission import Admission
from vision_core.protocol.edge_codes import edge_codes
from vision_core.protocol.events import Endpoint, Event, Reply
from vision_core.protocol.lifecycle import Peer, Port
from vision_core.protocol.rules import ServerFacts, SessionRules
from vision_core.protocol.session import Sessions
from vision_core.types.edges import EdgeKind
from vision_core.types.objects import Team
from vision_core.types.views import BallView, RobotView

CODES = edge_codes()
BOOT = Instant(5_000_000_000)
PAPERS_TIME = Instant(BOOT + 20_306_148_000_000)
MAIN = Endpoint(Port.MAIN, "127.0.0.1")
SESSION = Endpoint(Port.SESSION, "127.0.0.1")
CLIENT = Peer("127.0.0.1", 40000)
OTHER = Peer("127.0.0.1", 40001)
TEAMMATE = Peer("10.0.0.7", 40000)
STRANGER = Peer("192.0.2.9", 40000)
MIRRORS = {(team, number): PAPER_MIRROR for team in Team for number in range(1, 6)}
SUBNETS = ("10.0.0.0/24", "fd00::/64")
NO_KEYS: Mapping[Team, str] = MappingProxyType({})
FACTS = ServerFacts(
    ports={Port.MAIN: 6000, Port.SESSION: 6001},
    period_ms=100 / 3,
    rmin_mm={Team.BLUE: 90.0, Team.YELLOW: 85.0},
    venue="default",
    field_mm=(2800.0, 2300.0),
)


def rules(lease_s: float = 600.0, boot: Instant = BOOT) -> SessionRules:
    return SessionRules(boot, 5, lease_s, 3.6, MIRRORS, Admission.from_subnets(SUBNETS), FACTS)


def simple_view(
    *,
    at: Instant = PAPERS_TIME,
    rays: int = 360,
    distance_m: float = 0.22,
    kind: int = EdgeKind.WALL,
    ball: BallView | None = None,
) -> RobotView:
    """The same edge in every direction."""
    distances = np.full(rays, distance_m)
    return RobotView(Team.BLUE, 3, at, 7, distances, np.full(rays, kind, dtype=np.uint8), ball, False)


class Server:
    """Sessions with a clock, spoken to in bytes."""

    def __init__(self, lease_s: float = 600.0, keys: Mapping[Team, str] = NO_KEYS) -> None:
        self.clock = ManualClock(BOOT)
        self.sessions = Sessions(replace(rules(lease_s), keys=keys))

    def hear(self, datagram: bytes, peer: Peer = CLIENT, endpoint: Endpoint = MAIN) -> list[Event]:
        return self.sessions.receive(datagram, peer, endpoint, self.clock.now())

    def open_2(self, init: bytes, peer: Peer = CLIENT) -> list[Event]:
        """Send an init of version 2, and again with the cookie that it is asked for."""
        init = init[:-1] + b" (version 2))"
        (challenge,) = self.answers(init, peer)
        return self.hear(init[:-1] + b" (cookie %s))" % challenge[len("(challenge ") : -1], peer)

    def apply(self, changed: SessionRules, mode: str = "play_on") -> list[Event]:
        return self.sessions.apply(changed, mode, self.clock.now())

    def answers(self, datagram: bytes, peer: Peer = CLIENT, endpoint: Endpoint = MAIN) -> list[bytes]:
        return replies(self.hear(datagram, peer, endpoint))


def replies(events: list[Event]) -> list[bytes]:
    return [event.data for event in events if isinstance(event, Reply)]


class Network:
    """Servers by address; what they send to each other travels, loses its way or ends."""

    def __init__(self, servers: dict[Peer, Server]) -> None:
        self.servers = servers
        self.travelled = 0
        self._wire: deque[tuple[bytes, Peer, Peer]] = deque()

    def put(self, datagram: bytes, source: Peer, target: Peer) -> None:
        self._wire.append((datagram, source, target))

    def run(self, most: int) -> None:
        """Deliver until all is quiet, at most so many datagrams."""
        while self._wire and self.travelled < most:
            datagram, source, target = self._wire.popleft()
            self.travelled += 1
            server = self.servers.get(target)
            for reply in server.hear(datagram, source) if server else []:
                if isinstance(reply, Reply):
                    self.put(reply.data, target, reply.to)
