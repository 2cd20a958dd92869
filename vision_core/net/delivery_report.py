"""How the clients are served, as the records ``serving`` and ``lags`` say it.

The lags of the PSLV paper (section 4.2): A, of the server, from the grab of an image until the last client was sent its
view; B, of the network, and C, of the client, as far as clients report them.
"""

import statistics
from collections import deque
from collections.abc import Iterable
from dataclasses import replace

from vision_core.clock import MS_PER_S, NS_PER_MS, Instant, seconds_between
from vision_core.models.mirror import Mirror
from vision_core.net.delivery_rows import UNKNOWN, mean_rank
from vision_core.net.refusals import Refusals
from vision_core.net.server import SendSummary, UdpServer
from vision_core.protocol.events import Event, LagReported, RequestRefused
from vision_core.protocol.lifecycle import Session
from vision_core.rtdb.infos import LAGS, ClientInfo, Serving
from vision_core.settings.schema import MirrorConstants
from vision_core.timing.histogram import Histograms
from vision_core.timing.running_rate import RunningRate
from vision_core.types.tables import Table

LAGS_KEPT = 300
"""Frames: ten seconds at 30 Hz."""


class DeliveryReport:
    """Collects what happened, and reports it."""

    def __init__(self) -> None:
        self._histograms = Histograms(LAGS)
        self._lags_s: deque[float] = deque(maxlen=LAGS_KEPT)
        self._refusals = Refusals()
        self._rates: dict[Session, RunningRate] = {}

    def note_frame(self, grabbed_at: Instant, summary: SendSummary) -> None:
        """Count the server's lag of a frame that was sent."""
        if summary.last is not None:
            self._lags_s.append(seconds_between(grabbed_at, summary.last))
            self._histograms.add("server", summary.last - grabbed_at)

    def note_events(self, events: Iterable[Event], server: UdpServer, now: Instant) -> None:
        """Count the lags that clients reported, and keep what was refused."""
        for event in events:
            match event:
                case RequestRefused():
                    self._refusals.note(event, now)
                case LagReported(session, _, at) if session in server:
                    self._note_lags(server.delivery(session), at)

    def _note_lags(self, row: Table, reported_at: Instant) -> None:
        """Count the lags of a row, unless the report that came at an instant was ignored."""
        if row["reported_at"] != reported_at:
            return
        for lag in ("network", "client"):
            if (lag_ns := int(row[f"{lag}_ns"])) != UNKNOWN:
                self._histograms.add(lag, lag_ns)

    def histograms(self) -> bytes:
        """The record ``lags``."""
        return self._histograms.encode()

    def serving(self, server: UdpServer, now: Instant, revision: int) -> Serving:
        """The record ``serving``. revision: of the live settings in effect."""
        previous, self._rates = self._rates, {}
        clients = []
        for session in server.sessions:
            rate = self._rates[session] = previous.get(session) or RunningRate()
            mirror = server.sessions.rules.mirror_of(session)
            clients.append(_client_info(session, server.delivery(session), mirror, rate, now))
        lags_s = sorted(self._lags_s) or [0.0]
        return Serving(
            clients=tuple(sorted(clients, key=lambda client: (client.team, client.number))),
            lag_median_ms=statistics.median(lags_s) * MS_PER_S,
            lag_max_ms=lags_s[-1] * MS_PER_S,
            refused=self._refusals.recent(now),
            monitors=tuple(f"{peer.host}:{peer.port}" for peer in (one.peer for one in server.sessions.monitors)),
            datagrams=replace(server.sessions.counts, dropped_by_kernel=server.dropped_by_kernel),
            revision=revision,
        )


def _client_info(session: Session, row: Table, mirror: Mirror, rate: RunningRate, now: Instant) -> ClientInfo:
    return ClientInfo(
        team=session.team,
        number=session.number,
        address=session.peer.host,
        port=session.peer.port,
        since=session.opened,
        sent=int(row["sent"]),
        dropped=int(row["dropped"]),
        rate_hz=rate.of(now, int(row["sent"])),
        mean_rank=mean_rank(row),
        network_ms=_ms(int(row["network_ns"])),
        client_ms=_ms(int(row["client_ns"])),
        heard=session.heard,
        mirror=MirrorConstants(a=mirror.a, b=mirror.b, c=mirror.c),
    )


def _ms(lag_ns: int) -> float | None:
    return None if lag_ns == UNKNOWN else lag_ns / NS_PER_MS
