"""The records of the real-time database, read together at one instant.

The blackboard iterates ``vision_core.rtdb.records.CATALOG``: a record that is added there can be reported at once.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TypeVar

import numpy as np

from vision_core.clock import Instant, MonotonicClock, seconds_between
from vision_core.geometry import Bytes
from vision_core.models.camera_setup import CameraSetup
from vision_core.rtdb import records
from vision_core.rtdb.catalog import CatalogReader, Snapshot
from vision_core.rtdb.infos import LAGS, TIMINGS, ServiceInfo, TaskInfo, TaskOverride
from vision_core.rtdb.items import CameraRecord, Item, Timed
from vision_core.rtdb.log_record import LOG, ServiceLog
from vision_core.rtdb.slots import READ_TRIES, SlotReader, SlotView
from vision_core.rtdb.store import Store
from vision_core.rtdb.task import Task
from vision_core.timing.histogram import Counts, decode
from vision_core.types.fairness import fairness_from
from vision_core.types.tables import Table

T = TypeVar("T")
TASK_PREFIX = "task/"


@dataclass(frozen=True, slots=True)
class FrameStamp:
    """The newest image, without its pixels."""

    number: int
    grabbed: Instant
    age_s: float
    """Time since it was grabbed [s]."""


@dataclass(frozen=True, slots=True)
class Picture:
    """A copy of the newest image."""

    number: int
    grabbed: Instant
    pixels: Bytes
    """Shape (height, width, 3), blue green red."""


@dataclass(frozen=True, slots=True)
class ServiceSnapshot:
    """Everything that is known about the service at one instant."""

    now: Instant
    service: ServiceInfo
    """What stays the same while the service runs, its settings among it."""
    frame: FrameStamp | None
    """The newest image; None before the first."""
    values: Snapshot
    """The values of the catalog's records; see ``of`` and ``recent``."""
    task_names: tuple[str, ...]
    """Every task, in the order of the task table."""
    tasks: Mapping[str, Timed[TaskInfo]]
    """The newest report of each task by its name; a task that has never reported is missing."""

    @property
    def camera(self) -> CameraSetup:
        """The camera as the venue describes it."""
        return CameraSetup.from_settings(self.service.settings)

    def task(self, name: str) -> Task:
        """A task's line of the task table. Raises KeyError for an unknown name."""
        return self.service.task(name)

    def of(self, record: Item[T] | CameraRecord[T]) -> Timed[T] | None:
        """The newest value of a record, however old; None before it was first written."""
        return self.values.of(record)

    def recent(self, record: Item[T] | CameraRecord[T]) -> Timed[T] | None:
        """The newest value of a record while it is valid; None when it is older than its validity, or missing."""
        timed = self.values.of(record)
        return timed if timed and timed.valid else None

    @property
    def overrides(self) -> Mapping[str, TaskOverride]:
        """The overrides in effect by the task's name; tasks that run as the settings have them are missing."""
        live = self.of(records.LIVE_SETTINGS)
        return live.value.tasks if live else {}


@dataclass(frozen=True, slots=True)
class Timings:
    """All histograms at one instant. Counts begin with the start of the process that writes them."""

    tasks: dict[str, Timed[Mapping[str, Counts]]]
    """By the task's name, then by the histogram's (TIMINGS)."""
    lags: Timed[Mapping[str, Counts]] | None
    """By the lag's name (LAGS)."""


