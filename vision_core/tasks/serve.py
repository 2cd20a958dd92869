"""Task: sightings -> datagrams. Released by perception and by the datagrams of clients.

Five parts, each in a file of its own, are joined here: ``Tracker`` (sightings -> world), ``Messages`` (world ->
datagrams), ``UdpServer`` (datagrams -> clients; the order of sending is in ``net/delivery.py``), ``Drivers`` (what
clients ask of simulated robots) and ``DeliveryReport`` (what the page shows of it).

The sessions are written to the database whenever they change and after every frame. So when this process ends
unexpectedly, its successor goes on with the same clients, ports and Time.
"""

from collections.abc import Sequence

from vision_core.clock import Instant, seconds_between
from vision_core.geometry import Bytes
from vision_core.net.delivery_report import DeliveryReport
from vision_core.net.drivers import Drivers
from vision_core.net.server import SendSummary, UdpServer
from vision_core.pipeline.view_encoder import ViewEncoder
from vision_core.pipeline.warm_up import views as warm_up_views
from vision_core.protocol.events import Driven, Event, Reply, RequestRefused
from vision_core.protocol.lifecycle import Session
from vision_core.protocol.session import Sessions
from vision_core.protocol.show import encode_show
from vision_core.rtdb import records
from vision_core.rtdb.infos import EndedSession
from vision_core.scheduling.handle import Handle, Step
from vision_core.scheduling.rehearser import GiveWay
from vision_core.scheduling.releases import IDLE, Release, StepResult
from vision_core.settings.schema import Settings
from vision_core.tasks.fairness_keeper import FairnessKeeper
from vision_core.tasks.session_rules import RuleBook
from vision_core.tracks.tracker import Tracker
from vision_core.types.objects import Team
from vision_core.types.tables import SightingsTable, Table, WorldTable, obstacle_table

PUBLISH_EVERY_S = 0.5
VISION_LOST_S = 1.0
"""Clients of version 2 are told when no image could be used for so long."""


def start(handle: Handle) -> Step:
    """Load the kernels and restore the sessions."""
    warm_up_views(handle.settings)
    task = ServeTask(handle)
    handle.listen(task.server.fileno(), task.receive)
    handle.rehearse_with(task.rehearse)
    handle.every_turn(task.receive)  # also when every frame is late
    handle.every_turn(task.publish_if_due)
    return task.serve_newest


