"""The whole service at one instant: what ``/api/v1/status`` tells, made of what was read."""

from collections.abc import Iterable
from statistics import median

from app.web.blackboard import Readings
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
from app.web.reports.degradation import degradations
from app.web.reports.readiness import reasons_not_ready
from vision_core.clock import seconds_between
from vision_core.rtdb.infos import ClientInfo, ProcessInfo, SelfTest, Serving, SourceInfo


class Status(Report):
    """The whole service at one instant."""

    version: str
    ready: bool
    reasons: list[str]
    """Why it is not ready, in words; empty when it is."""
    degraded: list[str]
    """What is worse than it should be although robots are served: what the system refused, what is switched off."""
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


def status_from(readings: Readings) -> Status:
    """The report of what was read."""
    service = readings.service
    reasons = reasons_not_ready(readings)
    serving = readings.serving.value if readings.serving and readings.serving.valid else None
    source = readings.source.value if readings.source else None
    return Status(
        version=service.version,
        ready=not reasons,
        reasons=list(reasons),
        degraded=list(degradations(readings)),
        uptime_s=seconds_between(service.boot, readings.now),
        http=service.http,
        udp=service.udp,
        source=_source(source) if source is not None else None,
        cameras=[_camera(readings)],
        clients=[_client(client, readings) for client in serving.clients] if serving else [],
        lags=_lags(serving, service.settings.camera.shutter_delay_ms),
        refused=list(serving.refused) if serving else [],
        selftest=_machine(readings.self_test) if readings.self_test else None,
        processes=[_process(process) for process in _processes(readings)],
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


def _camera(readings: Readings) -> Camera:
    camera = readings.service.settings.camera
    capture = readings.tasks.get("capture")
    seen = readings.sightings.value if readings.sightings and readings.sightings.valid else None
    found = readings.obstacles.value if readings.obstacles and readings.obstacles.valid else None
    told = readings.diagnosis.value if readings.diagnosis and readings.diagnosis.valid else None
    return Camera(
        name=camera.name,
        width_px=camera.width_px,
        height_px=camera.height_px,
        shutter_delay_ms=camera.shutter_delay_ms,
        rate_hz=camera.rate_hz,
        measured_rate_hz=capture.value.rate_hz if capture and capture.valid else None,
        frames=readings.frame.number if readings.frame else 0,
        age_s=readings.frame.age_s if readings.frame else None,
        robots=len(seen.robots) if seen else 0,
        balls=len(seen.balls) if seen else 0,
        obstacles=len(found.obstacles) if found else 0,
        reasons=list(told.reasons) if told else [],
        boundary=_boundary(readings),
        lines=_lines(readings),
        exposure=_exposure(readings),
        colors=_colors(readings),
    )


def _boundary(readings: Readings) -> Boundary | None:
    timed = readings.boundary
    if timed is None or not timed.valid:
        return None
    seen = timed.value.found
    return Boundary(age_s=timed.age_s, found=seen.found, error_px=seen.error_px, off_px=seen.off_px)


def _lines(readings: Readings) -> Lines | None:
    timed = readings.lines
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


def _exposure(readings: Readings) -> Exposure | None:
    timed = readings.exposure
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


def _colors(readings: Readings) -> Colors | None:
    timed = readings.colors
    if timed is None or not timed.valid:
        return None
    seen = timed.value.found
    return Colors(age_s=timed.age_s, gain_bgr=seen.gain_bgr, reason=seen.reason)


def _client(client: ClientInfo, readings: Readings) -> Client:
    return Client(
        team=client.team,
        number=client.number,
        address=client.address,
        port=client.port,
        connected_s=seconds_between(client.since, readings.now),
        sent=client.sent,
        dropped=client.dropped,
        rate_hz=client.rate_hz,
        mean_rank=client.mean_rank,
        network_ms=client.network_ms,
        client_ms=client.client_ms,
    )


def _processes(readings: Readings) -> tuple[ProcessInfo, ...]:
    return readings.processes.value.processes if readings.processes else ()


def _process(process: ProcessInfo) -> Process:
    return Process(**{key: getattr(process, key) for key in Process.model_fields})
