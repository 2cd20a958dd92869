"""The values of every record that can be shown, read together at one instant."""

from collections.abc import Iterator, Mapping
from typing import Any, TypeVar

from vision_core.clock import Instant
from vision_core.rtdb import records
from vision_core.rtdb.items import CameraRecord, Item, Timed
from vision_core.rtdb.store import Store

T = TypeVar("T")


def catalog(camera: str) -> Iterator[Item[Any]]:
    """Every record of the catalog, of one camera where each camera has one."""
    for record in records.CATALOG:
        yield record(camera) if isinstance(record, CameraRecord) else record


class Snapshot:
    """What the records said at one instant."""

    def __init__(self, values: Mapping[str, Timed[Any]]) -> None:
        """values: by the record's name, without the camera's."""
        self._values = values

    def of(self, record: Item[T] | CameraRecord[T]) -> Timed[T] | None:
        """The value of a record of the catalog with its age; None before it was first written."""
        return self._values.get(record.name)


class CatalogReader:
    """Reads every record of the catalog."""

    def __init__(self, store: Store, camera: str) -> None:
        items = zip(records.CATALOG, catalog(camera), strict=True)
        self._readers = {record.name: item.reader(store) for record, item in items}

    def read(self, now: Instant) -> Snapshot:
        """All values, with their age at an instant."""
        values = {name: reader.read(now) for name, reader in self._readers.items()}
        return Snapshot({name: timed for name, timed in values.items() if timed is not None})

    def read_one(self, record: Item[T] | CameraRecord[T], now: Instant) -> Timed[T] | None:
        """The value of one record, with its age at an instant; None before it was first written."""
        timed: Timed[T] | None = self._readers[record.name].read(now)
        return timed

    def sequence_of(self, record: Item[T] | CameraRecord[T]) -> int:
        """How often a record was written."""
        return self._readers[record.name].sequence
