"""What the tasks share that look at an image now and then: each takes a copy of its own, when it is due."""

from collections.abc import Iterator

import numpy as np

from vision_core.clock import Clock, Instant
from vision_core.rtdb.attachment import Attachment
from vision_core.settings import CameraSettings
from vision_core.tasks.gauge import Gauge
from vision_core.types.image import ImageFrame

LONGEST_WAIT_S = 0.5


def glimpses(
    attachment: Attachment, gauge: Gauge, clock: Clock, camera: CameraSettings, period_ns: int
) -> Iterator[tuple[ImageFrame, Instant]]:
    """Images and when each was taken, at most one in a period, until the supervisor says stop.

    The same memory is used for every image.
    """
    frames = attachment.store.reader(f"frames/{camera.name}")
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
        if frames.holds(glance):  # otherwise it was overwritten while it was copied
            due = Instant(max(due + period_ns, now))
            yield ImageFrame(camera.name, glance.sequence, glance.measured, copy), now
