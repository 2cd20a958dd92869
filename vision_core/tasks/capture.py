"""Task: light -> images. Fills the ring of frames and releases perception.

A device delivers by itself, into the slot that it is given. Files and the simulated camera are no devices: their images
are made by the task ``source``, which has no real-time priority, as a camera's chip would make them; this task orders
one after the other into the ring's next slot and publishes each at its instant. An image that comes late is
published at once, under the instant that it was ordered for; a period that has passed meanwhile is left out, and
counted.

A device that fails is opened again once a second, and until it delivers nothing is published: no stale image is
passed on as fresh.
"""

import math

import numpy as np

from vision_core.capture.source import Source, is_device, open_source
from vision_core.clock import Instant, seconds_between
from vision_core.errors import SourceError
from vision_core.rtdb import records
from vision_core.rtdb.infos import FrameRequest, SourceInfo
from vision_core.scheduling.handle import Handle, Step
from vision_core.scheduling.releases import Release
from vision_core.timing.rate_keeper import RateKeeper

REOPEN_EVERY_S = 1.0
PATIENCE_S = 1.0
"""An ordered image that has not come by then is missing; it is waited for all the same."""


def start(handle: Handle) -> Step:
    """Prepare for a device, which is opened with the first image, or for a source that is none."""
    return _from_device(handle) if is_device(handle.settings) else _from_orders(handle)


def _from_device(handle: Handle) -> Step:
    camera = handle.camera
    frames = handle.raw_writer(f"frames/{camera.name}")
    about = handle.writer(records.source(camera.name))
    shape = camera.shape
    source: Source | None = None

    def opened() -> Source:
        fresh = open_source(handle.settings, camera, handle.clock)
        now = handle.clock.now()
        handle.attachment.heartbeat(now)
        about.write(info_of(fresh, handle.settings.source.uri), now, now)
        return fresh

    def step(release: Release) -> bool:
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
            return False
        release.due, release.began = grabbed, handle.clock.now()
        frames.commit(pixels.size, grabbed, release.began)
        handle.note = ""
        return True

    return step


def _from_orders(handle: Handle) -> Step:
    shutter = _Shutter(handle)
    handle.when_switched(shutter.forget)
    return shutter.step


class _Shutter:
    """Orders images on a grid in time, and publishes each at its instant."""

    def __init__(self, handle: Handle) -> None:
        camera = handle.camera
        self._handle = handle
        self._size = math.prod(camera.shape)
        self._frames = handle.raw_writer(f"frames/{camera.name}")
        self._orders = handle.writer(records.frame_requests(camera.name))
        self._exposures = handle.reader(records.frames_done(camera.name))
        self._about = handle.reader(records.source(camera.name))
        self._number = self._orders.sequence
        self._keeper: RateKeeper | None = None
        self._order: FrameRequest | None = None
        self._skipped = 0

    def forget(self) -> None:
        """Begin a grid of our own anew, with an image of now."""
        self._keeper = self._order = None

    def step(self, release: Release) -> bool:
        """Publish the next image; False when it has not come, or nobody says what the source is."""
        order = self._order = self._order or self._ordered()
        if order is None:
            self._handle.wait(PATIENCE_S)
            return False
        self._handle.sleep(seconds_between(self._handle.clock.now(), order.instant))
        filled = self._waited_for(order)
        if filled is None or self._handle.stopping:
            return False
        release.due, release.began = max(order.instant, filled), self._handle.clock.now()
        assert self._keeper is not None
        release.missed, self._skipped = self._keeper.skipped - self._skipped, self._keeper.skipped
        self._frames.commit(self._size, order.instant, release.began)
        self._order, self._handle.note = None, ""
        return True

    def _ordered(self) -> FrameRequest | None:
        """Ask for the image of the next instant; None before the source has said at which rate it delivers."""
        told = self._about.read(self._handle.clock.now())
        if told is None:
            return None
        if self._keeper is None or self._keeper.rate_hz != told.value.rate_hz:
            self._keeper, self._skipped = RateKeeper(told.value.rate_hz, self._handle.clock), 0
        self._number += 1
        self._frames.begin()
        order = FrameRequest(self._number, self._frames.next_slot, self._keeper.choose())
        now = self._handle.clock.now()
        self._orders.write(order, now, now)
        self._handle.notify(records.frame_requests(self._handle.camera.name).spec.name)
        return order

    def _waited_for(self, order: FrameRequest) -> Instant | None:
        """When the image of an order was there; None when it has not come within PATIENCE_S."""
        while (filled := self._exposures.read(self._handle.clock.now())) is None or filled.value.number != order.number:
            if not self._handle.wait(PATIENCE_S):
                late_s = seconds_between(order.instant, self._handle.clock.now())
                self._handle.note = f"no image of the source: it is {late_s:.1f} s late"
                return None
        return filled.written


def info_of(source: Source, uri: str) -> SourceInfo:
    """What a source is, as others read it."""
    return SourceInfo(uri, source.description, source.repeats, source.rate_hz)
