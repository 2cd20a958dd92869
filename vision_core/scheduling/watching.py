"""What the tasks share that watch over a camera's images: the newest one is looked at, and what is found is told."""

from collections.abc import Callable
from typing import TypeVar

from vision_core.geometry import Bytes
from vision_core.rtdb.items import Item
from vision_core.scheduling.handle import Handle, Step
from vision_core.scheduling.latest_image import Images
from vision_core.scheduling.releases import Release
from vision_core.types.regions import Finding

T = TypeVar("T")


def watching(handle: Handle, item: Item[Finding[T]], look: Callable[[Bytes], T]) -> Step:
    """A task's step: look at the newest image and write what was found; nothing to do without a new image.

    look: takes pixels, shape (height, width, 3), blue green red. It is called with a black image at once, so that
    whatever it loads or compiles is there before the first release.
    """
    camera = handle.camera
    look(camera.black_image())
    images, told = Images(handle), handle.writer(item)
    last = 0

    def step(release: Release) -> bool:
        nonlocal last
        image = images.newest(release)
        if image is None or image.number == last:
            return False
        last = image.number
        finding = Finding(camera.name, image.number, image.grabbed, look(image.pixels))
        told.write(finding, image.grabbed, handle.clock.now())
        return True

    return step
