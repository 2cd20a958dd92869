"""Capture requests images and publishes them at their instants; source renders each request once."""

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
    """Both tasks on one real-time database, without a supervisor."""

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
        """Start a task as its process does."""
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
    """A stage whose source plays three pictures, each of another brightness."""
    for number in range(3):
        write_picture(tmp_path / f"{number}.png", np.full((480, 640, 3), 10 + number, dtype=np.uint8))
    made = Stage(load_settings(options={"source.uri": f"file:{tmp_path}", "camera.rate_hz": RATE_HZ}))
    yield made
    made.close()


class SourceThread:
    """The task source in a thread: it renders requests while the test runs capture."""

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


def test_images_are_published_in_order_and_at_the_cameras_rate(stage: Stage) -> None:
    source_thread = SourceThread(stage)
    try:
        capture_step = stage.start("capture")
        frames = stage.attachments[-1].store.reader("frames/main")
        brightness, instants = [], []
        for _ in range(6):
            result = stage.run(capture_step)
            view = frames.view()
            assert view is not None
            brightness.append(view.payload[0])
            instants.append(view.measured)
            assert result.due is not None
            assert view.written >= result.due >= view.measured
    finally:
        source_thread.end()
    assert brightness == [10, 11, 12, 10, 11, 12]
    periods = [round((after - instants[0]) * RATE_HZ / 1e9, 6) for after in instants]
    assert periods == sorted({round(period) for period in periods})


def test_a_restarted_source_does_not_render_a_request_again(stage: Stage) -> None:
    source_thread = SourceThread(stage)
    try:
        capture_step = stage.start("capture")
        stage.run(capture_step)
    finally:
        source_thread.end()
    done = stage.attachments[-1].store.reader("frames_done/main")
    before = done.sequence
    again = stage.start("source")
    assert again(Release(stage.clock.now(), stage.clock.now())) == IDLE
    assert done.sequence == before


def test_a_restarted_source_renders_the_request_that_its_predecessor_left(stage: Stage) -> None:
    stage.start("source")  # it writes its description, and dies before the request comes
    capture_step = stage.start("capture")
    waiting = threading.Thread(target=stage.run, args=(capture_step,))
    waiting.start()
    source_thread = SourceThread(stage)
    waiting.join(timeout=20.0)
    source_thread.end()
    assert not waiting.is_alive()
    assert stage.attachments[-1].store.reader("frames/main").sequence == 1


def test_an_image_of_an_older_request_is_not_published(stage: Stage) -> None:
    source_thread = SourceThread(stage)
    try:
        stage.run(stage.start("capture"))
    finally:
        source_thread.end()
    capture_step = stage.start("capture")  # a restarted capture: its first request has a new number
    store = stage.attachments[-1].store
    records.frames_done("main").writer(store).write(FrameDone(1), stage.clock.now(), stage.clock.now())
    assert capture_step(Release(stage.clock.now(), stage.clock.now())) == IDLE
    assert store.reader("frames/main").sequence == 1


def test_a_request_that_comes_while_another_is_rendered_is_not_lost(stage: Stage) -> None:
    step = stage.start("source")
    store = stage.attachments[-1].store
    requests, now = records.frame_requests("main").writer(store), stage.clock.now()
    requests.write(FrameRequest(1, 1, now), now, now)

    def wait_and_get_a_request(_keeper: RequestedKeeper) -> Instant:
        """A restarted capture writes its first request while the image for its predecessor is rendered."""
        if requests.sequence == 1:
            requests.write(FrameRequest(2, 1, now), now, now)
        return now

    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(RequestedKeeper, "wait", wait_and_get_a_request)
        assert step(Release(now, now)) == RAN
        assert step(Release(now, now)) == RAN
    filled = records.frames_done("main").reader(store).value(now)
    assert filled.number == 2


def test_after_capture_was_off_its_first_image_is_new_and_none_counts_as_missed(stage: Stage) -> None:
    source_thread = SourceThread(stage)
    try:
        capture_step = stage.start("capture")
        stage.run(capture_step)
        time.sleep(0.3)
        stage.handles[-1].switch()
        before = stage.clock.now()
        result = stage.run(capture_step)
        frames = stage.attachments[-1].store.reader("frames/main").view()
        assert frames is not None
        assert frames.measured >= before
        assert result.missed == 0
    finally:
        source_thread.end()


@pytest.mark.slow
def test_the_simulated_camera_renders_another_image_for_each_request() -> None:
    made = Stage(load_settings(options={"camera.rate_hz": RATE_HZ}))
    source_thread = SourceThread(made)
    try:
        capture_step = made.start("capture")
        frames = made.attachments[-1].store.reader("frames/main")
        seen = []
        for _ in range(3):
            made.run(capture_step)
            view = frames.view()
            assert view is not None
            seen.append(bytes(view.payload))
        assert len(set(seen)) == 3
    finally:
        source_thread.end()
        made.close()
