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
from vision_core.rtdb.slots import SlotWriter
from vision_core.settings import Settings
from vision_core.tasks.gauge import Gauge

REOPEN_EVERY_S = 1.0


def main() -> None:
    """Run until the supervisor says stop."""
    attachment = attach()
    clock = MonotonicClock()
    gauge = Gauge(attachment, clock.now())
    settings = records.SERVICE.reader(attachment.store).value(clock.now()).settings
    frames = attachment.store.writer(f"frames/{settings.camera.name}")
    about = records.source(settings.camera.name).writer(attachment.store)
    while not attachment.stopping:
        try:
            source = open_source(settings, clock)
            try:
                about.write(_info_of(source, settings), clock.now(), clock.now())
                _run(attachment, settings, source, frames, gauge)
            finally:
                source.close()
        except SourceError as error:
            gauge.note = str(error)
            gauge.publish(clock.now())
            time.sleep(REOPEN_EVERY_S)


def _run(attachment: Attachment, settings: Settings, source: Source, frames: SlotWriter, gauge: Gauge) -> None:
    """Grab frames into the ring until told to stop. Raises SourceError when the source is gone."""
    clock = MonotonicClock()
    shape = (settings.camera.height_px, settings.camera.width_px, 3)
    skipped = 0
    while not attachment.stopping:
        pixels = np.frombuffer(frames.begin(), dtype=np.uint8).reshape(shape)
        grabbed = source.grab(pixels)
        frames.commit(pixels.size, grabbed, clock.now())
        attachment.notify(frames.spec.name)
        gauge.note = ""
        now = clock.now()
        gauge.ran(grabbed, now, source.skipped - skipped)
        skipped = source.skipped
        gauge.publish_if_due(now)


def _info_of(source: Source, settings: Settings) -> SourceInfo:
    return SourceInfo(
        uri=settings.source.uri,
        description=source.description,
        repeats=source.repeats,
        rate_hz=source.rate_hz,
    )


if __name__ == "__main__":
    main()
