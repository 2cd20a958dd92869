"""Task: images -> sightings. Released by every new frame; always takes the newest.

It reads the image where it lies and asks afterwards whether it still lay there: a few rows and windows of it are all
that it needs, and a copy of the whole would cost as much as perceiving it (docs/decisions/0006). What it saw in an
image that was overwritten meanwhile is thrown away and counted.
"""

import numpy as np

from vision_core.models.camera_setup import CameraSetup
from vision_core.pipeline.perception import Perception
from vision_core.rtdb import records
from vision_core.rtdb.slots import SlotView
from vision_core.scheduling.handle import Handle, Step
from vision_core.scheduling.releases import Release
from vision_core.types.image import ImageFrame


def start(handle: Handle) -> Step:
    """Compile the colors, load the kernels."""
    camera = handle.camera
    perception = Perception(handle.settings, camera)
    perception.warm_up()
    frames = handle.raw_reader(f"frames/{camera.name}")
    sightings = handle.raw_writer(records.sightings(camera.name).spec.name)

    perceived = frames.sequence

    def step(release: Release) -> bool:
        nonlocal perceived
        view = frames.view()
        if view is None or view.sequence == perceived:
            return False
        perceived = view.sequence
        release.missed += view.sequence - release.sequence  # newer ones have come since the release
        seen = perception.perceive(_image_from(view, camera), handle.clock)
        if not frames.is_unchanged(view):  # the ring went round while we looked: what we saw is a mixture
            handle.note = "the camera overtook the last look: it was thrown away"
            release.missed += 1
            return True
        handle.note = ""
        sightings.write(seen.bytes, view.measured, handle.clock.now())
        return True

    return step


def _image_from(view: SlotView, camera: CameraSetup) -> ImageFrame:
    """The frame in place, read-only: nothing is copied."""
    pixels = np.frombuffer(view.payload.toreadonly(), dtype=np.uint8)
    shaped = pixels.reshape(camera.shape)
    return ImageFrame(camera.name, view.sequence, view.measured, shaped)
