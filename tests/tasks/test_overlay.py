"""The task overlay computes nothing, and reads no image, while nobody looks."""

import os
from collections.abc import Iterator

import pytest

from vision_core.clock import Instant, MonotonicClock, after
from vision_core.models.camera_setup import CameraSetup
from vision_core.rtdb import records
from vision_core.rtdb.store import create_block
from vision_core.scheduling.attachment import Attachment, ChildResources
from vision_core.scheduling.handle import Handle
from vision_core.scheduling.releases import IDLE, RAN, Release, StepResult
from vision_core.tasks import overlay
from vision_core.tasks.table import record_specs, task_table
from vision_core.types.overlay import Layer, Looking, Overlay
from vision_core.venues.loader import load_settings

pytestmark = pytest.mark.slow

SETTINGS = load_settings()
CAMERA = CameraSetup.from_settings(SETTINGS)


class Stage:
    """The task on a real-time database, without a supervisor."""

    def __init__(self) -> None:
        tasks = {task.name: task for task in task_table(SETTINGS)}
        specs = record_specs(SETTINGS, tuple(tasks.values()), tuple(tasks))
        self.block = create_block(specs)
        self.clock = MonotonicClock()
        attachment = Attachment(ChildResources("diagnose", os.getpid(), 0, self.block, specs, None, {}, {}))
        self.store = attachment.store
        self.step = overlay.start(Handle(tasks["overlay"], attachment, SETTINGS, CAMERA))
        self.look = records.LOOKING.writer(self.store)
        self.frames = self.store.writer("frames/main")

    def grab(self) -> None:
        now = self.clock.now()
        self.frames.write(CAMERA.black_image().tobytes(), now, now)

    def looks(self, until: Instant, *layers: Layer) -> None:
        self.look.write(Looking(until, layers), self.clock.now(), self.clock.now())

    def run(self) -> StepResult:
        return self.step(Release(self.clock.now(), self.clock.now()))

    def written(self) -> Overlay | None:
        timed = records.overlay("main").reader(self.store).read(self.clock.now())
        return timed.value if timed else None


@pytest.fixture
def stage() -> Iterator[Stage]:
    made = Stage()
    yield made
    os.close(made.block)


@pytest.fixture
def no_images(monkeypatch: pytest.MonkeyPatch) -> None:
    """Nobody may read an image."""

    def refused(*_: object) -> None:
        raise AssertionError("an image was read")

    monkeypatch.setattr("vision_core.scheduling.latest_image.Images.newest", refused)


@pytest.mark.usefixtures("no_images")
def test_nothing_is_read_or_made_while_nobody_looks(stage: Stage) -> None:
    stage.grab()
    assert stage.run() == IDLE
    stage.looks(Instant(stage.clock.now() - 1), Layer.BLOBS)
    assert stage.run() == IDLE
    stage.looks(after(stage.clock.now(), 60.0))
    assert stage.run() == IDLE
    assert stage.written() is None


def test_the_layers_that_somebody_looks_at_are_made_once_per_image(stage: Stage) -> None:
    stage.grab()
    stage.looks(after(stage.clock.now(), 60.0), Layer.BLOBS)
    assert stage.run() == RAN
    made = stage.written()
    assert made is not None
    assert (made.frame_number, made.classes) == (1, None)
    assert made.blobs is not None
    assert stage.run() == IDLE
    stage.looks(after(stage.clock.now(), 60.0), Layer.CLASSES)
    stage.grab()
    assert stage.run() == RAN
    made = stage.written()
    assert made is not None
    assert (made.frame_number, made.blobs) == (2, None)
    assert made.classes is not None
