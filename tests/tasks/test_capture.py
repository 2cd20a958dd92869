"""Capture orders images and publishes them at their instants; source fills orders, each once."""

import os
import threading
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from vision_core.clock import Instant, MonotonicClock
from vision_core.models.camera_setup import CameraSetup
from vision_core.native.opencv import write_picture
from vision_core.rtdb import records
from vision_core.rtdb.infos import FrameDone, FrameRequest
from vision_core.rtdb.store import create_block
from vision_core.scheduling.attachment import Attachment, ChildResources
from vision_core.scheduling.handle import Handle, Step
from vision_core.scheduling.releases import IDLE, RAN, Release, StepResult
from vision_core.settings.schema import Settings
from vision_core.tasks import capture, source
from vision_core.tasks.table import record_specs, task_table
from vision_core.timing.rate_keeper import RequestedKeeper
from vision_core.venues.loader import load_settings

RATE_HZ = 50.0


class Stage:
    """Both tasks on one database, without a supervisor."""

    def __init__(self, settings: Settings) -> None:
        self.settings = settings
        self.table = {task.name: task for task in task_table(settings)}
        self.specs = record_specs(settings, tuple(self.table.values()), tuple(self.table))
        self.block = create_block(self.specs)
        self.events = {name: os.eventfd(0, os.EFD_NONBLOCK) for name in ("capture", "source")}
        self.clock = MonotonicClock()
        self.attachments: list[Attachment] = []
        self.handles: list[Handle] = []

    def start(self, name: str) -> Step:
        """A task as its process would start it."""
        woken = {"frames_done/main": "capture", "source/main": "capture", "frame_requests/main": "source"}
        notify: dict[str, tuple[int, ...]] = {record: (self.events[other],) for record, other in woken.items()}
        resources = ChildResources(name, os.getpid(), 0, self.block, self.specs, self.events[name], notify, {})
        attachment = Attachment(resources)
        self.attachments.append(attachment)
        start = {"capture": capture.start, "source": source.start}[name]
        self.handles.append(
            Handle(self.table[name], attachment, self.settings, CameraSetup.from_settings(self.settings))
        )
        return start(self.handles[-1])

    def run(self, step: Step) -> StepResult:
        """Call a task until it has run once."""
        while not (result := step(Release(self.clock.now(), self.clock.now()))).ran:
            pass
        return result

    def close(self) -> None:
        for descriptor in (self.block, *self.events.values()):
            os.close(descriptor)


@pytest.fixture
def stage(tmp_path: Path) -> Iterator[Stage]:
    """Three pictures that are told apart by their brightness."""
    for number in range(3):
        write_picture(tmp_path / f"{number}.png", np.full((480, 640, 3), 10 + number, dtype=np.uint8))
    made = Stage(load_settings(options={"source.uri": f"file:{tmp_path}", "camera.rate_hz": RATE_HZ}))
    yield made
    made.close()


class Background:
    """The source, filling orders beside the test as its process would."""

    def __init__(self, stage: Stage) -> None:
        self._step, self._stop = stage.start("source"), threading.Event()
        self._stage = stage
        self._thread = threading.Thread(target=self._run)
        self._thread.start()

    def _run(self) -> None:
        while not self._stop.wait(0.001):
            now = self._stage.clock.now()
            self._step(Release(now, now))

    def end(self) -> None:
        self._stop.set()
        self._thread.join()


def test_images_come_in_order_on_a_grid(stage: Stage) -> None:
    player = Background(stage)
    try:
        shoot = stage.start("capture")
        frames = stage.attachments[-1].store.reader("frames/main")
        levels, instants = [], []
        for _ in range(6):
            result = stage.run(shoot)
            view = frames.view()
            assert view is not None
            levels.append(view.payload[0])
            instants.append(view.measured)
            assert result.due is not None
            assert view.written >= result.due >= view.measured
    finally:
        player.end()
    assert levels == [10, 11, 12, 10, 11, 12]
    periods = [round((after - instants[0]) * RATE_HZ / 1e9, 6) for after in instants]
    assert periods == sorted({round(period) for period in periods})


def test_a_new_source_does_not_touch_what_is_published(stage: Stage) -> None:
    player = Background(stage)
    try:
        shoot = stage.start("capture")
        stage.run(shoot)
    finally:
        player.end()
    exposures = stage.attachments[-1].store.reader("frames_done/main")
    before = exposures.sequence
    again = stage.start("source")
    assert again(Release(stage.clock.now(), stage.clock.now())) == IDLE
    assert exposures.sequence == before


def test_a_new_source_fills_what_its_predecessor_left(stage: Stage) -> None:
    stage.start("source")  # says what it is, and dies before the order comes
    shoot = stage.start("capture")
    waiting = threading.Thread(target=stage.run, args=(shoot,))
    waiting.start()
    player = Background(stage)
    waiting.join(timeout=20.0)
    player.end()
    assert not waiting.is_alive()
    assert stage.attachments[-1].store.reader("frames/main").sequence == 1


def test_an_exposure_of_an_older_order_is_not_published(stage: Stage) -> None:
    player = Background(stage)
    try:
        stage.run(stage.start("capture"))
    finally:
        player.end()
    shoot = stage.start("capture")  # a successor: its first order has a new number
    store = stage.attachments[-1].store
    records.frames_done("main").writer(store).write(FrameDone(1), stage.clock.now(), stage.clock.now())
    assert shoot(Release(stage.clock.now(), stage.clock.now())) == IDLE
    assert store.reader("frames/main").sequence == 1


def test_an_order_that_comes_while_another_is_filled_is_not_lost(stage: Stage) -> None:
    step = stage.start("source")
    store = stage.attachments[-1].store
    orders, now = records.frame_requests("main").writer(store), stage.clock.now()
    orders.write(FrameRequest(1, 1, now), now, now)

    def grab_and_be_asked(_keeper: RequestedKeeper) -> Instant:
        """A new capture gives its first order while the old one's image is made."""
        if orders.sequence == 1:
            orders.write(FrameRequest(2, 1, now), now, now)
        return now

    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(RequestedKeeper, "wait", grab_and_be_asked)
        assert step(Release(now, now)) == RAN
        assert step(Release(now, now)) == RAN
    filled = records.frames_done("main").reader(store).value(now)
    assert filled.number == 2


def test_switched_off_and_on_capture_begins_with_an_image_of_now(stage: Stage) -> None:
    player = Background(stage)
    try:
        shoot = stage.start("capture")
        stage.run(shoot)
        time.sleep(0.3)
        stage.handles[-1].switch()
        before = stage.clock.now()
        result = stage.run(shoot)
        frames = stage.attachments[-1].store.reader("frames/main").view()
        assert frames is not None
        assert frames.measured >= before
        assert result.missed == 0
    finally:
        player.end()


@pytest.mark.slow
def test_the_simulated_camera_renders_to_order() -> None:
    made = Stage(load_settings(options={"camera.rate_hz": RATE_HZ}))
    player = Background(made)
    try:
        shoot = made.start("capture")
        frames = made.attachments[-1].store.reader("frames/main")
        seen = []
        for _ in range(3):
            made.run(shoot)
            view = frames.view()
            assert view is not None
            seen.append(bytes(view.payload))
        assert len(set(seen)) == 3
    finally:
        player.end()
        made.close()
