"""What is told about the service: models with a meaning in every field. ``app.web.reports.status`` fills them."""

from pydantic import BaseModel, ConfigDict

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


class Boundary(Report):
    """Where the field's carpet ends in the picture."""

    age_s: float
    """Of the image that was looked at."""
    found: float
    """Share of the directions in which an end is seen, of those in which one should be."""
    error_px: float | None
    """Median distance from where the venue has it, outward positive: a wrong scale; null: too little is seen."""
    off_px: float | None
    """Median of the same distances without their signs: a camera that was shifted or turned, too."""


class Lines(Report):
    """Whether painted lines are where the field and the camera say: a camera that was bumped shows here."""

    age_s: float
    """Of the image that was looked at."""
    known: int
    """Lines that can be judged; 0 where none are painted, or they are too thin."""
    found: int
    samples: float | None
    """Share of their points at which there is paint; null where none is known."""
    residual_px: float | None
    """Median of how far each line found lies beside its place."""
    outside: float
    """Share of all lines' points outside of the picture."""


class Exposure(Report):
    """How light the field is [grey levels]; null where the picture shows nothing of it."""

    age_s: float
    """Of the image that was looked at."""
    brightest: float | None
    """All but 0.2 % of the field stay below it in their brightest channel."""
    median_luma: float | None
    white: float | None
    """Share of the field in which a channel is at the sensor's end."""
    reasons: list[str]
    """What is wrong, in words."""


class Colors(Report):
    """How the light differs from the one that the colors were tuned in."""

    age_s: float
    """Of the image that was looked at."""
    gain_bgr: tuple[float, float, float]
    """What makes the picture look as in the venue's light: blue, green, red."""
    reason: str
    """Why that cannot be judged; empty when it can."""


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
    boundary: Boundary | None
    """null while nobody looks, as the next three."""
    lines: Lines | None
    exposure: Exposure | None
    colors: Colors | None


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
