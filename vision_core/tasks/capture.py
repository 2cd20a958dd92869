"""Task: publishes the images of the camera in the ring of frames, which releases perception.

A device delivers by itself, into the slot that it is given. When the source is a file or the simulated camera, the task
``source`` makes the images, without real-time priority, as a camera's chip would. This task then requests one image
after the other, each for an instant of the camera's grid, and publishes it at that instant. A late image is published
at once, under the instant of its request; instants that passed meanwhile are skipped and counted.

A device that fails is opened again once a second. Until it delivers nothing is published, so that no old image is taken
for a new one.
"""

import math

import numpy as np

from vision_core.capture.source import ImageSource, open_source
from vision_core.clock import Instant, seconds_between
from vision_core.errors import SourceError
from vision_core.rtdb import records
from vision_core.rtdb.infos import FrameRequest, SourceInfo
from vision_core.scheduling.handle import Handle, Step
from vision_core.scheduling.releases import IDLE, Release, StepResult
from vision_core.timing.rate_keeper import RateKeeper

REOPEN_EVERY_S = 1.0
PATIENCE_S = 1.0
"""An image that takes longer is reported as late; the task goes on waiting for it."""


def start(handle: Handle) -> Step:
    """Prepare for a device, which is opened with the first image, or for images on request."""
    return _on_request(handle) if handle.settings.source.device is None else _from_device(handle)


def _from_device(handle: Handle) -> Step:
    camera = handle.camera
    frames = handle.raw_writer(f"frames/{camera.name}")
    info = handle.writer(records.source(camera.name))
    shape = camera.shape
    source: ImageSource | None = None

    def opened() -> ImageSource:
        fresh = open_source(handle.settings, camera, handle.clock)
        now = handle.clock.now()
        handle.attachment.heartbeat(now)
        info.write(info_of(fresh, handle.settings.source.uri), now, now)
        return fresh

    def step(_release: Release) -> StepResult:
        nonlocal source
        try:
            source = source or opened()
            pixels = np.frombuffer(frames.begin(), dtype=np.uint8).reshape(shape)
            grabbed = source.grab(pixels)
        except SourceError as error:
            if source is not None:
                source.close()
            source, handle.note = None, str(error)
            handle.sleep(REOPEN_EVERY_S)
            return IDLE
        began = handle.clock.now()
        frames.commit(pixels.size, grabbed, began)
        handle.note = ""
        return StepResult(due=grabbed, began=began)

    return step


def _on_request(handle: Handle) -> Step:
    publisher = _Publisher(handle)
    handle.when_switched(publisher.restart)
    return publisher.step


class _Publisher:
    """Requests images on a grid in time, and publishes each at its instant."""

    def __init__(self, handle: Handle) -> None:
        camera = handle.camera
        self._handle = handle
        self._size = math.prod(camera.shape)
        self._frames = handle.raw_writer(f"frames/{camera.name}")
        self._requests = handle.writer(records.frame_requests(camera.name))
        self._done = handle.reader(records.frames_done(camera.name))
        self._info = handle.reader(records.source(camera.name))
        self._number = self._requests.sequence
        self._keeper: RateKeeper | None = None
        self._request: FrameRequest | None = None
        self._skipped = 0

    def restart(self) -> None:
        """Begin a new grid with the next image."""
        self._keeper = self._request = None

    def step(self, _release: Release) -> StepResult:
        """Publish the next image; idle when it has not come, or before the source has said what it is."""
        request = self._request = self._request or self._next_request()
        if request is None:
            self._handle.wait(PATIENCE_S)
            return IDLE
        self._handle.sleep(seconds_between(self._handle.clock.now(), request.instant))
        filled = self._wait_for(request)
        if filled is None or self._handle.stopping:
            return IDLE
        assert self._keeper is not None
        began = self._handle.clock.now()
        missed, self._skipped = self._keeper.skipped - self._skipped, self._keeper.skipped
        self._frames.commit(self._size, request.instant, began)
        self._request, self._handle.note = None, ""
        return StepResult(missed=missed, due=max(request.instant, filled), began=began)

    def _next_request(self) -> FrameRequest | None:
        """Request the image of the next instant; None before the source has said at which rate it delivers."""
        info = self._info.read(self._handle.clock.now())
        if info is None:
            return None
        if self._keeper is None or self._keeper.rate_hz != info.value.rate_hz:
            self._keeper, self._skipped = RateKeeper(info.value.rate_hz, self._handle.clock), 0
        self._number += 1
        self._frames.begin()
        request = FrameRequest(self._number, self._frames.next_slot, self._keeper.choose())
        now = self._handle.clock.now()
        self._requests.write(request, now, now)
        self._handle.notify(self._requests.name)
        return request

    def _wait_for(self, request: FrameRequest) -> Instant | None:
        """When the image of a request was done; None when it is not done within PATIENCE_S."""
        while (done := self._done.read(self._handle.clock.now())) is None or done.value.number != request.number:
            if not self._handle.wait(PATIENCE_S):
                late_s = seconds_between(request.instant, self._handle.clock.now())
                self._handle.note = f"the next image of the source is {late_s:.1f} s late"
                return None
        return done.written


def info_of(source: ImageSource, uri: str) -> SourceInfo:
    """The record of a source."""
    return SourceInfo(uri, source.description, source.repeats, source.rate_hz)
