"""Process: images -> why nothing or too little is seen. Looks at one image now and then, when it has the time."""

import numpy as np

from vision_core.clock import NS_PER_S, Instant, MonotonicClock
from vision_core.rtdb import records
from vision_core.rtdb.attachment import attach
from vision_core.tasks.diagnosis import reasons_of
from vision_core.tasks.gauge import Gauge
from vision_core.tasks.perception import Perception
from vision_core.types.image import ImageFrame
from vision_core.types.objects import Diagnosis

PERIOD_NS = NS_PER_S
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
    diagnosis = records.diagnosis(camera.name).writer(attachment.store)
    copy = np.empty((camera.height_px, camera.width_px, 3), dtype=np.uint8)
    due = Instant(0)
    while not attachment.stopping:
        released = attachment.wait(LONGEST_WAIT_S)
        now = clock.now()
        gauge.publish_if_due(now)
        glance = frames.glance() if released and now >= due else None
        if glance is None:
            continue
        np.copyto(copy.reshape(-1), np.frombuffer(glance.payload, dtype=np.uint8))
        if not frames.holds(glance):  # overwritten while it was copied
            continue
        due = Instant(now + PERIOD_NS)
        seen = perception.perceive(ImageFrame(camera.name, glance.sequence, glance.measured, copy), clock).record()
        told = Diagnosis(camera.name, glance.sequence, glance.measured, reasons_of(perception, seen))
        done = clock.now()
        diagnosis.write(told, glance.measured, done)
        gauge.ran(now, done)


if __name__ == "__main__":
    main()
