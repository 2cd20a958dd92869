"""A real server on loopback, driven step by step or by a thread."""

import contextlib
import select
import socket
import threading
from collections.abc import Iterator
from dataclasses import dataclass
from typing import TypeVar

from tests.protocol.samples import CODES, rules, simple_view
from vision_core.clock import Instant, MonotonicClock
from vision_core.models.mirror import PAPER_MIRROR
from vision_core.net.delivery import Batch
from vision_core.net.delivery_rows import DROPPED, NOT_SENT, REFUSED, SENT, UNREACHABLE
from vision_core.net.server import UdpServer
from vision_core.net.udp import SendResult, open_server_sockets
from vision_core.protocol.events import Event
from vision_core.protocol.lifecycle import Session
from vision_core.protocol.rules import SessionRules
from vision_core.protocol.see import reference_see
from vision_core.protocol.session import Sessions
from vision_core.types.views import BallView

PATIENCE_S = 2.0
PERIOD_S = 0.01
BALL = BallView(distance_m=0.379, direction_deg=121.2, size_deg=6.45, partial=False)


@dataclass(frozen=True)
class Delivery:
    """How one session was served in one frame."""

    session: Session
    rank: int
    sent_at: Instant
    result: SendResult


RESULTS = {
    SENT: SendResult.SENT,
    DROPPED: SendResult.DROPPED,
    UNREACHABLE: SendResult.DROPPED,
    REFUSED: SendResult.REFUSED,
}


@dataclass(frozen=True)
class Frame:
    """How one frame was served, in the order of sending."""

    deliveries: tuple[Delivery, ...]
    events: tuple[Event, ...]


class Stadium:
    """A server that sends every client walls at 220 mm and a ball."""

    def __init__(self, strangers_s: float = 1e3, host: str = "127.0.0.1") -> None:
        self.strangers_s = strangers_s
        self.clock = MonotonicClock()
        self.rules = rules(boot=self.clock.now())
        self.main, self.session = open_server_sockets(host, 0, 0)
        self._grabbed = Instant(0)
        self.blind = False
        """The camera sees no robot, so no view is sent."""
        self.start(Sessions(self.rules))

    @property
    def port(self) -> int:
        return int(self.main.getsockname()[1])

    def start(self, sessions: Sessions) -> None:
        self.server = UdpServer(self.main, self.session, sessions, self.clock, seed=1, strangers_s=self.strangers_s)

    def restore(self, snapshot: bytes) -> None:
        self.server = UdpServer.restore(self.main, self.session, self.rules, snapshot, self.clock, seed=1)

    def restart(self, rules: SessionRules) -> None:
        """A server without sessions; not while it runs."""
        self.server.close()
        self.rules = rules
        self.start(Sessions(self.rules))

    def close(self) -> None:
        self.server.close()
        self.main.close()
        self.session.close()

    def serve(self, patience_s: float = PATIENCE_S) -> list[Event]:
        """Wait for a datagram, handle what came."""
        select.select([self.server], [], [], patience_s)
        return self.server.handle_readable()

    def see(self, session: Session, at: Instant) -> bytes | None:
        if self.blind:
            return None
        options = session.options
        view = simple_view(at=at, rays=options.rays_per_circle, ball=BALL)
        text = reference_see(view, options, PAPER_MIRROR, CODES, self.rules.boot, nul=session.nul)
        if "age" in options.extras:
            return text[:-1] + b" ((age) %d))" % max((self.clock.now() - at) // 1000, 0)
        return text

    def send_frame(self, at: Instant | None = None) -> Frame:
        self._grabbed = at or Instant(max(self.clock.now(), self._grabbed + 1_000_000))  # Time has milliseconds
        grabbed = self._grabbed
        sessions, due = self.server.due(grabbed)
        views = [self.see(session, grabbed) if due[row] else None for row, session in enumerate(sessions)]
        summary = self.server.send_batch(grabbed, Batch.of([data or b"" for data in views]))
        deliveries = self.deliveries(sessions)
        if all(session in self.server for session in sessions):  # a client may have closed its port meanwhile
            assert (summary.sessions, summary.last) == (len(deliveries), deliveries[-1].sent_at if deliveries else None)
        return Frame(deliveries, summary.events)

    def deliveries(self, sessions: tuple[Session, ...]) -> tuple[Delivery, ...]:
        """How the sessions that were still open after a frame were served in it."""
        rows = [(session, self.server.delivery(session)) for session in sessions if session in self.server]
        sent = [
            Delivery(session, int(row["rank"]), Instant(int(row["sent_at"])), RESULTS[int(row["result"])])
            for session, row in rows
            if row["result"] != NOT_SENT
        ]
        return tuple(sorted(sent, key=lambda delivery: delivery.rank))

    def run(self, stop: threading.Event) -> None:
        while not stop.is_set():
            self.serve(PERIOD_S)
            self.send_frame()


Playing = TypeVar("Playing", bound=Stadium)


@contextlib.contextmanager
def running(stadium: Stadium) -> Iterator[Stadium]:
    """A stadium that serves frames in a thread of its own."""
    stop = threading.Event()
    thread = threading.Thread(target=stadium.run, args=(stop,))
    thread.start()
    try:
        yield stadium
    finally:
        stop.set()
        thread.join()


@contextlib.contextmanager
def playing(stadium: Playing) -> Iterator[Playing]:
    """The same, and it is closed afterwards."""
    with contextlib.closing(stadium), running(stadium):
        yield stadium


@contextlib.contextmanager
def robot(stadium: Stadium, init: bytes, *, port: int = 0) -> Iterator[socket.socket]:
    """A client's socket that has sent its init."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as client:
        client.bind(("127.0.0.1", port))
        client.settimeout(PATIENCE_S)
        client.sendto(init, ("127.0.0.1", stadium.port))
        yield client
