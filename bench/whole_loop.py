"""The whole pipeline in one process, from a frame to the datagrams of all clients, and the frames that it is given."""

import contextlib
import socket
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass

from bench.accuracy import TEAMS, settings_of
from vision_core.capture.source import open_source
from vision_core.clock import NS_PER_S, Instant, ManualClock
from vision_core.geometry import Bytes
from vision_core.models.camera_setup import CameraSetup
from vision_core.net.delivery import Batch, DeliveryTable
from vision_core.net.delivery_rows import new_rows
from vision_core.net.udp import SharedSocket, open_sink
from vision_core.pipeline.perception import Perception
from vision_core.pipeline.view_encoder import ViewEncoder
from vision_core.protocol.options import PAPER_OPTIONS, Options
from vision_core.settings.schema import Settings
from vision_core.tracks.tracker import Tracker
from vision_core.types.fairness import robot_index
from vision_core.types.image import ImageFrame
from vision_core.types.objects import Team
from vision_core.types.tables import SightingsTable

BLOCK, UNMEASURED = 30, 5
"""Frames in a block, after which another method has its turn; frames at the start of a block that do not count."""
FRAMES = {"640x480": 13 * BLOCK, "1280x1024": 7 * BLOCK, "2048x1536": 3 * BLOCK}
"""Distinct frames, played in a loop: an odd number of blocks, so that each of 2 or 4 methods gets all of them."""
PERIOD_NS = NS_PER_S // 30
STAGES = ("perceive", "track", "write", "send")


@dataclass(frozen=True)
class Client:
    """What a session asks for."""

    team: Team
    number: int
    options: Options = PAPER_OPTIONS
    nul: bool = False


class Loop:
    """The pipeline: perceives, tracks, writes every robot's view, and sends it over loopback to a client of its own."""

    def __init__(self, settings: Settings, stack: contextlib.ExitStack) -> None:
        """stack: closes its sockets."""
        self.settings = settings
        self._clock = ManualClock()
        self.perception = Perception(settings, CameraSetup.from_settings(settings))
        self._tracker = Tracker(settings.tracks, settings.robots)
        self._encoder = ViewEncoder(settings, Instant(0))
        numbers = range(1, settings.match.numbers + 1)
        self._clients = tuple(Client(team, number) for team in Team for number in numbers)
        self._sockets = [_client(stack) for _ in self._clients]
        server = stack.enter_context(socket.socket(socket.AF_INET, socket.SOCK_DGRAM))
        server.bind(("127.0.0.1", 0))
        shared = SharedSocket(server)
        sessions = [shared.open_session("127.0.0.1", (*one.getsockname(), 0)) for one in self._sockets]
        for session in sessions:
            stack.callback(session.close)
        self._deliveries = DeliveryTable(Instant(0), seed=1)
        self._deliveries.replace(new_rows(len(sessions)))
        for row, (client, session) in enumerate(zip(self._clients, sessions, strict=True)):
            self._deliveries.address(row, robot_index(client.team, client.number), session.fileno(), PAPER_OPTIONS)
        self._sink = stack.enter_context(open_sink())
        self._number, self._at = 0, Instant(0)
        self._last: tuple[SightingsTable, Bytes] | None = None
        """Sightings of the last frame, and which clients were due."""

    def turn(self, pixels: Bytes, at: Instant | None = None) -> tuple[float, ...]:
        """Process one frame. Returns when it began and when each stage was done [s of time.perf_counter].

        pixels: shape (height, width, 3); at: its grab, later than the last; None: a period of the camera later.
        """
        self._number += 1
        self._at = at = Instant(self._at + PERIOD_NS) if at is None else at
        began = time.perf_counter()
        seen = self.perception.perceive(ImageFrame("main", self._number, at, pixels), self._clock)
        perceived = time.perf_counter()
        world = self._tracker.update(seen)
        tracked = time.perf_counter()
        due = self._deliveries.due(at)
        batch = self._encoder.write(world, self._clients, due)
        written = time.perf_counter()
        self._deliveries.send(at, batch)
        self._last = seen, due
        return began, perceived, tracked, written, time.perf_counter()

    def rehearse(self, give_way: Callable[[], bool]) -> bool:
        """Process the last frame once more and undo it, as perceive and serve do; False when it gave way."""
        if self._last is None or not self.perception.rehearse(give_way) or give_way():
            return False
        seen, due = self._last
        batch: Batch | None = None
        with self._tracker.rehearsed(seen) as world:
            if world is not None and not give_way():
                batch = self._encoder.write(world, self._clients, due)
        if batch is None or give_way():
            return False
        self._deliveries.rehearse(self._at, batch, self._sink.fileno())
        return True

    def drain(self) -> int:
        """Receive all datagrams that wait in the clients' sockets. Returns their number."""
        return len(self.received())

    def received(self) -> list[bytes]:
        """All datagrams that wait in the clients' sockets, client by client."""
        datagrams = []
        for client in self._sockets:
            with contextlib.suppress(BlockingIOError):
                while True:
                    datagrams.append(client.recv(4096))
        return datagrams

    def state(self) -> list[bytes]:
        """All that the next frames depend on, and the order in which the last one was sent."""
        context, rows = self.perception.context, self._deliveries.rows
        held = [context.held.robots, context.held.size, context.ball]
        kept = [self.perception.robots, context.expected, *held, context.segment.cursor, self._tracker._state]
        deliveries = [rows[name] for name in rows.dtype.fields or () if name not in ("descriptor", "sent_at")]
        return [array.tobytes() for array in (*kept, *deliveries)]


@contextlib.contextmanager
def open_loop(size: str, robots: int) -> Iterator[Loop]:
    """The pipeline for frames of a size and number of robots."""
    with contextlib.ExitStack() as stack:
        yield Loop(match_settings(size, robots), stack)


def match_settings(size: str, robots: int) -> Settings:
    """A simulated match. size: one of FRAMES; robots: one of TEAMS."""
    per_team = TEAMS[robots]
    return settings_of(size, {"synthetic.robots_per_team": per_team, "match.numbers": per_team})


def match_frames(size: str, robots: int) -> list[Bytes]:
    """The distinct frames of that match."""
    settings = match_settings(size, robots)
    camera = CameraSetup.from_settings(settings)
    source = open_source(settings, camera, ManualClock(), paced=False)
    frames = [camera.black_image() for _ in range(FRAMES[size])]
    for pixels in frames:
        source.grab(pixels)
    source.close()
    return frames


def _client(stack: contextlib.ExitStack) -> socket.socket:
    client = stack.enter_context(socket.socket(socket.AF_INET, socket.SOCK_DGRAM))
    client.bind(("127.0.0.1", 0))
    client.setblocking(False)
    return client
