"""Task: images -> sightings. Released by every new frame; always takes the newest.

It reads the image in the ring, without a copy, and checks afterwards that the camera has not overwritten it: perception
reads only a few rows and windows, and a copy of the whole image would cost as much (docs/decisions/0006). The result of
an image that was overwritten is thrown away and counted as missed.
"""

import numpy as np

from vision_core.models.camera_setup import CameraSetup
from vision_core.pipeline.live_colors import LiveColors
from vision_core.pipeline.live_suggestions import SuggestedRobots
from vision_core.pipeline.perception import Perception
from vision_core.rtdb import records
from vision_core.rtdb.slots import SlotView
from vision_core.scheduling.handle import Handle, Step
from vision_core.scheduling.rehearser import GiveWay
from vision_core.scheduling.releases import IDLE, Release, StepResult
from vision_core.types.image import ImageFrame


def start(handle: Handle) -> Step:
    """Compile the color table and load the kernels."""
    camera = handle.camera
    perception = Perception(handle.settings, camera)
    perception.warm_up()
    frames = handle.raw_reader(f"frames/{camera.name}")
    sightings = handle.raw_writer(records.sightings(camera.name).name)
    colors = LiveColors(perception, handle.reader(records.palette(camera.name)))
    suggested = SuggestedRobots(perception, handle.reader(records.suggestions(camera.name)))
    perceived = frames.sequence
    last: SlotView | None = None

    def newest() -> SlotView | None:
        """The newest image, to be seen with the newest colors."""
        colors.refresh(handle.clock.now())
        suggested.refresh(handle.clock.now())
        return frames.view()

    def step(release: Release) -> StepResult:
        nonlocal perceived, last
        view = newest()
        if view is None or view.sequence == perceived:
            return IDLE
        perceived, last = view.sequence, view
        newer = view.sequence - release.sequence  # images that came between the release and this call
        seen = perception.perceive(_image_from(view, camera), handle.clock)
        if not frames.is_unchanged(view):  # the ring went round meanwhile: the result mixes two images
            handle.note = "the camera overwrote the last image while it was perceived: the result was thrown away"
            return StepResult(missed=newer + 1)
        handle.note = ""
        sightings.write(seen.bytes, view.measured, handle.clock.now())
        return StepResult(missed=newer)

    def rehearse(give_way: GiveWay) -> bool:
        """Perceive the last image once more, while it is still in the ring."""
        newest()
        return last is not None and frames.is_unchanged(last) and perception.rehearse(give_way)

    handle.rehearse_with(rehearse)
    return step


def _image_from(view: SlotView, camera: CameraSetup) -> ImageFrame:
    """The image in the ring, read-only and not copied."""
    pixels = np.frombuffer(view.payload.toreadonly(), dtype=np.uint8)
    shaped = pixels.reshape(camera.shape)
    return ImageFrame(camera.name, view.sequence, view.measured, shaped)
