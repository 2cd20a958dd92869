"""The whole service at one instant: what ``/api/v1/status`` tells, made of what was read."""

from collections.abc import Iterable
from statistics import median

from app.web.blackboard import ServiceSnapshot
from app.web.health.monitor import Health, HealthState
from app.web.reports.base import (
    Boundary,
    Camera,
    Client,
    Colors,
    Exposure,
    Lag,
    Lags,
    Lines,
    Machine,
    Process,
    Report,
    Source,
)
from vision_core.clock import seconds_between
from vision_core.rtdb.infos import ClientInfo, ProcessInfo, SelfTest, Serving, SourceInfo


class Alarm(Report):
    """One cause of worse service."""

    text: str
    """In plain words."""
    detail: str
    """The technical cause; empty when the text says all that is known."""


class Status(Report):
    """The whole service at one instant."""

    version: str
    state: HealthState
    """ready; degraded: robots are served, but worse than they should be; not_ready: no robot is served."""
    ready: bool
    """Robots are served: true for ready and degraded."""
    reasons: list[str]
    """Why no robot is served; empty when ready is true."""
    degraded: list[str]
    """What is worse than it should be: text and detail of each alarm in one sentence."""
    alarms: list[Alarm]
    """What is worse than it should be."""
    uptime_s: float
    """Since the start of the service: the clients' Time."""
    http: str
    """Address of the page."""
    udp: str
    """Address where clients send their init."""
    source: Source | None
    """null before the camera's process has opened it."""
    cameras: list[Camera]
    clients: list[Client]
    lags: Lags
    refused: list[str]
    """Requests of the last half minute that were refused, newest last."""
    selftest: Machine | None
    """null where none was made."""
    processes: list[Process]


def status_from(snapshot: ServiceSnapshot, health: Health) -> Status:
    """The report of what was read."""
    service = snapshot.service
    serving = snapshot.serving.value if snapshot.serving and snapshot.serving.valid else None
    source = snapshot.source.value if snapshot.source else None
    return Status(
        version=service.version,
        state=health.state,
        ready=health.is_ready,
        reasons=list(health.reasons),
        degraded=health.sentences,
        alarms=[Alarm(text=cause.text, detail=cause.detail) for cause in health.degradations],
        uptime_s=seconds_between(service.boot, snapshot.now),
        http=service.http,
        udp=service.udp,
        source=_source(source) if source is not None else None,
        cameras=[_camera(snapshot)],
        clients=[_client(client, snapshot) for client in serving.clients] if serving else [],
        lags=_lags(serving, service.settings.camera.shutter_delay_ms),
        refused=list(serving.refused) if serving else [],
        selftest=_machine(snapshot.self_test) if snapshot.self_test else None,
        processes=[_process(process) for process in _processes(snapshot)],
    )


def _source(source: SourceInfo) -> Source:
    return Source(uri=source.uri, description=source.description, repeats=source.repeats)


def _lags(serving: Serving | None, shutter_delay_ms: float) -> Lags:
    clients = serving.clients if serving else ()
    served = serving is not None and any(client.rate_hz for client in clients)
    return Lags(
        server=Lag(median_ms=serving.lag_median_ms, max_ms=serving.lag_max_ms) if serving and served else None,
        network=_reported(client.network_ms for client in clients),
        client=_reported(client.client_ms for client in clients),
        shutter_delay_ms=shutter_delay_ms,
    )


def _reported(lags_ms: Iterable[float | None]) -> Lag | None:
    """Over the clients that report it."""
    told = [lag_ms for lag_ms in lags_ms if lag_ms is not None]
    return Lag(median_ms=median(told), max_ms=max(told)) if told else None


def _machine(test: SelfTest) -> Machine:
    return Machine(**{key: getattr(test, key) for key in Machine.model_fields})


def _camera(snapshot: ServiceSnapshot) -> Camera:
    camera = snapshot.service.settings.camera
    capture = snapshot.tasks.get("capture")
    seen = snapshot.sightings.value if snapshot.sightings and snapshot.sightings.valid else None
    found = snapshot.obstacles.value if snapshot.obstacles and snapshot.obstacles.valid else None
    told = snapshot.diagnosis.value if snapshot.diagnosis and snapshot.diagnosis.valid else None
    return Camera(
        name=camera.name,
        width_px=camera.width_px,
        height_px=camera.height_px,
        shutter_delay_ms=camera.shutter_delay_ms,
        rate_hz=camera.rate_hz,
        measured_rate_hz=capture.value.rate_hz if capture and capture.valid else None,
        frames=snapshot.frame.number if snapshot.frame else 0,
        age_s=snapshot.frame.age_s if snapshot.frame else None,
        robots=len(seen.robots) if seen else 0,
        balls=len(seen.balls) if seen else 0,
        obstacles=len(found.obstacles) if found else 0,
        reasons=list(told.reasons) if told else [],
        boundary=_boundary(snapshot),
        lines=_lines(snapshot),
        exposure=_exposure(snapshot),
        colors=_colors(snapshot),
    )


def _boundary(snapshot: ServiceSnapshot) -> Boundary | None:
    timed = snapshot.boundary
    if timed is None or not timed.valid:
        return None
    seen = timed.value.found
    return Boundary(age_s=timed.age_s, found=seen.found, error_px=seen.error_px, off_px=seen.off_px)


def _lines(snapshot: ServiceSnapshot) -> Lines | None:
    timed = snapshot.lines
    if timed is None or not timed.valid:
        return None
    seen = timed.value.found
    return Lines(
        age_s=timed.age_s,
        known=seen.known,
        found=seen.found,
        samples=seen.samples,
        residual_px=seen.residual_px,
        outside=seen.outside,
    )


def _exposure(snapshot: ServiceSnapshot) -> Exposure | None:
    timed = snapshot.exposure
    if timed is None or not timed.valid:
        return None
    seen = timed.value.found
    return Exposure(
        age_s=timed.age_s,
        brightest=seen.brightest,
        median_luma=seen.median_luma,
        white=seen.white,
        reasons=list(seen.reasons),
    )


def _colors(snapshot: ServiceSnapshot) -> Colors | None:
    timed = snapshot.colors
    if timed is None or not timed.valid:
        return None
    seen = timed.value.found
    return Colors(age_s=timed.age_s, gain_bgr=seen.gain_bgr, reason=seen.reason)


def _client(client: ClientInfo, snapshot: ServiceSnapshot) -> Client:
    return Client(
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
    )


def _processes(snapshot: ServiceSnapshot) -> tuple[ProcessInfo, ...]:
    return snapshot.processes.value.processes if snapshot.processes else ()


def _process(process: ProcessInfo) -> Process:
    return Process(**{key: getattr(process, key) for key in Process.model_fields})
