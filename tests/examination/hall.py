"""A server that keeps every rule, and ways to break one."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from threading import Event as Signal

from tests.net.serving import BALL, PERIOD_S, Stadium
from tests.protocol.samples import CODES, simple_view
from vision_core.clock import Instant
from vision_core.models.mirror import PAPER_MIRROR
from vision_core.protocol.driving import DriveLimits
from vision_core.protocol.events import Endpoint, Event, Reply
from vision_core.protocol.lifecycle import Peer, Port, Session
from vision_core.protocol.see import reference_see
from vision_core.protocol.session import Sessions
from vision_core.types.objects import Team

EXTRAS = {"seq": ("7",), "age": ("5210",), "sent": ("20306.153210",), "conf": ("97",), "flags": ()}

Alter = Callable[[bytes], bytes | None]


def unchanged(datagram: bytes) -> bytes:
    return datagram


@dataclass(frozen=True)
class Altered:
    """What a broken server hears, says and shows in place of what it should; None: nothing."""

    heard: Alter = unchanged
    said: Alter = unchanged
    seen: Alter = unchanged


class AlteredSessions(Sessions):
    altered = Altered()

    def receive(
        self, datagram: bytes, peer: Peer, endpoint: Endpoint, now: Instant, arrived: Instant | None = None
    ) -> list[Event]:
        heard = self.altered.heard(datagram)
        events = [] if heard is None else super().receive(heard, peer, endpoint, now, arrived)
        said = ((event, self.altered.said(event.data) if isinstance(event, Reply) else b"") for event in events)
        return [
            replace(event, data=data) if isinstance(event, Reply) else event for event, data in said if data is not None
        ]


DRIVES = {(team, number): DriveLimits(2.0, 2.0, 10.0, 5.0, dribbler=True) for team in Team for number in range(1, 6)}
SHOW = b"(show 20306.148 ((ball) 120 -35 800 0) ((robot blue 3) -450 20 90.0 0 0))"


class Hall(Stadium):
    """A stadium that tells its ports, appends extras, shows the field, and lets sessions end."""

    def __init__(self, altered: Altered | None = None, *, drives: bool = True) -> None:
        self.altered = altered or Altered()
        super().__init__()
        ports = {Port.MAIN: self.port, Port.SESSION: int(self.session.getsockname()[1])}
        facts = replace(self.rules.facts, ports=ports)
        self.restart(replace(self.rules, facts=facts, drives=DRIVES if drives else {}))
        self.send_frame()  # compiles

    def start(self, sessions: Sessions) -> None:
        altered = AlteredSessions(sessions.rules)
        altered.altered = self.altered
        super().start(altered)

    def see(self, session: Session, at: Instant) -> bytes | None:
        options = session.options
        view = simple_view(at=at, rays=options.rays_per_circle, ball=BALL)
        extras = {name: EXTRAS[name] for name in options.extras}
        boot = self.rules.boot
        return self.altered.seen(
            reference_see(view, options, PAPER_MIRROR, CODES, boot, nul=session.nul, extras=extras)
        )

    def run(self, stop: Signal) -> None:
        while not stop.is_set():
            self.serve(PERIOD_S)
            self.server.expire()
            self.send_frame()
            if show := self.altered.seen(SHOW):
                self.server.show(show)
