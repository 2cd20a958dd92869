"""A step for tasks that look at the newest image of the camera and write what they found."""

from collections.abc import Callable
from typing import TypeVar

from vision_core.geometry import Bytes
from vision_core.rtdb.items import Item
from vision_core.scheduling.handle import Handle, Step
from vision_core.scheduling.latest_image import Images
from vision_core.scheduling.releases import IDLE, RAN, Release, StepResult
from vision_core.types.regions import Finding

T = TypeVar("T")


def watching(handle: Handle, item: Item[Finding[T]], look: Callable[[Bytes], T]) -> Step:
    """A task's step: look at the newest image and write what was found; idle without a new image.

    look: takes pixels, shape (height, width, 3), blue green red. It is called once with a black image, so that it loads
    and compiles everything before the first release.
    """
    camera = handle.camera
    look(camera.black_image())
    images, findings = Images(handle), handle.writer(item)
    last = 0

    def step(_release: Release) -> StepResult:
        nonlocal last
        image = images.newest()
        if image is None:
            return images.none_result
        if image.number == last:
            return IDLE
        last = image.number
        finding = Finding(camera.name, image.number, image.grabbed, look(image.pixels))
        findings.write(finding, image.grabbed, handle.clock.now())
        return RAN

    return step
