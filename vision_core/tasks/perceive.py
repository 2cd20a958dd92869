"""Process: images -> sightings. Released by every new frame; always takes the newest."""

import numpy as np

from vision_core.clock import MonotonicClock
from vision_core.rtdb import records
from vision_core.rtdb.attachment import attach
from vision_core.rtdb.slots import Glance
from vision_core.settings import Settings
from vision_core.tasks.gauge import Gauge
from vision_core.tasks.perception import Perception
from vision_core.types.image import ImageFrame

PATIENCE_PERIODS = 2.0
LONGEST_WAIT_S = 0.5


def main() -> None:
    """Run until the supervisor says stop."""
    attachment = attach()
    clock = MonotonicClock()
    gauge = Gauge(attachment, clock.now())
    settings = records.SERVICE.reader(attachment.store).value(clock.now()).settings
    camera = settings.camera
    perception = Perception(settings)
    perception.warm_up()
    frames = attachment.store.reader(f"frames/{camera.name}")
    name = records.sightings(camera.name).spec.name
    sightings = attachment.store.writer(name)
    newest, missed = frames.sequence, 0
    patience_s = min(PATIENCE_PERIODS / camera.rate_hz, LONGEST_WAIT_S)
    while not attachment.stopping:
        released = attachment.wait(patience_s)
        now = clock.now()
        gauge.note = "" if released else "waiting for an image"
        gauge.publish_if_due(now)
        glance = frames.glance() if released else None
        if glance is None or glance.sequence == newest:
            continue
        missed += glance.sequence - newest - 1
        newest = glance.sequence
        seen = perception.perceive(_image_from(glance, settings), clock)
        if not frames.holds(glance):  # the ring went round while we looked: what we saw is a mixture
            missed += 1
            continue
        done = clock.now()
        sightings.write(seen.bytes, glance.measured, done)
        attachment.notify(name)
        gauge.ran(glance.written, done, missed)
        missed = 0


def _image_from(glance: Glance, settings: Settings) -> ImageFrame:
    """The frame in place, read-only: nothing is copied."""
    camera = settings.camera
    pixels = np.frombuffer(glance.payload.toreadonly(), dtype=np.uint8)
    shaped = pixels.reshape(camera.height_px, camera.width_px, 3)
    return ImageFrame(camera.name, glance.sequence, glance.measured, shaped)


if __name__ == "__main__":
    main()
