"""The connected robot programs, and how late their views are."""

from collections.abc import Iterable
from dataclasses import asdict
from statistics import median

from app.web.blackboard import ServiceSnapshot
from app.web.reports.base import Report
from vision_core.clock import seconds_between
from vision_core.rtdb import records
from vision_core.types.objects import Team


class MirrorReport(Report):
    """A, B, C of equation 1, for distances in millimetres."""

    a: float
    b: float
    c: float


class ClientReport(Report):
    """The session of one robot program."""

    team: Team
    number: int
    address: str
    port: int
    connected_s: float
    """Time since it connected [s]."""
    sent: int
    """Datagrams that were sent to it."""
    dropped: int
    """Datagrams that the network refused."""
    rate_hz: float
    """Datagrams per second of late [1/s]."""
    mean_rank: float
    """Mean place in the random order in which clients are served, 0 first .. 1 last; 0.5 is fair."""
    network_ms: float | None
    """Lag B, from the server to the client [ms], as the client last reported it; null: it reports none."""
    client_ms: float | None
    """Lag C, until the client's program has used a view [ms], as it last reported it; null: it reports none."""
    heard_s: float
    """Time since its last datagram [s]."""
    mirror: MirrorReport
    """In effect: that which it asked for, or that of its team."""


class DatagramReport(Report):
    """What became of the datagrams that came since the task that serves was started."""

    received: int
    ignored: int
    """Without a command, or messages of a server."""
    limited: int
    """Over a rate limit, and dropped unread."""
    turned_away: int
    """From addresses that are not admitted."""
    dropped_by_kernel: int
    """Never received: they could not be a command, or came while the buffer was full."""


class LagSummary(Report):
    """One part of the lag over the last frames."""

    median_ms: float
    max_ms: float


class Lags(Report):
    """The parts of the lag from an event on the field to the robots' reaction; ``/api/v1/timing`` has histograms."""

    server: LagSummary | None
    """A: from the grab of an image to the last client's datagram; null while no client is served."""
    network: LagSummary | None
    """B: from the server to the client, over the clients that report it; null when none does."""
    client: LagSummary | None
    """C: until the client's program has used a view, over the clients that report it; null when none does."""
    shutter_delay_ms: float
    """From the shutter to the grab, as configured [ms]; it comes before A."""


def clients_from(snapshot: ServiceSnapshot) -> list[ClientReport]:
    """Every connected client; none while the serving task does not report."""
    serving = snapshot.recent(records.SERVING)
    return [
        ClientReport(
            team=client.team,
            number=client.number,
            address=client.address,
            port=client.port,
            connected_s=seconds_between(client.since, snapshot.now),
            sent=client.sent,
            dropped=client.dropped,
            rate_hz=client.rate_hz,
            mean_rank=client.mean_rank,
            network_ms=client.network_ms,
            client_ms=client.client_ms,
            heard_s=seconds_between(client.heard, snapshot.now),
            mirror=MirrorReport(a=client.mirror.a, b=client.mirror.b, c=client.mirror.c),
        )
        for client in (serving.value.clients if serving else ())
    ]


def datagrams_from(snapshot: ServiceSnapshot) -> DatagramReport | None:
    """The counts of the serving task; None while it does not report."""
    serving = snapshot.recent(records.SERVING)
    return DatagramReport(**asdict(serving.value.datagrams)) if serving else None


def lags_from(snapshot: ServiceSnapshot) -> Lags:
    """The lags of the connected clients."""
    serving = snapshot.recent(records.SERVING)
    clients = serving.value.clients if serving else ()
    is_serving = any(client.rate_hz for client in clients)
    return Lags(
        server=LagSummary(median_ms=serving.value.lag_median_ms, max_ms=serving.value.lag_max_ms)
        if serving and is_serving
        else None,
        network=_summary(client.network_ms for client in clients),
        client=_summary(client.client_ms for client in clients),
        shutter_delay_ms=snapshot.camera.shutter_delay_ms,
    )


def _summary(lags_ms: Iterable[float | None]) -> LagSummary | None:
    """Over the clients that report a lag; None when none does."""
    reported = [lag_ms for lag_ms in lags_ms if lag_ms is not None]
    return LagSummary(median_ms=median(reported), max_ms=max(reported)) if reported else None
