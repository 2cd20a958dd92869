"""Task: images -> what is drawn over the picture, while somebody looks; otherwise it reads no image."""

from vision_core.pipeline.live_colors import LiveColors
from vision_core.pipeline.overlay import OverlayMaker
from vision_core.pipeline.perception import Perception
from vision_core.rtdb import records
from vision_core.scheduling.handle import Handle, Step
from vision_core.scheduling.latest_image import Images
from vision_core.scheduling.releases import IDLE, RAN, Release, StepResult


def start(handle: Handle) -> Step:
    """Prepare nothing: what it needs is made when somebody looks for the first time."""
    looking = handle.reader(records.LOOKING)
    overlays = handle.writer(records.overlay(handle.camera.name))
    images = Images(handle)
    palettes = handle.reader(records.palette(handle.camera.name))
    prepared: tuple[OverlayMaker, LiveColors] | None = None
    last = 0

    def step(_release: Release) -> StepResult:
        nonlocal prepared, last
        look = looking.read(handle.clock.now())
        if look is None or not look.value.layers or look.value.until < handle.clock.now():
            return IDLE
        image = images.newest()
        if image is None:
            return images.none_result
        if image.number == last:
            return IDLE
        last = image.number
        if prepared is None:
            perception = Perception(handle.settings, handle.camera)
            prepared = OverlayMaker(perception), LiveColors(perception, palettes)
        maker, colors = prepared
        colors.refresh(handle.clock.now())
        overlay = maker.make(image, look.value.layers, handle.clock)
        overlays.write(overlay, image.grabbed, handle.clock.now())
        return RAN

    return step
