"""The tasks that watch over the images: each tells what it found of the newest one, once, and of no old one."""

import os
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

from tests.scheduling.tables import line
from vision_core.capture.source import open_source
from vision_core.clock import Instant, ManualClock, MonotonicClock, after
from vision_core.geometry import Bytes
from vision_core.models.camera_setup import CameraSetup
from vision_core.rtdb import records
from vision_core.rtdb.items import Item
from vision_core.rtdb.store import create_block
from vision_core.rtdb.task import PERIOD
from vision_core.scheduling.attachment import Attachment, ChildResources
from vision_core.scheduling.handle import Handle, Step
from vision_core.scheduling.releases import IDLE, RAN, Release
from vision_core.tasks import boundary, colors, exposure, lines
from vision_core.types.regions import ColorDrift, ExposureCheck, FieldBoundary, LineCheck
from vision_core.venues.loader import load_settings

SETTINGS = load_settings()
CAMERA = SETTINGS.camera
FRAMES = records.frames(CAMERA.name, CAMERA.width_px, CAMERA.height_px)
SIGHTINGS = records.sightings(CAMERA.name).spec
WATCHERS: list[tuple[Any, Item[Any], type[Any]]] = [
    (boundary, records.boundary(CAMERA.name), FieldBoundary),
    (lines, records.lines(CAMERA.name), LineCheck),
    (exposure, records.exposure(CAMERA.name), ExposureCheck),
    (colors, records.colors(CAMERA.name), ColorDrift),
]
RELEASE = Release(Instant(0), Instant(0))

pytestmark = pytest.mark.slow


class Watch:
    """One watching task on a database of its own."""

    def __init__(self, module: Any, item: Item[Any]) -> None:
        task = line("watch", PERIOD, (FRAMES.name, SIGHTINGS.name), (item.spec.name,), "watch", period_s=0.1)
        specs = (FRAMES, SIGHTINGS, item.spec, records.heartbeat("watch"))
        self._block = create_block(specs)
        self._attachment = Attachment(ChildResources("watch", os.getpid(), 0, self._block, specs, None, {}, {}))
        self._frames = self._attachment.store.writer(FRAMES.name)
        self._told = item.reader(self._attachment.store)
        self._clock = MonotonicClock()
        self.step: Step = module.start(Handle(task, self._attachment, SETTINGS, CameraSetup.from_settings(SETTINGS)))

    def show(self, pixels: Bytes, age_s: float = 0.0) -> Instant:
        """The camera's next image; when it was grabbed."""
        now = self._clock.now()
        grabbed = after(now, -age_s)
        self._frames.write(pixels.tobytes(), grabbed, now)
        return grabbed

    def told(self) -> Any:
        """The record as it is read."""
        return self._told.read(self._clock.now())

    def close(self) -> None:
        self._attachment.store.close()
        os.close(self._block)


@pytest.fixture(scope="module")
def image() -> Bytes:
    pixels = np.empty((CAMERA.height_px, CAMERA.width_px, 3), dtype=np.uint8)
    source = open_source(SETTINGS, CameraSetup.from_settings(SETTINGS), ManualClock(), paced=False)
    source.grab(pixels)
    source.close()
    return pixels


@pytest.fixture(params=WATCHERS, ids=[module.__name__.rpartition(".")[2] for module, _, _ in WATCHERS])
def watched(request: pytest.FixtureRequest) -> Iterator[tuple[Watch, type[Any]]]:
    module, item, kind = request.param
    watch = Watch(module, item)
    yield watch, kind
    watch.close()


def test_the_newest_image_is_told_of_once(watched: tuple[Watch, type[Any]], image: Bytes) -> None:
    watch, kind = watched
    assert watch.step(RELEASE) == IDLE  # no image yet
    assert watch.told() is None
    watch.show(np.zeros_like(image))
    grabbed = watch.show(image)
    assert watch.step(RELEASE) == RAN
    timed = watch.told()
    assert (timed.value.camera, timed.value.frame_number, timed.value.grabbed) == (CAMERA.name, 2, grabbed)
    assert (timed.measured, timed.valid) == (grabbed, True)
    assert isinstance(timed.value.found, kind)
    assert watch.step(RELEASE) == IDLE  # the same image again
    assert watch.told().sequence == 1


def test_an_image_of_long_ago_is_none(watched: tuple[Watch, type[Any]], image: Bytes) -> None:
    watch, _ = watched
    watch.show(image, age_s=5.0)
    assert watch.step(RELEASE) == IDLE
    assert watch.told() is None


def found(module: Any, item: Item[Any], pixels: Bytes) -> Any:
    watch = Watch(module, item)
    watch.show(pixels)
    watch.step(RELEASE)
    value = watch.told().value.found
    watch.close()
    return value


def test_a_good_picture_is_told_as_good(image: Bytes) -> None:
    edge, line, light, drift = (found(module, item, image) for module, item, _ in WATCHERS)
    assert abs(edge.error_px) < 1.0
    assert line.residual_px < 0.25
    assert light.reasons == ()
    assert drift.reason == ""
    assert np.abs(np.log(drift.gain_bgr)).max() < 0.3


def test_dimmer_light_shows_in_exposure_and_gains(image: Bytes) -> None:
    bright, dim = image, (image * 0.5).astype(np.uint8)
    exposures = [found(exposure, WATCHERS[2][1], pixels).median_luma for pixels in (bright, dim)]
    assert exposures[1] == pytest.approx(0.5 * exposures[0], rel=0.05)
    gains = [np.array(found(colors, WATCHERS[3][1], pixels).gain_bgr) for pixels in (bright, dim)]
    assert gains[1] == pytest.approx(2.0 * gains[0], rel=0.1)


def test_darkness_is_told_with_its_reason(image: Bytes) -> None:
    black = np.zeros_like(image)
    (reason,) = found(exposure, WATCHERS[2][1], black).reasons
    assert "black" in reason.text
    drift = found(colors, WATCHERS[3][1], black)
    assert (drift.gain_bgr, "too dark" in drift.reason) == ((1.0, 1.0, 1.0), True)
