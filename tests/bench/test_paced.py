"""Frames at a camera's rate: each is waited for in sleep or by rehearsing, and a rehearsal sends nobody anything."""

import json
import os
from collections.abc import Iterator

import pytest

from bench import paced
from bench.paced import METHODS, Frames
from bench.paced_camera import frame_record
from bench.whole_loop import BLOCK, UNMEASURED, open_loop
from vision_core.clock import NS_PER_MS, Instant, MonotonicClock
from vision_core.rtdb.slots import SlotWriter
from vision_core.rtdb.store import Store, create_block
from vision_core.scheduling import rehearser
from vision_core.scheduling.rehearser import Part, Rehearser
from vision_core.scheduling.releases import Trigger

SIZE_PX = 4, 2


class Camera:
    """A ring of frames and who waits for them."""

    def __init__(self) -> None:
        record = frame_record(SIZE_PX)
        block, self.event = create_block([record]), os.eventfd(0, os.EFD_NONBLOCK)
        store = Store([record], block)
        os.close(block)
        self.writer: SlotWriter = store.writer(record.name)
        reader = store.reader(record.name)
        self.asked: list[bool] = []
        self.rehearser, self.part = Rehearser(MonotonicClock()), Part(self.rehearse)
        trigger = Trigger(reader, Instant(0), 0.0)
        self.frames = Frames(reader, self.event, trigger, (2, 4, 3), self.rehearser, self.part)

    def publish(self, value: int, written: Instant) -> None:
        self.writer.write(bytes([value]) * 24, written, written)
        os.eventfd_write(self.event, 1)

    def rehearse(self, give_way: object) -> bool:
        assert callable(give_way)
        self.asked.append(give_way())
        self.publish(99, MonotonicClock().now())  # the next frame comes while it is watched for
        return True


@pytest.fixture
def camera() -> Iterator[Camera]:
    made = Camera()
    yield made
    os.close(made.event)


def test_each_frame_is_taken_once(camera: Camera, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(paced, "PATIENCE_S", 0.05)
    for value in (7, 8):
        camera.publish(value, MonotonicClock().now())
        view = camera.frames.wait(rehearses=False)
        assert (camera.frames.pixels(view) == value).all()
        assert camera.frames.pixels(view).shape == (2, 4, 3)
    with pytest.raises(RuntimeError, match="no frame came"):
        camera.frames.wait(rehearses=True)


def test_a_rehearsal_comes_before_the_next_frame(camera: Camera, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(rehearser, "MARGIN_NS", 40 * NS_PER_MS)  # however late the process wakes up
    now, period = MonotonicClock().now(), 200 * NS_PER_MS
    for number in range(8, 0, -1):  # the last one was due just now
        camera.publish(number, Instant(now - (number - 1) * period))
        camera.frames.wait(rehearses=False)
        camera.rehearser.ran(NS_PER_MS)
    view = camera.frames.wait(rehearses=True)
    assert (camera.frames.pixels(view) == 99).all()
    assert camera.asked == [False]
    assert (camera.part.counts.rehearsed, camera.part.counts.cut_short) == (1, 0)


@pytest.mark.slow
def test_the_loop_rehearses_without_a_trace() -> None:
    with open_loop("640x480", 10) as loop:
        pixels = loop.perception.camera.black_image()
        assert not loop.rehearse(lambda: False), "there was no frame yet"
        loop.turn(pixels)
        loop.drain()
        before = loop.perception.robots.copy()
        assert loop.rehearse(lambda: False)
        assert not loop.rehearse(lambda: True), "it gave way"
        assert loop.drain() == 0
        assert (loop.perception.robots == before).all()


@pytest.mark.slow
def test_every_method_is_timed(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.setattr(paced, "TURNS", 1)
    monkeypatch.setattr(paced, "request_realtime", lambda _priority: "as it is")
    paced.main("640x480", 10)
    report = json.loads(capsys.readouterr().out)
    assert report["policies"].startswith("as it is, camera ")
    assert set(report["times_us"]) <= set(METHODS)
    for times in report["times_us"].values():
        assert len(times) == BLOCK - UNMEASURED
        assert min(times) > 0.0
