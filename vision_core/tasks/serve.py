"""Task: sightings -> datagrams. Released by perception and by whatever clients send.

Its sessions are written to the database after every frame, so that a successor goes on with the same
clients, ports and Time where this process stopped.
"""

import random
import statistics
from collections import deque

from vision_core.clock import NS_PER_S, Instant, seconds_between
from vision_core.models.field import diagonal_m
from vision_core.net.server import Served, UdpServer
from vision_core.net.udp import adopted
from vision_core.pipeline.view_encoder import Messages
from vision_core.pipeline.warm_up import views as warm_up_views
from vision_core.protocol.admission import Admission
from vision_core.protocol.session import Event, Refused, Rules, Sessions
from vision_core.rtdb import records
from vision_core.rtdb.infos import LAGS, ClientInfo, Serving
from vision_core.scheduling.handle import Handle, Step
from vision_core.scheduling.releases import IDLE, Release, StepResult
from vision_core.settings.schema import Settings
from vision_core.timing.histogram import Histograms
from vision_core.timing.running_rate import RunningRate
from vision_core.tracks.tracker import Tracker
from vision_core.types.tables import SightingsTable, Table, obstacle_table

PUBLISH_EVERY_S = 0.5
LAGS_KEPT = 300
"""Frames: ten seconds at 30 Hz."""
REFUSALS_KEPT = 20
REFUSAL_TOLD_S = 30.0
MS_PER_S = 1e3


def start(handle: Handle) -> Step:
    """Load the kernels, take over the sessions."""
    warm_up_views(handle.settings)
    server = Server(handle)
    handle.listen(server.fileno(), server.hear)
    handle.every_turn(server.hear)  # also when every frame is late
    handle.every_turn(server.publish_if_due)
    return server.serve_newest


