"""Everything the web part knows: the records of the real-time database, read together at one instant."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from vision_core.clock import Instant, MonotonicClock, seconds_between
from vision_core.geometry import Bytes
from vision_core.rtdb import records
from vision_core.rtdb.infos import (
    LAGS,
    TIMINGS,
    Processes,
    SelfTest,
    ServiceInfo,
    Serving,
    SourceInfo,
    TaskInfo,
    TaskOverride,
)
from vision_core.rtdb.items import ItemReader, Timed
from vision_core.rtdb.slots import READ_TRIES, SlotReader, SlotView
from vision_core.rtdb.store import Store
from vision_core.timing.histogram import Counts, decode
from vision_core.types.objects import Diagnosis, Obstacles, Sightings
from vision_core.types.regions import ColorDrift, ExposureCheck, FieldBoundary, Finding, LineCheck
from vision_core.types.tracks import World
from vision_core.types.views import Views

TASK_PREFIX = "task/"


@dataclass(frozen=True, slots=True)
class FrameStamp:
    """The newest image, without its pixels."""

    number: int
    grabbed: Instant
    age_s: float


@dataclass(frozen=True, slots=True)
class Picture:
    """The newest image, copied."""

    number: int
    grabbed: Instant
    pixels: Bytes
    """Shape (height, width, 3), blue green red."""


@dataclass(frozen=True, slots=True)
class ServiceSnapshot:
    """All records at one instant; None for a record that was never written."""

    now: Instant
    service: ServiceInfo
    processes: Timed[Processes] | None
    frame: FrameStamp | None
    source: Timed[SourceInfo] | None
    sightings: Timed[Sightings] | None
    obstacles: Timed[Obstacles] | None
    boundary: Timed[Finding[FieldBoundary]] | None
    lines: Timed[Finding[LineCheck]] | None
    exposure: Timed[Finding[ExposureCheck]] | None
    colors: Timed[Finding[ColorDrift]] | None
    diagnosis: Timed[Diagnosis] | None
    world: Timed[World] | None
    views: Timed[Views] | None
    serving: Timed[Serving] | None
    self_test: SelfTest | None
    task_names: tuple[str, ...]
    """Every task of the table, in its order."""
    tasks: dict[str, Timed[TaskInfo]]
    """By name; a task that has never said anything is not in it."""
    proposed: Mapping[str, TaskOverride]
    """What somebody wants of a task, by name; only where something is wanted."""


@dataclass(frozen=True, slots=True)
class Timings:
    """All histograms at one instant: counts since the start of whoever counts."""

    tasks: dict[str, Timed[Mapping[str, Counts]]]
    """By name of the task, then by name of the histogram (TIMINGS)."""
    lags: Timed[Mapping[str, Counts]] | None
    """By name of the lag (LAGS)."""


def _stamp_of(view: SlotView, now: Instant) -> FrameStamp:
    return FrameStamp(view.sequence, view.measured, seconds_between(view.measured, now))


def _counts(reader: SlotReader, names: Sequence[str], now: Instant) -> Timed[Mapping[str, Counts]] | None:
    """Histograms as they were last written; None before the first time."""
    told = reader.read(now)
    if told is None:
        return None
    return Timed(decode(names, told.value), told.sequence, told.measured, told.written, told.age_s, told.valid)


class Blackboard:
    """Reads the database. Raises LookupError when the supervisor has not written its first record."""

    def __init__(self, store: Store) -> None:
        self._clock = MonotonicClock()
        self.service = records.SERVICE.reader(store).value(self._clock.now())
        camera = self.service.settings.camera
        self._shape = (camera.height_px, camera.width_px, 3)
        self._frames = store.reader(f"frames/{camera.name}")
        self._processes = records.PROCESSES.reader(store)
        self._source = records.source(camera.name).reader(store)
        self._sightings = records.sightings(camera.name).reader(store)
        self._obstacles = records.obstacles(camera.name).reader(store)
        self._boundary = records.boundary(camera.name).reader(store)
        self._lines = records.lines(camera.name).reader(store)
        self._exposure = records.exposure(camera.name).reader(store)
        self._colors = records.colors(camera.name).reader(store)
        self._diagnosis = records.diagnosis(camera.name).reader(store)
        self._world = records.WORLD.reader(store)
        self._views = records.VIEWS.reader(store)
        self._serving = records.SERVING.reader(store)
        self._self_test = records.SELF_TEST.reader(store)
        self._proposed = records.PROPOSED.reader(store)
        self.task_names = tuple(name.removeprefix(TASK_PREFIX) for name in store.specs if name.startswith(TASK_PREFIX))
        self._tasks = {name: records.task(name).reader(store) for name in self.task_names}
        self._timings = {name: store.reader(records.timing(name).name) for name in self.task_names}
        self._lags = store.reader(records.LAG_HISTOGRAMS.name)

    def now(self) -> Instant:
        """The present instant."""
        return self._clock.now()

    def read(self) -> ServiceSnapshot:
        """Every record, now."""
        now = self.now()
        view = self._frames.view()
        tasks = {name: reader.read(now) for name, reader in self._tasks.items()}
        self_test, proposed = self._self_test.read(now), self._proposed.read(now)
        return ServiceSnapshot(
            now=now,
            service=self.service,
            processes=self._processes.read(now),
            frame=_stamp_of(view, now) if view is not None else None,
            source=self._source.read(now),
            sightings=self._sightings.read(now),
            obstacles=self._obstacles.read(now),
            boundary=self._boundary.read(now),
            lines=self._lines.read(now),
            exposure=self._exposure.read(now),
            colors=self._colors.read(now),
            diagnosis=self._diagnosis.read(now),
            world=self._world.read(now),
            views=self._views.read(now),
            serving=self._serving.read(now),
            self_test=self_test.value if self_test else None,
            task_names=self.task_names,
            tasks={name: timed for name, timed in tasks.items() if timed is not None},
            proposed=proposed.value.tasks if proposed else {},
        )

    def timings(self) -> Timings:
        """Every histogram, now. Apart from the rest, since they are large and change slowly."""
        now = self.now()
        tasks = {name: _counts(reader, TIMINGS, now) for name, reader in self._timings.items()}
        return Timings(
            tasks={name: timed for name, timed in tasks.items() if timed is not None},
            lags=_counts(self._lags, LAGS, now),
        )

    def picture(self) -> Picture | None:
        """The newest image; None before the first, or when the camera overtook every try to copy one."""
        for _ in range(READ_TRIES):
            view = self._frames.view()
            if view is None:
                continue
            pixels = np.frombuffer(view.payload, dtype=np.uint8).copy()
            if self._frames.is_unchanged(view):
                return Picture(view.sequence, view.measured, pixels.reshape(self._shape))
        return None

    @property
    def picture_number(self) -> int:
        """Number of the newest image; 0 before the first."""
        return self._frames.sequence

    @property
    def sequences(self) -> tuple[int, ...]:
        """Changes whenever a record was written."""
        eyes = (self._sightings, self._obstacles, self._diagnosis, self._world, self._views)
        readers: tuple[ItemReader[Any], ...] = (self._processes, *eyes, self._serving, *self._tasks.values())
        return tuple(reader.sequence for reader in readers)
