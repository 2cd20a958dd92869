"""What the service tells about itself: the values of its records, frozen and without units of their own."""

from dataclasses import dataclass

from vision_core.clock import Instant
from vision_core.rtdb.process_state import ProcessState
from vision_core.settings.schema import Settings
from vision_core.types.objects import Team


@dataclass(frozen=True, slots=True)
class ServiceInfo:
    """What stays the same while the service runs."""

    version: str
    boot: Instant
    http: str
    udp: str
    settings: Settings


@dataclass(frozen=True, slots=True)
class ProcessInfo:
    """One process of the service, as the supervisor sees it."""

    name: str
    pid: int | None
    state: ProcessState
    restarts: int
    """Since the start of the service."""
    detail: str
    """Why it ended the last time, or the progress of the compiler."""


@dataclass(frozen=True, slots=True)
class Processes:
    processes: tuple[ProcessInfo, ...]


@dataclass(frozen=True, slots=True)
class SourceInfo:
    """What a camera is."""

    uri: str
    description: str
    repeats: bool
    rate_hz: float
    """That it promises."""


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


@dataclass(frozen=True, slots=True)
class Serving:
    """How the clients are served."""

    clients: tuple[ClientInfo, ...]
    lag_median_ms: float
    """From the grab to the last client's datagram, over the last 300 frames: the paper's lag A."""
    lag_max_ms: float
    refused: tuple[str, ...]
    """Recent requests that were refused, newest last."""


@dataclass(frozen=True, slots=True)
class TaskInfo:
    """How a task stands and does; rates, responses and intervals of late."""

    pid: int
    process: str
    enabled: bool
    trigger: str
    period_ms: float
    """In effect; 0: with every writing of its trigger."""
    offset_ms: float
    priority: int
    """Asked for; 0: an ordinary process."""
    budget_ms: float
    policy: str
    """That it has got: "FIFO 45", "nice -10", "ordinary"."""
    refused: str
    """Why that is not what was asked for, or its memory is not locked; empty when all is well."""
    runs: int
    """Since its start."""
    missed: int
    """Releases that passed without a run, since its start."""
    overruns: int
    """Runs that took longer than the budget, since its start."""
    collections: int
    """Of garbage, all of them between two runs."""
    rate_hz: float
    response_median_ms: float
    """From the release to the result."""
    response_max_ms: float
    interval_mean_ms: float
    """Between the beginnings of two runs: the inter-activation interval of the CAMBADA paper's table 3."""
    interval_sd_ms: float
    """Its jitter."""
    note: str
    """What a person should know: waiting for frames, opening the camera, ..."""


TIMINGS = ("lateness", "execution", "response", "interval")
"""Histograms of a task: from the release to the beginning of a run, from there to its end, both together; and
between the beginnings of two runs."""
LAGS = ("server", "network", "client")
"""Histograms of the PSLV paper's lags A, B, C (section 4.2); B and C as far as clients report them."""


@dataclass(frozen=True, slots=True)
class FrameRequest:
    """Capture asks for an image: which slot of the ring to fill, and for when."""

    number: int
    slot: int
    instant: Instant


@dataclass(frozen=True, slots=True)
class FrameDone:
    """An order is filled."""

    number: int


@dataclass(frozen=True, slots=True)
class TaskOverride:
    """How somebody wants a task to run from now on; what is None stays as the table has it."""

    enabled: bool | None = None
    period_ms: float | None = None
    priority: int | None = None


@dataclass(frozen=True, slots=True)
class ProposedSettings:
    """What the web side wants changed while the service runs."""

    tasks: dict[str, TaskOverride]


@dataclass(frozen=True, slots=True)
class SelfTest:
    """How well this machine keeps time: wake-ups of a process of its own on a grid of 5 ms, for two seconds."""

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