class Server:
    """Tracks, observes, sends, answers; one thread."""

    def __init__(self, handle: Handle) -> None:
        settings = handle.settings
        camera = handle.camera.name
        self._handle = handle
        self._clock = handle.clock
        self._tracker = Tracker(settings.tracks, settings.robots)
        self._messages = Messages(settings, handle.attachment.boot)
        self._sightings = handle.raw_reader(records.sightings(camera).spec.name)
        self._seen = SightingsTable()
        self._obstacles = handle.reader(records.obstacles(camera))
        self._things: tuple[int, Table, Instant | None] = (0, obstacle_table(()), None)
        self._world = handle.raw_writer(records.WORLD.spec.name)
        self._views = handle.raw_writer(records.VIEWS.spec.name)
        self._serving = handle.writer(records.SERVING)
        self._sessions = handle.raw_writer(records.SESSIONS.name)
        self._lag_record = handle.raw_writer(records.LAG_HISTOGRAMS.name)
        main, session = (adopted(handle.attachment.resources.sockets[name]) for name in ("main", "session"))
        order = random.Random()  # noqa: S311 (fairness, no secret); seeded by the system
        self._udp = UdpServer(main, session, self._restored(settings), self._clock, order)
        self._lags = Histograms(LAGS)
        self._lags_s: deque[float] = deque(maxlen=LAGS_KEPT)
        self._reported: dict[tuple[str, int], Instant] = {}
        self._refused: deque[tuple[Instant, str]] = deque(maxlen=REFUSALS_KEPT)
        self._rates: dict[tuple[str, int], RunningRate] = {}
        self._published = self._clock.now()
        self._newest = self._sightings.sequence

    def fileno(self) -> int:
        """Readable when a client has said something."""
        return self._udp.fileno()

    def hear(self) -> None:
        """Take what clients said."""
        self._note(self._udp.handle_readable())

    def serve_newest(self, release: Release) -> StepResult:
        """Send the newest frame's views, then write down what was sent."""
        seen = self._sightings.read(self._clock.now())
        if seen is None or seen.sequence == self._newest:
            return IDLE
        self._newest = seen.sequence
        missed = seen.sequence - release.sequence  # sightings that came between the release and this call
        if not seen.valid:  # a source that stood still delivers again: these sightings are too old to be served
            return StepResult(ran=False, missed=missed)
        self._seen.load(seen.value)
        served = self._serve(seen.measured)
        if served.last is not None:
            self._lags_s.append(seconds_between(seen.measured, served.last))
            self._lags.add("server", served.last - seen.measured)
        self._note(served.events)
        self._keep_sessions()
        return StepResult(missed=missed)

    def _serve(self, at: Instant) -> Served:
        """Track, observe, encode and send; then let others read what was sent."""
        things, things_at = self._newest_obstacles()
        world = self._tracker.update(self._seen, things, things_at)
        sessions, due = self._udp.due(at)
        served = self._udp.send_batch(at, self._messages.write(world, sessions, due))
        now = self._clock.now()
        self._world.write(world.bytes, at, now)
        self._views.write(self._messages.views.bytes, at, now)
        return served

    def _newest_obstacles(self) -> tuple[Table, Instant | None]:
        """As last told, and when they were seen; decoded once."""
        if self._obstacles.sequence != self._things[0] and (told := self._obstacles.read(self._clock.now())):
            self._things = (told.sequence, obstacle_table(told.value.obstacles), told.measured)
        return self._things[1:]

    def publish_if_due(self) -> None:
        """Say twice a second how the clients are served."""
        now = self._clock.now()
        if seconds_between(self._published, now) < PUBLISH_EVERY_S:
            return
        self._note(self._udp.expire())
        self._count_reports()
        lags = sorted(self._lags_s) or [0.0]
        serving = Serving(
            clients=self._clients(now),
            lag_median_ms=statistics.median(lags) * MS_PER_S,
            lag_max_ms=lags[-1] * MS_PER_S,
            refused=tuple(text for at, text in self._refused if seconds_between(at, now) <= REFUSAL_TOLD_S),
        )
        self._lag_record.write(self._lags.encode(), now, now)
        self._serving.write(serving, now, now)
        self._published = now

    def _count_reports(self) -> None:
        """Lags B and C, as far as clients have reported them since the last time."""
        for session in self._udp.sessions:
            key = (session.team, session.number)
            if session.reported == self._reported.get(key):
                continue
            self._reported[key] = session.reported
            for name, lag_s in (("network", session.network_s), ("client", session.client_s)):
                if lag_s is not None:
                    self._lags.add(name, round(lag_s * NS_PER_S))

    def _clients(self, now: Instant) -> tuple[ClientInfo, ...]:
        infos = []
        before, self._rates = self._rates, {}
        for session in self._udp.sessions:
            tally = self._udp.tally(session)
            key = (session.team, session.number)
            self._rates[key] = before.get(key) or RunningRate()
            infos.append(
                ClientInfo(
                    team=session.team,
                    number=session.number,
                    address=session.peer.host,
                    port=session.peer.port,
                    since=session.opened,
                    sent=tally.sent,
                    dropped=tally.dropped,
                    rate_hz=self._rates[key].of(now, tally.sent),
                    mean_rank=tally.mean_rank,
                    network_ms=_ms(session.network_s),
                    client_ms=_ms(session.client_s),
                )
            )
        return tuple(sorted(infos, key=lambda info: (info.team, info.number)))

    def _note(self, events: list[Event] | tuple[Event, ...]) -> None:
        for event in events:
            if isinstance(event, Refused):
                text = f"{event.peer.host} port {event.peer.port}: {event.error.value}"
                self._refused.append((self._clock.now(), text))
        if events:
            self._keep_sessions()

    def _keep_sessions(self) -> None:
        now = self._clock.now()
        self._sessions.write(self._udp.snapshot(), now, now)

    def _restored(self, settings: Settings) -> Sessions:
        """The sessions of a predecessor that died, or none."""
        rules = Rules(
            boot=self._handle.attachment.boot,
            numbers=settings.match.numbers,
            lease_s=settings.protocol.lease_s,
            diagonal_m=diagonal_m(settings.field),
            admission=Admission.from_subnets(settings.admission.subnets),
        )
        kept = self._handle.raw_reader(records.SESSIONS.name).read(self._clock.now())
        return Sessions(rules) if kept is None else Sessions.restore(rules, kept.value)


def _ms(duration_s: float | None) -> float | None:
    return None if duration_s is None else duration_s * MS_PER_S
