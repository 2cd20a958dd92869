"""The values of the service's records about itself."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum

from msgspec.structs import replace

from vision_core.clock import Instant
from vision_core.rtdb.process_state import ProcessState, RestartState
from vision_core.rtdb.task import Task
from vision_core.settings.layers import Layer
from vision_core.settings.live import LIVE
from vision_core.settings.schema import (
    AdmissionSettings,
    FaultSettings,
    MatchSettings,
    MirrorConstants,
    MirrorSettings,
    Settings,
    TaskTimes,
    TrackSettings,
    ViewSettings,
)
from vision_core.types.datagrams import DatagramCounts
from vision_core.types.objects import Team


@dataclass(frozen=True, slots=True)
class ServiceInfo:
    """What does not change until the service is restarted."""

    version: str
    boot: Instant
    http: str
    udp: str
    settings: Settings
    tasks: tuple[Task, ...]
    """The task table."""
    layers: tuple[Layer, ...] = ()
    """Where the settings come from, the lowest first, without the text of files: see ``venues.loader.with_overlay``."""
    database: str = ""
    """Path of the file that keeps what is changed on the page."""
    venue: str = "default"
    """Which venue and further file the settings are of, for names of files."""
    restarts: int = 0
    """How often the whole service was restarted since ``boot``."""

    def task(self, name: str) -> Task:
        """A task's line of the table. Raises KeyError for an unknown name."""
        for task in self.tasks:
            if task.name == name:
                return task
        raise KeyError(name)


@dataclass(frozen=True, slots=True)
class ProcessInfo:
    """One process of the service."""

    name: str
    pid: int | None
    state: ProcessState
    restarts: int
    """Since the start of the service."""
    detail: str
    """Why it ended the last time, or the progress of the compiler."""


@dataclass(frozen=True, slots=True)
class RestartStatus:
    """The newest wish to restart the whole service."""

    state: RestartState = RestartState.NONE
    detail: str = ""
    """Why it was refused, or how far the check is."""


@dataclass(frozen=True, slots=True)
class RestartRequest:
    """Somebody wants the whole service to be restarted."""

    who: str


@dataclass(frozen=True, slots=True)
class Processes:
    processes: tuple[ProcessInfo, ...]
    restart: RestartStatus = RestartStatus()


@dataclass(frozen=True, slots=True)
class SourceInfo:
    """A source of images."""

    uri: str
    description: str
    repeats: bool
    """It may deliver the same picture again and again, as a picture file does."""
    rate_hz: float
    """Nominal frame rate."""


@dataclass(frozen=True, slots=True)
class ClientInfo:
    """One session."""

    team: Team
    number: int
    address: str
    port: int
    since: Instant
    sent: int
    dropped: int
    rate_hz: float
    mean_rank: float
    """Mean place in the random order of a frame, 0 first .. 1 last; 0.5 is fair."""
    network_ms: float | None
    """The paper's lag B, as far as the client reports it."""
    client_ms: float | None
    """The paper's lag C."""
    heard: Instant
    """Its last datagram."""
    mirror: MirrorConstants
    """In effect: its own, that of its team, or that of the field."""


@dataclass(frozen=True, slots=True)
class RefusedRequest:
    """Requests for the same robot that were refused for the same reason."""

    address: str
    port: int
    team: Team | None
    """None where the request named no robot."""
    number: int | None
    error: str
    """A value of ``protocol.error_codes.ErrorCode``."""
    first: Instant
    last: Instant
    count: int


@dataclass(frozen=True, slots=True)
class Serving:
    """The clients, and how they are served."""

    clients: tuple[ClientInfo, ...]
    lag_median_ms: float
    """From the grab to the last client's datagram, over the last 300 frames: the paper's lag A."""
    lag_max_ms: float
    refused: tuple[RefusedRequest, ...]
    """Recent requests that were refused, newest last."""
    monitors: tuple[str, ...] = ()
    """Addresses of the programs that are sent the whole field."""
    datagrams: DatagramCounts = field(default_factory=DatagramCounts)
    revision: int = 0
    """Of the live settings in effect."""


class RefusalKind(StrEnum):
    """What the kernel can refuse a task."""

    PRIORITY = "SCHED_FIFO"
    MEMORY = "locking memory"
    CORES = "running on cores"


@dataclass(frozen=True, slots=True)
class Refusal:
    """What the kernel refused a process, and why."""

    kind: RefusalKind
    asked: str
    """The priority, or the cores; empty for memory."""
    why: str

    def __str__(self) -> str:
        return f"{self.kind} {self.asked}".rstrip() + f" is refused: {self.why}"


