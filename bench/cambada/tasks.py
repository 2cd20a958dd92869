"""Tasks: images -> where a thing is. One module for all: the task's name says which detector it is.

Each run copies the newest image into memory of its own, looks at it, and writes ``cambada/<name>``. When the process
ends it saves its log.
"""

import atexit
from dataclasses import dataclass

import msgspec

from bench.cambada.activation_log import ActivationLog
from bench.cambada.detectors import Places, detector_of
from bench.cambada.venue import log_folder
from vision_core.scheduling.handle import Handle, Step
from vision_core.scheduling.latest_image import Images
from vision_core.scheduling.releases import RAN, Release, StepResult


@dataclass(frozen=True, slots=True)
class Finding:
    """What a task writes, as msgpack."""

    image: int
    """Number of the image that it looked at."""
    places: Places | None
    """None: the thing was not there."""


def start(handle: Handle) -> Step:
    """Make the detector. Raises KeyError for a task that the paper lacks."""
    detector = detector_of(handle.task.name, handle.settings)
    images = Images(handle)
    (record,) = handle.task.writes
    findings = handle.raw_writer(record)
    encoder = msgspec.msgpack.Encoder()
    log = ActivationLog()
    atexit.register(log.save, log_folder(handle.settings.source.uri), handle.task.name)

    def step(release: Release) -> StepResult:
        began = handle.clock.now()
        image = images.newest()
        if image is None:
            return images.none_result
        places = detector.look(image.pixels, image.grabbed)
        done = handle.clock.now()
        findings.write(encoder.encode(Finding(image.number, places)), image.grabbed, done)
        log.note(release.due, began, done, image.number, found=places is not None)
        return RAN

    return step
