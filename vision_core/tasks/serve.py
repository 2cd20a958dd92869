"""Process: sightings -> datagrams. Released by perception and by whatever clients send.

Its sessions are written to the database after every frame, so that a successor goes on with the same
clients, ports and Time where this process stopped.
"""

import contextlib
import os
import random
import select
import statistics
from collections import deque

from vision_core.clock import Instant, MonotonicClock, seconds_between
from vision_core.field_model import diagonal_m
from vision_core.net.server import Served, UdpServer
from vision_core.net.udp import adopted
from vision_core.protocol.admission import Admission
from vision_core.protocol.session import Event, Refused, Rules, Sessions
from vision_core.rtdb import records
from vision_core.rtdb.attachment import Attachment, attach
from vision_core.rtdb.records import ClientInfo, Serving
from vision_core.settings import Settings
from vision_core.tasks.gauge import Gauge
from vision_core.tasks.messages import Messages
from vision_core.tasks.warm_up import views as warm_up_views
from vision_core.tracks.tracker import Tracker
from vision_core.types.tables import SightingsTable, Table, obstacle_table

PUBLISH_EVERY_S = 0.5
LAGS_KEPT = 300
"""Frames: ten seconds at 30 Hz."""
REFUSALS_KEPT = 20
REFUSAL_TOLD_S = 30.0
LONGEST_WAIT_S = 0.25
MS_PER_S = 1e3


def main() -> None:
    """Run until the supervisor says stop."""
    attachment = attach()
    clock = MonotonicClock()
    gauge = Gauge(attachment, clock.now())
    settings = records.SERVICE.reader(attachment.store).value(clock.now()).settings
    warm_up_views(settings)
    Server(attachment, settings, gauge).run()


class Server:
    """Tracks, observes, sends, answers; one thread."""

    def __init__(self, attachment: Attachment, settings: Settings, gauge: Gauge) -> None:
        self._attachment = attachment
        self._gauge = gauge
        self._clock = MonotonicClock()
        self._tracker = Tracker(settings.tracks, settings.robots)
        self._messages = Messages(settings, attachment.boot)
        store = attachment.store
        camera = settings.camera.name
        self._sightings = store.reader(records.sightings(camera).spec.name)
        self._seen = SightingsTable()
        self._obstacles = records.obstacles(camera).reader(store)
        self._things: tuple[int, Table, Instant | None] = (0, obstacle_table(()), None)
        self._world = store.writer(records.WORLD.spec.name)
        self._views = store.writer(records.VIEWS.spec.name)
        self._serving = records.SERVING.writer(store)
        self._sessions = store.writer(records.SESSIONS.name)
        main, session = (adopted(attachment.handed.sockets[name]) for name in ("main", "session"))
        order = random.Random()  # noqa: S311 (fairness, no secret); seeded by the system
        self._udp = UdpServer(main, session, self._restored(settings), self._clock, order)
        self._lags_s: deque[float] = deque(maxlen=LAGS_KEPT)
        self._refused: deque[tuple[Instant, str]] = deque(maxlen=REFUSALS_KEPT)
        self._sent: dict[tuple[str, int], int] = {}
        self._published = self._clock.now()
        self._newest = self._sightings.sequence

    def run(self) -> None:
        """Serve frames and clients until told to stop."""
        wake = self._attachment.handed.wake
        assert wake is not None
        poller = select.poll()
        poller.register(wake, select.POLLIN)
        poller.register(self._udp.fileno(), select.POLLIN)
        while not self._attachment.stopping:
            ready = {descriptor for descriptor, _ in poller.poll(LONGEST_WAIT_S * MS_PER_S)}
            if wake in ready:
                with contextlib.suppress(BlockingIOError):
                    os.eventfd_read(wake)
                self._serve_newest()
            if self._udp.fileno() in ready:
                self._note(self._udp.handle_readable())
            self._publish_if_due()

    def _serve_newest(self) -> None:
        """Send the newest frame's views, then write down what was sent."""
        released = self._clock.now()
        seen = self._sightings.read(released)
        if seen is None or seen.sequence == self._newest:
            return
        missed = seen.sequence - self._newest - 1
        self._newest = seen.sequence
        self._seen.load(seen.value)
        served = self._serve(seen.measured)
        done = self._clock.now()
        if served.last is not None:
            self._lags_s.append(seconds_between(seen.measured, served.last))
        self._note(served.events)
        self._keep_sessions()
        self._gauge.ran(released, done, missed)

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

    def _publish_if_due(self) -> None:
        now = self._clock.now()
        self._gauge.publish_if_due(now)
        elapsed_s = seconds_between(self._published, now)
        if elapsed_s < PUBLISH_EVERY_S:
            return
        self._note(self._udp.expire())
        lags = sorted(self._lags_s) or [0.0]
        serving = Serving(
            clients=self._clients(elapsed_s),
            lag_median_ms=statistics.median(lags) * MS_PER_S,
            lag_max_ms=lags[-1] * MS_PER_S,
            refused=tuple(text for at, text in self._refused if seconds_between(at, now) <= REFUSAL_TOLD_S),
        )
        self._serving.write(serving, now, now)
        self._published = now

    def _clients(self, elapsed_s: float) -> tuple[ClientInfo, ...]:
        infos = []
        before, self._sent = self._sent, {}
        for session in self._udp.sessions:
            tally = self._udp.tally(session)
            key = (session.team, session.number)
            self._sent[key] = tally.sent
            infos.append(
                ClientInfo(
                    team=session.team,
                    number=session.number,
                    address=session.peer.host,
                    port=session.peer.port,
                    since=session.opened,
                    sent=tally.sent,
                    dropped=tally.dropped,
                    rate_hz=max(tally.sent - before.get(key, 0), 0) / elapsed_s,
                    mean_rank=tally.mean_rank,
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
            boot=self._attachment.boot,
            numbers=settings.match.numbers,
            lease_s=settings.protocol.lease_s,
            diagonal_m=diagonal_m(settings.field),
            admission=Admission.from_subnets(settings.admission.subnets),
        )
        kept = self._attachment.store.reader(records.SESSIONS.name).read(self._clock.now())
        return Sessions(rules) if kept is None else Sessions.restore(rules, kept.value)


if __name__ == "__main__":
    main()