@dataclass(slots=True)
class Rehearsals:
    """How often a task has rehearsed its next run, since its start."""

    rehearsed: int = 0
    cut_short: int = 0
    """Gave way to a release."""
    skipped: int = 0
    """Releases before which there was no time for one."""
    spent_s: float = 0.0
    """In rehearsals, and in watching for the release after them."""


@dataclass(frozen=True, slots=True)
class TaskInfo:
    """The state of a task; its recent rate, responses and intervals."""

    pid: int
    process: str
    trigger: str
    times: TaskTimes
    """In effect."""
    policy: str
    """Of its process: "FIFO 45", "nice -10", "ordinary"."""
    refusals: tuple[Refusal, ...]
    """What the kernel refused it."""
    runs: int
    """Since its start."""
    missed: int
    """Releases that passed without a run, since its start."""
    overruns: int
    """Runs that took longer than the budget, since its start."""
    collections: int
    """Garbage collections, all of them between two runs."""
    rate_hz: float
    response_median_ms: float
    """From the release to the result."""
    response_max_ms: float
    interval_mean_ms: float
    """Between the beginnings of two runs: the inter-activation interval of the CAMBADA paper's table 3."""
    interval_sd_ms: float
    """Its standard deviation, the jitter."""
    rehearsals: Rehearsals | None
    """None: the task has no rehearsal."""
    note: str
    """What a person should know: waiting for frames, opening the camera, ..."""


TIMINGS = ("lateness", "execution", "response", "interval")
"""Histograms of a task: from the release to the beginning of a run, from there to its end, both together; and
between the beginnings of two runs."""
LAGS = ("server", "network", "client")
"""Histograms of the PSLV paper's lags A, B, C (section 4.2); B and C as far as clients report them."""


@dataclass(frozen=True, slots=True)
class FrameRequest:
    """A request of the task ``capture`` for an image: which slot of the ring to fill, and for which instant."""

    number: int
    slot: int
    instant: Instant


@dataclass(frozen=True, slots=True)
class FrameDone:
    """The image of a request is in its slot."""

    number: int


@dataclass(frozen=True, slots=True)
class TaskOverride:
    """A change of a task's times while the service runs; None leaves a value as the table has it."""

    enabled: bool | None = None
    period_ms: float | None = None
    priority: int | None = None
    rehearse: bool | None = None


@dataclass(frozen=True, slots=True)
class EndedSession:
    """The operator has ended the session of a robot that was opened at an instant."""

    team: Team
    number: int
    since: Instant


NEVER = Instant(0)


@dataclass(frozen=True, slots=True)
class LiveSettings:
    """The settings that hold from the next frame on, and what the operator has ended."""

    revision: int
    tasks: dict[str, TaskOverride]
    """By the task's name."""
    match: MatchSettings
    mirror: MirrorSettings
    tracks: TrackSettings
    views: ViewSettings
    admission: AdmissionSettings
    faults: FaultSettings
    adapt: bool
    """colors.light.adapt; False: the colors of the set-up are held."""
    ended: tuple[EndedSession, ...] = ()
    games: int = 0
    """How often the operator has begun a new game of the simulated match."""
    keys: dict[str, str] = field(default_factory=dict)
    """The digest of the key of the team that plays blue or yellow; a team without a key is left out."""
    monitor_key: str | None = None
    """The digest of the key with which a monitor sees the field during a match; None: there is none."""
    fairness_asked: Instant = NEVER
    """When the operator last asked for a new record of fairness."""

    @staticmethod
    def of(settings: Settings, revision: int = 0, tasks: Mapping[str, TaskOverride] | None = None) -> "LiveSettings":
        """The live part of settings."""
        live = {name: getattr(settings, name) for name in LIVE}
        return LiveSettings(revision, dict(tasks or {}), **live, adapt=settings.colors.light.adapt)

    def over(self, settings: Settings) -> Settings:
        """Settings in which the live part is this one; the times of tasks are the executive's affair."""
        return replace(settings, **{name: getattr(self, name) for name in LIVE})


@dataclass(frozen=True, slots=True)
class SelfTest:
    """How well this machine keeps time: wake-ups of one process on a grid of 5 ms, for two seconds."""

    grade: str
    """A: p99 < 0.2 ms, B: < 2 ms, C: worse."""
    policy: str
    refused: str
    memory_locked: bool
    memory_refused: str
    wakeups: int
    lateness_median_us: float
    lateness_p99_us: float
    lateness_max_us: float
