"""Typed records: a name, a size, a validity and a codec."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Generic, Protocol, TypeAlias, TypeVar

import msgspec

from vision_core.clock import Instant
from vision_core.rtdb.layout import RecordSpec
from vision_core.rtdb.slots import SlotReader, SlotWriter
from vision_core.rtdb.store import Store

T = TypeVar("T")
K_co = TypeVar("K_co", covariant=True)


class RecordTable(Protocol[K_co]):
    """A table that can be converted to a record."""

    bytes: memoryview

    def record(self) -> K_co: ...


class TableKind(Protocol[T]):
    """A class of such tables: made from bytes, or from a record."""

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

    @property
    def name(self) -> str:
        """Name of the record in the database."""
        return self.spec.name

    def encode(self, value: T) -> bytes:
        return self._encoder.encode(value)

    def reader(self, store: Store) -> "ItemReader[T]":
        return self.over_reader(store.reader(self.spec.name))

    def writer(self, store: Store) -> "ItemWriter[T]":
        return self.over_writer(store.writer(self.spec.name))

    def over_reader(self, slots: SlotReader) -> "ItemReader[T]":
        return ItemReader(slots, self._decoder)

    def over_writer(self, slots: SlotWriter) -> "ItemWriter[T]":
        return ItemWriter(slots, self._encoder)


@dataclass(frozen=True, slots=True)
class Timed(Generic[T]):
    """A value with its age and validity."""

    value: T
    sequence: int
    measured: Instant
    written: Instant
    age_s: float
    valid: bool


def packed(name: str, kind: type[T], capacity: int, validity_s: float) -> Item[T]:
    """A record in MessagePack."""
    return Item(RecordSpec(name, capacity, validity_s), msgspec.msgpack.Encoder(), msgspec.msgpack.Decoder(kind))


class TableCodec(Generic[T]):
    """Codec of a record whose bytes are a table: the hot path copies the bytes, other readers get the record."""

    def __init__(self, kind: TableKind[T]) -> None:
        self._kind = kind

    def encode(self, value: Any, /) -> bytes:
        return self._kind.of(value).bytes.tobytes()

    def decode(self, data: bytes, /) -> T:
        return self._kind(data).record()


def tabled(name: str, kind: TableKind[T], validity_s: float) -> Item[T]:
    """A record whose bytes are a table."""
    codec = TableCodec(kind)
    return Item(RecordSpec(name, len(kind().bytes), validity_s), codec, codec)


@dataclass(frozen=True, slots=True)
class CameraRecord(Generic[T]):
    """A record that every camera has, as NAME/CAMERA."""

    name: str
    _item: Callable[[str], Item[T]]

    def __call__(self, camera: str) -> Item[T]:
        """The record of one camera."""
        return self._item(f"{self.name}/{camera}")


AnyRecord: TypeAlias = Item[Any] | CameraRecord[Any]


def per_camera(name: str, kind: type[T], capacity: int, validity_s: float) -> CameraRecord[T]:
    """A packed record of every camera."""
    return CameraRecord(name, lambda full_name: packed(full_name, kind, capacity, validity_s))


def per_camera_table(name: str, kind: TableKind[T], validity_s: float) -> CameraRecord[T]:
    """A record of every camera that is a table."""
    return CameraRecord(name, lambda full_name: tabled(full_name, kind, validity_s))


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

    @property
    def name(self) -> str:
        """Name of the record in the database."""
        return self._slots.spec.name

    @property
    def sequence(self) -> int:
        return self._slots.sequence

    def write(self, value: T, measured: Instant, now: Instant) -> None:
        """Publish a value, measured at an instant. Raises ValueError when it does not fit."""
        self._slots.write(self._encoder.encode(value), measured, now)
