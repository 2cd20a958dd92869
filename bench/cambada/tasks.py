"""Each detector as a task of the service. The name of the task selects the detector; all share this module.

Each run copies the newest image, runs the detector and writes ``cambada/<name>``. When the process ends, it saves its
activation log.
"""

import atexit
from dataclasses import dataclass

import msgspec

from bench.cambada.activation_log import ActivationLog
from bench.cambada.detectors import Positions, detector_of
from bench.cambada.venue import log_folder_of
from vision_core.scheduling.handle import Handle, Step
from vision_core.scheduling.latest_image import Images
from vision_core.scheduling.releases import RAN, Release, StepResult


@dataclass(frozen=True, slots=True)
class Detection:
    """What a task writes, as msgpack."""

    image: int
    """Number of the image."""
    positions: Positions | None
    """None: the object was not found."""


def start(handle: Handle) -> Step:
    """Make the detector. Raises KeyError for a task that is not the paper's."""
    detector = detector_of(handle.task.name, handle.settings)
    images = Images(handle)
    (record,) = handle.task.writes
    writer = handle.raw_writer(record)
    encoder = msgspec.msgpack.Encoder()
    log = ActivationLog()
    atexit.register(log.save, log_folder_of(handle.settings.source.uri), handle.task.name)

    def step(release: Release) -> StepResult:
        began = handle.clock.now()
        image = images.newest()
        if image is None:
            return images.none_result
        positions = detector.detect(image.pixels, image.grabbed)
        done = handle.clock.now()
        writer.write(encoder.encode(Detection(image.number, positions)), image.grabbed, done)
        log.add(release.due, began, done, image.number, found=positions is not None)
        return RAN

    return step
