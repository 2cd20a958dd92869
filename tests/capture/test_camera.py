"""What can be told of a device camera without one: whose instant counts, and how its absence is said."""

import cv2
import numpy as np
import pytest

from vision_core.capture.camera import driver_instant
from vision_core.capture.source import open_source
from vision_core.clock import NS_PER_MS, NS_PER_S, Instant, ManualClock
from vision_core.errors import SourceError
from vision_core.models.camera_setup import CameraSetup
from vision_core.native.opencv import Video, write_yuyv
from vision_core.venues.loader import load_settings

NOW = Instant(4000 * NS_PER_S)


def test_a_monotonic_driver_timestamp_is_used() -> None:
    assert driver_instant(4_000_000.0 - 25.5, NOW) == NOW - 25_500_000


@pytest.mark.parametrize(
    "stamp_ms",
    [0.0, -1.0, 1.7e12, 4_000_000.0 - 1500.0, 4_000_000.0 + 20.0],
    ids=["none", "error", "wall clock", "too old", "future"],
)
def test_other_driver_timestamps_are_not_used(stamp_ms: float) -> None:
    assert driver_instant(stamp_ms, NOW) is None


def test_a_timestamp_in_the_future_by_rounding_becomes_now() -> None:
    assert driver_instant(4_000_000.0 + 0.4, NOW) == NOW
    assert driver_instant((NOW - 3 * NS_PER_MS) / NS_PER_MS, NOW) == NOW - 3 * NS_PER_MS


def test_an_absent_camera_is_named() -> None:
    settings = load_settings(options={"source.uri": "camera:/dev/video-that-is-not-there"})
    with pytest.raises(SourceError, match="video-that-is-not-there") as caught:
        open_source(settings, CameraSetup.from_settings(settings), ManualClock())
    assert caught.value.found
    assert caught.value.accepted


class FakeCapture:
    """What OpenCV hands out of a driver that gives one buffer after the other."""

    def __init__(self, *images: np.ndarray) -> None:
        self._images = list(images)

    def get(self, key: int) -> float:
        return {cv2.CAP_PROP_FRAME_WIDTH: 64.0, cv2.CAP_PROP_FRAME_HEIGHT: 48.0}.get(key, 0.0)

    def read(self) -> tuple[bool, np.ndarray | None]:
        return (True, self._images.pop(0)) if self._images else (False, None)


def yuyv_of(luma: int, cb: int, cr: int) -> np.ndarray:
    buffer = np.empty((48, 64, 2), dtype=np.uint8)
    buffer[..., 0] = luma
    buffer[:, ::2, 1], buffer[:, 1::2, 1] = cb, cr
    return buffer


@pytest.mark.parametrize(
    ("ycc", "bgr"),
    [
        ((16, 128, 128), (0, 0, 0)),
        ((235, 128, 128), (255, 255, 255)),
        ((126, 128, 128), (128, 128, 128)),
        ((81, 90, 240), (0, 0, 255)),
        ((145, 54, 34), (0, 255, 0)),
        ((41, 240, 110), (255, 0, 0)),
    ],
)
def test_yuyv_is_converted_as_bt601_says(ycc: tuple[int, int, int], bgr: tuple[int, int, int]) -> None:
    pixels = np.empty((48, 64, 3), dtype=np.uint8)
    write_yuyv(yuyv_of(*ycc), pixels)
    assert np.abs(pixels.astype(int) - bgr).max() <= 2


def test_any_yuyv_buffer_becomes_what_the_formula_says() -> None:
    buffer = np.random.default_rng(1).integers(16, 236, (48, 64, 2), dtype=np.uint8)
    pixels = np.empty((48, 64, 3), dtype=np.uint8)
    write_yuyv(buffer, pixels)
    luma = 1.164 * (buffer[..., 0].astype(float) - 16.0)
    cb, cr = (np.repeat(buffer[:, start::2, 1], 2, axis=1) - 128.0 for start in (0, 1))
    exact = np.stack([luma + 2.018 * cb, luma - 0.391 * cb - 0.813 * cr, luma + 1.596 * cr], axis=-1)
    assert np.abs(pixels - np.clip(exact, 0.0, 255.0)).max() <= 2.0


def test_a_buffer_goes_into_the_slot_and_nowhere_else() -> None:
    slots = np.zeros((3, 48, 64, 3), dtype=np.uint8)
    bgr = np.full((48, 64, 3), 77, dtype=np.uint8)
    video = Video(FakeCapture(yuyv_of(126, 128, 128), bgr, yuyv_of(16, 128, 128)[:40]))  # type: ignore[arg-type]
    assert video.read(slots[1])
    assert np.abs(slots[1].astype(int) - 128).max() <= 1
    assert not slots[0].any()
    assert not slots[2].any()
    assert video.read(slots[2])
    assert (slots[2] == 77).all()
    assert not video.read(slots[0]), "another size"
    assert not video.read(slots[0]), "no image"
    assert not slots[0].any()
