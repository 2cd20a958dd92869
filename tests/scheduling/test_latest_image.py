"""A tracker's own copy of the newest image, and what is said when the camera is faster than the copy."""

from types import SimpleNamespace
from typing import Any

from vision_core.clock import Instant, ManualClock
from vision_core.models.camera_setup import CameraSetup
from vision_core.rtdb.slots import READ_TRIES, SlotView
from vision_core.scheduling.latest_image import Images
from vision_core.scheduling.releases import IDLE, StepResult
from vision_core.venues.loader import load_settings

SETTINGS = load_settings()
CAMERA = SETTINGS.camera
PAYLOAD = memoryview(bytes([7]) * (CAMERA.height_px * CAMERA.width_px * 3))


class Ring:
    """A ring whose writer overtakes a number of glances."""

    def __init__(self, overtakes: int) -> None:
        self.left = overtakes

    def view(self) -> SlotView:
        return SlotView(PAYLOAD, 5, Instant(0), Instant(0))

    def is_unchanged(self, _view: SlotView) -> bool:
        self.left -= 1
        return self.left < 0


def images_from(overtakes: int) -> tuple[Images, Any]:
    handle: Any = SimpleNamespace(
        camera=CameraSetup.from_settings(SETTINGS),
        clock=ManualClock(),
        note="",
        raw_reader=lambda _name: Ring(overtakes),
    )
    return Images(handle), handle


def test_a_copy_that_was_overwritten_is_made_again() -> None:
    images, handle = images_from(READ_TRIES - 1)
    image = images.newest()
    assert image is not None
    assert (image.number, int(image.pixels.min()), images.none_result) == (5, 7, IDLE)
    assert handle.note == "the camera overwrote 2 images while they were copied"


def test_a_release_whose_copies_were_all_overwritten_is_missed() -> None:
    images, handle = images_from(READ_TRIES)
    assert images.newest() is None
    assert images.none_result == StepResult(ran=False, missed=1)
    assert handle.note == "the camera overwrote 3 images while they were copied"
