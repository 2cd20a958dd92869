"""What ``/api/v1/status`` and the page tell about the service: models with a meaning in every field."""

from collections.abc import Iterable
from statistics import median

from pydantic import BaseModel, ConfigDict

from app.blackboard import Readings
from app.degradation import degradations
from app.readiness import reasons_not_ready
from vision_core.clock import seconds_between
from vision_core.rtdb.infos import ClientInfo, ProcessInfo, SelfTest, Serving, SourceInfo
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
    network_ms: float | None
    """Lag B, from the server to the client, as it last reported it; null: it reports nothing."""
    client_ms: float | None
    """Lag C, until its program has used a view, as it last reported it."""


class Lag(Report):
    """One part of the lag, of late."""

    median_ms: float
    max_ms: float


class Lags(Report):
    """The parts of the lag between what happens and what robots make of it; ``/api/v1/timing`` has their histograms."""

    server: Lag | None
    """A: from the grab of an image to the last client's datagram, of the last frames; null while nobody is served."""
    network: Lag | None
    """B: from the server to the client, of the clients that report it; null for none."""
    client: Lag | None
    """C: until a client's program has used it, of the clients that report it; null for none."""
    shutter_delay_ms: float
    """From the shutter to the grab, as configured: before all the others."""


class Machine(Report):
    """How well this machine keeps time: the self-test at the start."""

    grade: str
    """Of wake-ups, p99 of their lateness: A < 0.2 ms, B < 2 ms, C worse."""
    policy: str
    """That a real-time process gets here: "FIFO 50", "nice -10" or "ordinary"."""
    refused: str
    """Why it is not real time; empty when it is."""
    memory_locked: bool
    memory_refused: str
    wakeups: int
    lateness_median_us: float
    lateness_p99_us: float
    lateness_max_us: float


class Process(Report):
    """One process of the service; what runs in it is told by ``/api/v1/tasks``."""

    name: str
    state: str
    """waiting, starting, running, restarting, disabled, done or stopped."""
    pid: int | None
    restarts: int
    detail: str
    """The last reason for a restart, or the progress of the compiler."""


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
        network_ms=client.network_ms,
        client_ms=client.client_ms,
    )


def _processes(readings: Readings) -> tuple[ProcessInfo, ...]:
    return readings.processes.value.processes if readings.processes else ()


def _process(process: ProcessInfo) -> Process:
    return Process(**{key: getattr(process, key) for key in Process.model_fields})
