"""What is in the database: names, types and codecs of all records.

| record | written by | tells |
| --- | --- | --- |
| service | supervisor | version, start, addresses, the settings |
| processes | supervisor | state of every process |
| frames/<camera> | capture | the newest images |
| source/<camera> | capture | what the camera is |
| sightings/<camera> | perceive | what one frame shows |
| obstacles/<camera> | obstacles | things that nobody knows |
| diagnosis/<camera> | diagnose | why nothing or too little is seen |
| world | serve | tracks at the frame's instant |
| views | serve | what every robot would see, as it goes over the wire |
| serving | serve | clients, rates and lags |
| sessions | serve | what a restarted serve needs to go on with the same clients |
| task/<task> | each task | that it lives, and how it does |
"""

from dataclasses import dataclass
from typing import Any, Generic, Protocol, TypeVar

import msgspec

from vision_core.clock import Instant
from vision_core.rtdb.layout import RecordSpec
from vision_core.rtdb.slots import SlotReader, SlotWriter
from vision_core.rtdb.store import Store
from vision_core.settings import Settings
from vision_core.types.objects import Diagnosis, Obstacles, Sightings, Team
from vision_core.types.tables import SightingsTable, ViewsTable, WorldTable
from vision_core.types.tracks import World
from vision_core.types.views import Views

T = TypeVar("T")
K_co = TypeVar("K_co", covariant=True)


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
    state: str
    """waiting, starting, running, restarting, disabled, done or stopped."""
    restarts: int
    detail: str
    """The last reason for a restart, or the progress of the compiler."""


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
    """How a task does, over the last half second."""

    pid: int
    runs: int
    """Since its start."""
    missed: int
    """Frames that it skipped since its start."""
    rate_hz: float
    response_median_ms: float
    response_max_ms: float
    note: str
    """What a person should know: waiting for frames, opening the camera, ..."""


class RecordTable(Protocol[K_co]):
    """A table that can be told as a record."""

    bytes: memoryview

    def record(self) -> K_co: ...


class TableKind(Protocol[T]):
    """A class of such tables."""

    def __call__(self, memory: bytes | None = None, /) -> RecordTable[T]: ...
    def of(self, record: T, /) -> RecordTable[T]: ...


class Encoder(Protocol):
    def encode(self, value: object, /) -> bytes: ...


class Decoder(Protocol[K_co]):
    def decode(self, data: bytes, /) -> K_co: ...


class Item(Generic[T]):
    """A record of one type: name, size, validity and codec."""

    def __init__(self, spec: RecordSpec, encoder: Encoder, decoder: Decoder[T]) -> None:
        self.spec = spec
        self._encoder = encoder
        self._decoder = decoder

    def encode(self, value: T) -> bytes:
        return self._encoder.encode(value)

    def reader(self, store: Store) -> "ItemReader[T]":
        return ItemReader(store.reader(self.spec.name), self._decoder)

    def writer(self, store: Store) -> "ItemWriter[T]":
        return ItemWriter(store.writer(self.spec.name), self._encoder)


@dataclass(frozen=True, slots=True)
class Timed(Generic[T]):
    """A value and what it is worth."""

    value: T
    sequence: int
    measured: Instant
    written: Instant
    age_s: float
    valid: bool


def packed(name: str, kind: type[T], capacity: int, validity_s: float) -> Item[T]:
    """A record that is packed (MessagePack)."""
    return Item(RecordSpec(name, capacity, validity_s), msgspec.msgpack.Encoder(), msgspec.msgpack.Decoder(kind))


class TableCodec(Generic[T]):
    """A record whose bytes are those of a table: the hot path copies them as they are, others get the record."""

    def __init__(self, kind: TableKind[T]) -> None:
        self._kind = kind

    def encode(self, value: Any, /) -> bytes:
        return self._kind.of(value).bytes.tobytes()

    def decode(self, data: bytes, /) -> T:
        return self._kind(data).record()


def tabled(name: str, kind: TableKind[T], validity_s: float) -> Item[T]:
    """A record that is a table."""
    codec = TableCodec(kind)
    return Item(RecordSpec(name, len(kind().bytes), validity_s), codec, codec)


class ItemReader(Generic[T]):
    """Reads a typed record."""

    def __init__(self, slots: SlotReader, decoder: "Decoder[T]") -> None:
        self._slots = slots
        self._decoder = decoder

    @property
    def sequence(self) -> int:
        return self._slots.sequence

    def read(self, now: Instant) -> Timed[T] | None:
        """The newest value with its age and validity; None before the first write."""
        reading = self._slots.read(now)
        if reading is None:
            return None
        return Timed(
            self._decoder.decode(reading.value),
            reading.sequence,
            reading.measured,
            reading.written,
            reading.age_s,
            reading.valid,
        )

    def value(self, now: Instant) -> T:
        """The newest value of a record that is written before its readers start. Raises LookupError."""
        timed = self.read(now)
        if timed is None:
            raise LookupError("the record was never written")
        return timed.value


class ItemWriter(Generic[T]):
    """Writes a typed record."""

    def __init__(self, slots: SlotWriter, encoder: Encoder) -> None:
        self._slots = slots
        self._encoder = encoder

    def write(self, value: T, measured: Instant, now: Instant) -> None:
        """Publish a value, measured at an instant. Raises ValueError when it does not fit."""
        self._slots.write(self._encoder.encode(value), measured, now)


SERVICE = packed("service", ServiceInfo, 65536, 0.0)
PROCESSES = Item(  # the supervisor is standard library only
    RecordSpec("processes", 16384, 3.0), msgspec.json.Encoder(), msgspec.json.Decoder(Processes)
)
WORLD: Item[World] = tabled("world", WorldTable, 0.25)
VIEWS: Item[Views] = tabled("views", ViewsTable, 0.25)
SERVING = packed("serving", Serving, 65536, 2.0)
SESSIONS = RecordSpec("sessions", 65536, 0.0)


def source(camera: str) -> Item[SourceInfo]:
    return packed(f"source/{camera}", SourceInfo, 16384, 0.0)


def sightings(camera: str) -> Item[Sightings]:
    return tabled(f"sightings/{camera}", SightingsTable, 0.25)


def obstacles(camera: str) -> Item[Obstacles]:
    return packed(f"obstacles/{camera}", Obstacles, 16384, 0.5)


def diagnosis(camera: str) -> Item[Diagnosis]:
    return packed(f"diagnosis/{camera}", Diagnosis, 16384, 5.0)


def task(name: str) -> Item[TaskInfo]:
    return packed(f"task/{name}", TaskInfo, 16384, 2.0)


def frames(camera: str, width_px: int, height_px: int) -> RecordSpec:
    """The ring of images: blue green red, row by row."""
    return RecordSpec(f"frames/{camera}", width_px * height_px * 3, 0.25, checksum=False)