class ServeTask:
    """Serves one frame after the other, and answers clients in between. It has one thread."""

    def __init__(self, handle: Handle) -> None:
        self._handle = handle
        self._clock = handle.clock
        self._sightings = handle.raw_reader(records.sightings(handle.camera.name).spec.name)
        self._served_sequence = self._sightings.sequence
        self._sightings_table = SightingsTable()
        self._obstacles = _ObstacleReader(handle)
        self._tracker = Tracker(handle.settings.tracks, handle.settings.robots)
        self._encoder = ViewEncoder(handle.settings, handle.attachment.boot)
        self._world = handle.raw_writer(records.WORLD.spec.name)
        self._views = handle.raw_writer(records.VIEWS.spec.name)
        self._sessions = handle.raw_writer(records.SESSIONS.name)
        self._book = RuleBook(handle)
        self.server = _restored_server(handle, self._book)
        self._fairness = FairnessKeeper(handle, self.server.fairness)
        self._drives = handle.raw_writer(records.DRIVES.name)
        driven = handle.raw_reader(records.DRIVES.name).read(self._clock.now())
        self._drivers = Drivers(self.server.sessions, driven.value if driven else None)
        self._report = DeliveryReport()
        self._serving = handle.writer(records.SERVING)
        self._lags = handle.raw_writer(records.LAG_HISTOGRAMS.name)
        self._published_at: Instant | None = None
        self._live = handle.reader(records.LIVE_SETTINGS)
        self._live_sequence = 0
        self._numbers = _numbers(handle.settings)
        self._revision = 0
        self._ended: tuple[EndedSession, ...] = ()
        self._last_sent: tuple[Instant, tuple[Session, ...], Bytes] | None = None
        """Grab of the last frame, the sessions, and which of them were due."""
        self._seen_at: Instant | None = self._clock.now()
        """When views were sent last; None: clients know that the vision is lost."""
        self._apply_live_settings(self._clock.now())  # a successor goes on with what was changed before

    def receive(self) -> None:
        """Receive and answer the datagrams of clients."""
        self._note(self.server.handle_readable())

    def serve_newest(self, release: Release) -> StepResult:
        """Send the newest frame's views, then write the records; idle when there is no new frame."""
        reading = self._sightings.read(self._clock.now())
        if reading is None or reading.sequence == self._served_sequence:
            return IDLE
        self._served_sequence = reading.sequence
        missed = reading.sequence - release.sequence  # sightings that came between the release and this call
        if not reading.valid:  # a source that had stopped delivers again: these sightings are too old to be sent
            return StepResult(ran=False, missed=missed)
        self._apply_live_settings(reading.measured)  # this frame is wholly made with the new settings
        self._sightings_table.load(reading.value)
        world = self._tracker.update(self._sightings_table, *self._obstacles.newest())
        summary = self._send(world, reading.measured)
        if self._seen_at is None:
            self._note(self.server.tell("vision_back"))
        self._seen_at = self._clock.now()
        self._write_records(world, reading.measured)
        self._show(world)
        self._report.note_frame(reading.measured, summary)
        self._note(summary.events)
        self._save_sessions()
        return StepResult(missed=missed, done=summary.last)

    def rehearse(self, give_way: GiveWay) -> bool:
        """Track, encode and send the last frame once more, to nobody; everything ends as it was.

        The records are read as for a frame, so that this finds their code in the caches, too.
        """
        if self._last_sent is None or give_way():
            return False
        self._sightings.read(self._clock.now())
        self._obstacles.newest()
        at, sessions, due = self._last_sent
        with self._tracker.rehearsed(self._sightings_table) as world:
            if world is None or give_way():
                return False
            batch = self._encoder.write(world, sessions, due, self._clock.now())
        if give_way():
            return False
        self.server.rehearse_batch(at, batch)
        return True

    def publish_if_due(self) -> None:
        """Twice a second: end silent sessions, and report how the clients are served."""
        now = self._clock.now()
        if self._published_at is not None and seconds_between(self._published_at, now) < PUBLISH_EVERY_S:
            return
        if self._seen_at is None:  # no frame comes that would do it
            self._apply_live_settings(now)
        if self._seen_at is not None and seconds_between(self._seen_at, now) > VISION_LOST_S:
            self._seen_at = None
            self._note(self.server.tell("vision_lost"))
        self._note(self.server.expire())
        self._lags.write(self._report.histograms(), now, now)
        self._serving.write(self._report.serving(self.server, now, self._revision), now, now)
        self._fairness.publish(now)
        self._published_at = now

    def _send(self, world: WorldTable, grabbed_at: Instant) -> SendSummary:
        """Send the views of a world to the clients that are due."""
        sessions, due = self.server.due(grabbed_at)
        self._last_sent = grabbed_at, sessions, due
        return self.server.send_batch(grabbed_at, self._encoder.write(world, sessions, due, self._clock.now()))

    def _write_records(self, world: WorldTable, grabbed_at: Instant) -> None:
        """Write the world and the views that were sent."""
        now = self._clock.now()
        self._world.write(world.bytes, grabbed_at, now)
        self._views.write(self._encoder.views.bytes, grabbed_at, now)

    def _show(self, world: WorldTable) -> None:
        """Send the whole field to the monitors, after the robots have their views."""
        if self.server.sessions.monitors:
            self.server.show(encode_show(world.record(), self._handle.attachment.boot, self._numbers))

    def _apply_live_settings(self, at: Instant) -> None:
        """Take over what was changed on the page since the last frame. Sessions, ports and Time stay.

        at: grab of the first frame that is made with it. A new encoder takes half a millisecond, since its kernels are
        compiled.
        """
        if self._live.sequence == self._live_sequence:
            return
        reading = self._live.read(self._clock.now())
        if reading is None:
            return
        self._live_sequence, live = reading.sequence, reading.value
        settings = live.over(self._handle.settings)
        self._encoder = ViewEncoder(settings, self._handle.attachment.boot)
        self._numbers = _numbers(settings)
        self._tracker.configure(settings.tracks, settings.robots)
        events = self.server.apply(
            self._book.rules(settings, live.keys, live.monitor_key), settings.match.play_mode, at
        )
        for ended in live.ended:
            if ended not in self._ended:
                events += self.server.end(ended.team, ended.number, ended.since)
        self._fairness.follow(live)
        self._revision, self._ended = live.revision, live.ended
        self._note(events)

    def _note(self, events: Sequence[Event]) -> None:
        self._report.note_events(events, self.server, self._clock.now())
        if self._drivers.note(events):
            now = self._clock.now()
            self._drives.write(self._drivers.record, now, now)
        if not all(isinstance(event, (Reply, RequestRefused, Driven)) for event in events):  # these change no session
            self._save_sessions()

    def _save_sessions(self) -> None:
        now = self._clock.now()
        self._sessions.write(self.server.snapshot(), now, now)


class _ObstacleReader:
    """Reads the newest obstacles, and decodes each record once."""

    def __init__(self, handle: Handle) -> None:
        self._reader = handle.reader(records.obstacles(handle.camera.name))
        self._clock = handle.clock
        self._sequence = 0
        self._newest: tuple[Table, Instant | None] = obstacle_table(()), None

    def newest(self) -> tuple[Table, Instant | None]:
        """The obstacles, and when they were seen: None before the first record."""
        if self._reader.sequence != self._sequence and (reading := self._reader.read(self._clock.now())):
            self._sequence = reading.sequence
            self._newest = obstacle_table(reading.value.obstacles), reading.measured
        return self._newest


def _numbers(settings: Settings) -> dict[tuple[Team, int | None], int]:
    """The number of each robot that may have one, by team and marker id."""
    match = settings.match
    worn = {team: match.ids_of(team)[: match.numbers] for team in Team}
    return {(team, marker): number for team in Team for number, marker in enumerate(worn[team], start=1)}


def _restored_server(handle: Handle, book: RuleBook) -> UdpServer:
    """A server with the sessions that an earlier process of this service had, if there was one."""
    rules = book.rules(handle.settings)
    main, session = book.sockets
    snapshot = handle.raw_reader(records.SESSIONS.name).read(handle.clock.now())
    if snapshot is None:
        return UdpServer(main, session, Sessions(rules), handle.clock)
    return UdpServer.restore(main, session, rules, snapshot.value, handle.clock)
