"""Task: light -> images. Fills the ring of frames and releases perception.

A device delivers by itself, into the slot that it is given. Files and the simulated camera are no devices: their images
are made by the task ``source``, which has no real-time priority, as a camera's chip would make them; this task orders
one after the other into the ring's next slot and publishes each at its instant. An image that comes late is
published at once, under the instant that it was ordered for; a period that has passed meanwhile is left out, and
counted.

A device that fails is opened again once a second, and until it delivers nothing is published: no stale image is
passed on as fresh.
"""

import numpy as np

from vision_core.capture.source import Source, is_device, open_source
from vision_core.clock import seconds_between
from vision_core.errors import SourceError
from vision_core.pace import RateKeeper
from vision_core.rtdb import records
from vision_core.rtdb.infos import Order, SourceInfo
from vision_core.scheduling.handle import Handle, Step
from vision_core.scheduling.releases import Release

REOPEN_EVERY_S = 1.0
PATIENCE_S = 1.0
"""An ordered image that has not come by then is missing; it is waited for all the same."""


def start(handle: Handle) -> Step:
    """Open the device, if there is one."""
    return _from_device(handle) if is_device(handle.settings) else _from_orders(handle)


def _from_device(handle: Handle) -> Step:
    camera = handle.settings.camera
    frames = handle.slots_to_fill(f"frames/{camera.name}")
    about = handle.writer(records.source(camera.name))
    shape = (camera.height_px, camera.width_px, 3)
    source: Source | None = None

    def opened() -> Source:
        fresh = open_source(handle.settings, handle.clock)
        now = handle.clock.now()
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
    camera = handle.settings.camera
    frames = handle.slots_to_fill(f"frames/{camera.name}")
    orders = handle.writer(records.orders(camera.name))
    exposures = handle.reader(records.exposures(camera.name))
    about = handle.reader(records.source(camera.name))
    size = camera.height_px * camera.width_px * 3
    keeper: RateKeeper | None = None
    order: Order | None = None
    number = orders.sequence
    skipped = 0

    def ordered(keeper: RateKeeper) -> Order:
        """Ask for the image of the next instant."""
        nonlocal number
        number += 1
        frames.begin()
        fresh = Order(number, frames.next_slot, keeper.choose())
        now = handle.clock.now()
        orders.write(fresh, now, now)
        handle.notify(records.orders(camera.name).spec.name)
        return fresh

    def step(release: Release) -> bool:
        nonlocal keeper, order, skipped
        if order is None:
            told = about.read(handle.clock.now())
            if told is None:
                handle.wait(PATIENCE_S)
                return False
            if keeper is None or keeper.rate_hz != told.value.rate_hz:
                keeper, skipped = RateKeeper(told.value.rate_hz, handle.clock, handle.sleep), 0
            order = ordered(keeper)
        assert keeper is not None
        keeper.sleep()
        while (filled := exposures.read(handle.clock.now())) is None or filled.value.number != order.number:
            if not handle.wait(PATIENCE_S):
                late_s = seconds_between(order.instant, handle.clock.now())
                handle.note = f"no image of the source: it is {late_s:.1f} s late"
                return False
        release.due, release.began = max(order.instant, filled.written), handle.clock.now()
        release.missed, skipped = keeper.skipped - skipped, keeper.skipped
        frames.commit(size, order.instant, release.began)
        order, handle.note = None, ""
        return True

    return step


def info_of(source: Source, uri: str) -> SourceInfo:
    """What a source is, as others read it."""
    return SourceInfo(uri, source.description, source.repeats, source.rate_hz)