class Blackboard:
    """Reads the database. Raises LookupError when the supervisor has not written the record ``service`` yet."""

    def __init__(self, store: Store) -> None:
        self._clock = MonotonicClock()
        self.service = records.SERVICE.reader(store).value(self._clock.now())
        self.camera = CameraSetup.from_settings(self.service.settings)
        self._frames = store.reader(f"frames/{self.camera.name}")
        self._catalog = CatalogReader(store, self.camera.name)
        self.task_names = tuple(name.removeprefix(TASK_PREFIX) for name in store.specs if name.startswith(TASK_PREFIX))
        self._tasks = {name: records.task(name).reader(store) for name in self.task_names}
        self._timings = {name: store.reader(records.timing(name).name) for name in self.task_names}
        self._lags = store.reader(records.LAG_HISTOGRAMS.name)
        self._fairness = store.reader(records.FAIRNESS_RECORD.name)
        self._fairness_ended = store.reader(records.FAIRNESS_ENDED.name)
        self._log = LOG.reader(store)

    def now(self) -> Instant:
        """The present instant."""
        return self._clock.now()

    def read(self) -> ServiceSnapshot:
        """Every record but images and histograms, at the present instant."""
        now = self.now()
        frame = self._frames.view()
        tasks = {name: reader.read(now) for name, reader in self._tasks.items()}
        return ServiceSnapshot(
            now=now,
            service=self.service,
            frame=_stamp_of(frame, now) if frame is not None else None,
            values=self._catalog.read(now),
            task_names=self.task_names,
            tasks={name: timed for name, timed in tasks.items() if timed is not None},
        )

    def timings(self) -> Timings:
        """Every histogram at the present instant. Histograms are large and change slowly, so ``read`` omits them."""
        now = self.now()
        tasks = {name: _counts(reader, TIMINGS, now) for name, reader in self._timings.items()}
        return Timings(
            tasks={name: timed for name, timed in tasks.items() if timed is not None},
            lags=_counts(self._lags, LAGS, now),
        )

    def fairness(self) -> Table | None:
        """The record of fairness that goes on, a row of FAIRNESS; None before the first."""
        return self._fairness_of(self._fairness)

    def fairness_ended(self) -> Table | None:
        """The record of fairness that has ended last; None before the first."""
        return self._fairness_of(self._fairness_ended)

    @property
    def fairness_ended_number(self) -> int:
        """How many records of fairness have ended."""
        return self._fairness_ended.sequence

    def _fairness_of(self, reader: SlotReader) -> Table | None:
        reading = reader.read(self.now())
        if reading is None:
            return None
        row: Table = fairness_from(reading.value)[0]
        return row

    def log(self) -> ServiceLog:
        """What the processes have printed. It is large, so ``read`` omits it."""
        timed = self._log.read(self.now())
        return timed.value if timed is not None else ServiceLog((), 0, 0)

    @property
    def log_number(self) -> int:
        """How often the log was written."""
        return self._log.sequence

    def picture(self) -> Picture | None:
        """A copy of the newest image; None before the first, or when the camera overwrote each copy as it was made."""
        for _ in range(READ_TRIES):
            view = self._frames.view()
            if view is None:
                continue
            pixels = np.frombuffer(view.payload, dtype=np.uint8).copy()
            if self._frames.is_unchanged(view):
                return Picture(view.sequence, view.measured, pixels.reshape(self.camera.shape))
        return None

    @property
    def picture_number(self) -> int:
        """Number of the newest image; 0 before the first."""
        return self._frames.sequence

    def read_one(self, record: Item[T] | CameraRecord[T]) -> Timed[T] | None:
        """The newest value of one record of the catalog; None before it was first written."""
        return self._catalog.read_one(record, self.now())

    def sequence_of(self, record: Item[T] | CameraRecord[T]) -> int:
        """How often a record of the catalog was written."""
        return self._catalog.sequence_of(record)


def _stamp_of(view: SlotView, now: Instant) -> FrameStamp:
    return FrameStamp(view.sequence, view.measured, seconds_between(view.measured, now))


def _counts(reader: SlotReader, names: Sequence[str], now: Instant) -> Timed[Mapping[str, Counts]] | None:
    """Histograms as they were last written; None before the first time."""
    reading = reader.read(now)
    if reading is None:
        return None
    counts = decode(names, reading.value)
    return Timed(counts, reading.sequence, reading.measured, reading.written, reading.age_s, reading.valid)
