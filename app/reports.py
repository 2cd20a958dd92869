"""What ``/api/v1/status`` and the page tell about the service: models with a meaning in every field."""

from pydantic import BaseModel, ConfigDict

from app.blackboard import Readings
from app.readiness import reasons_not_ready
from vision_core.clock import seconds_between
from vision_core.rtdb.records import ClientInfo, ProcessInfo, Serving, SourceInfo
from vision_core.types.objects import Team


class Report(BaseModel):
    """Base of everything that is told."""

    model_config = ConfigDict(frozen=True, use_attribute_docstrings=True)


class Source(Report):
    """Where the images come from."""

    uri: str
    description: str
    repeats: bool
    """Images come round again: a still picture, or a recording in a loop."""


class Camera(Report):
    """One camera and what is seen in its newest image."""

    name: str
    width_px: int
    height_px: int
    rate_hz: float
    """As it should be."""
    measured_rate_hz: float | None
    """As it is; null while the camera's process is silent."""
    frames: int
    """Images since the start."""
    age_s: float | None
    """Of the newest image, since it was grabbed; null before the first."""
    shutter_delay_ms: float
    """From the shutter to the grab, as configured; it comes on top of every lag."""
    robots: int
    """Seen in the newest image; 0 when perception is silent."""
    balls: int
    obstacles: int
    """Things of robot size that nobody knows, where they were looked for last; 0 when nobody looks."""
    reasons: list[str]
    """Why nothing, or too little, is detected; looked into about once a second, and told for 5 s at most."""


class Client(Report):
    """One robot's session."""

    team: Team
    number: int
    address: str
    port: int
    connected_s: float
    """How long ago it connected."""
    sent: int
    dropped: int
    """Messages that the network refused."""
    rate_hz: float
    mean_rank: float
    """Mean place in the random order of a frame, 0 first .. 1 last; 0.5 is fair."""


class Lag(Report):
    """From the grab of an image to the last client's datagram, over the last frames that somebody got."""

    median_ms: float
    max_ms: float


class Process(Report):
    """One process of the service."""

    name: str
    state: str
    """waiting, starting, running, restarting, disabled, done or stopped."""
    pid: int | None
    restarts: int
    detail: str
    """The last reason for a restart, or the progress of the compiler."""
    note: str
    """What the process says about itself."""
    rate_hz: float | None
    """Runs a second; null while the process is silent."""
    response_median_ms: float | None
    """From a release to its result."""
    response_max_ms: float | None
    missed: int
    """Releases that it skipped since its start."""


class Status(Report):
    """The whole service at one instant."""

    version: str
    ready: bool
    reasons: list[str]
    """Why it is not ready, in words; empty when it is."""
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
    lag: Lag | None
    """null while nobody is served."""
    refused: list[str]
    """Requests of the last half minute that were refused, newest last."""
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
        uptime_s=seconds_between(service.boot, readings.now),
        http=service.http,
        udp=service.udp,
        source=_source(source) if source is not None else None,
        cameras=[_camera(readings)],
        clients=[_client(client, readings) for client in serving.clients] if serving else [],
        lag=_lag(serving) if serving else None,
        refused=list(serving.refused) if serving else [],
        processes=[_process(process, readings) for process in _processes(readings)],
    )


def _source(source: SourceInfo) -> Source:
    return Source(uri=source.uri, description=source.description, repeats=source.repeats)


def _lag(serving: Serving) -> Lag | None:
    if not any(client.rate_hz for client in serving.clients):
        return None
    return Lag(median_ms=serving.lag_median_ms, max_ms=serving.lag_max_ms)


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
    )


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
    )


def _processes(readings: Readings) -> tuple[ProcessInfo, ...]:
    return readings.processes.value.processes if readings.processes else ()


def _process(process: ProcessInfo, readings: Readings) -> Process:
    timed = readings.tasks.get(process.name)
    told = timed.value if timed and timed.valid else None
    return Process(
        name=process.name,
        state=process.state,
        pid=process.pid,
        restarts=process.restarts,
        detail=process.detail,
        note=told.note if told else "",
        rate_hz=told.rate_hz if told else None,
        response_median_ms=told.response_median_ms if told else None,
        response_max_ms=told.response_max_ms if told else None,
        missed=timed.value.missed if timed else 0,
    )
