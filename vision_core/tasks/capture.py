"""Process: light -> images. Fills the ring of frames from a source and releases perception.

A source that fails is reopened once a second, and until it delivers again nothing is published: no
stale image is ever passed on as fresh.
"""

import time

import numpy as np

from vision_core.capture.source import Source, open_source
from vision_core.clock import MonotonicClock
from vision_core.errors import SourceError
from vision_core.rtdb import records
from vision_core.rtdb.attachment import Attachment, attach
from vision_core.rtdb.records import SourceInfo
from vision_core.settings import Settings
from vision_core.tasks.gauge import Gauge

REOPEN_EVERY_S = 1.0


def main() -> None:
    """Run until the supervisor says stop."""
    attachment = attach()
    clock = MonotonicClock()
    gauge = Gauge(attachment, clock.now())
    settings = records.SERVICE.reader(attachment.store).value(clock.now()).settings
    while not attachment.stopping:
        try:
            source = open_source(settings, clock)
            try:
                _publish_source(attachment, settings, source)
                _run(attachment, settings, source, gauge)
            finally:
                source.close()
        except SourceError as error:
            gauge.note = str(error)
            gauge.publish(clock.now())
            time.sleep(REOPEN_EVERY_S)


def _run(attachment: Attachment, settings: Settings, source: Source, gauge: Gauge) -> None:
    """Grab frames into the ring until told to stop. Raises SourceError when the source is gone."""
    clock = MonotonicClock()
    camera = settings.camera
    spec = records.frames(camera.name, camera.width_px, camera.height_px)
    writer = attachment.store.writer(spec.name)
    shape = (camera.height_px, camera.width_px, 3)
    while not attachment.stopping:
        pixels = np.frombuffer(writer.begin(), dtype=np.uint8).reshape(shape)
        grabbed = source.grab(pixels)
        writer.commit(spec.capacity, grabbed, clock.now())
        attachment.notify(spec.name)
        gauge.note = ""
        now = clock.now()
        gauge.ran(grabbed, now)
        gauge.publish_if_due(now)


def _publish_source(attachment: Attachment, settings: Settings, source: Source) -> None:
    info = SourceInfo(
        uri=settings.source.uri,
        description=source.description,
        repeats=source.repeats,
        width_px=source.width_px,
        height_px=source.height_px,
        rate_hz=source.rate_hz,
    )
    now = MonotonicClock().now()
    records.source(settings.camera.name).writer(attachment.store).write(info, now, now)


if __name__ == "__main__":
    main()
