"""Task: what a camera would see -> images. Plays the camera when there is none: simulates it, or reads files.

This is not the service's work, so it has no real-time priority: it makes the image that capture ordered, in the slot of
the ring that the order names, and says when it is done. A source that fails is opened again once a second.
"""

import numpy as np

from vision_core.capture.source import Played, open_played
from vision_core.clock import NS_PER_S, Instant
from vision_core.errors import SourceError
from vision_core.rtdb import records
from vision_core.rtdb.infos import FrameDone
from vision_core.scheduling.handle import Handle, Step
from vision_core.tasks.capture import REOPEN_EVERY_S, info_of
from vision_core.timing.rate_keeper import OrderedKeeper


def start(handle: Handle) -> Step:
    """Open the file, or build the world."""
    player = _Player(handle)
    player.fill()
    handle.every_turn(player.reopen)
    return lambda _release: player.fill()


class _Player:
    """Fills orders."""

    def __init__(self, handle: Handle) -> None:
        camera = handle.camera
        self._handle = handle
        self._shape = camera.shape
        self._frames = handle.raw_reader(f"frames/{camera.name}")
        self._orders = handle.reader(records.frame_requests(camera.name))
        self._exposures = handle.writer(records.frames_done(camera.name))
        self._about = handle.writer(records.source(camera.name))
        self._source: Played | None = None
        self._keeper = OrderedKeeper(camera.rate_hz)
        self._opened = Instant(0)
        self._filled = 0
        """Orders, by the record's sequence."""
        done = handle.reader(records.frames_done(camera.name)).read(handle.clock.now())
        order = self._orders.read(handle.clock.now())
        if done and order and done.value.number == order.value.number:
            self._filled = order.sequence  # by a predecessor, who perhaps could not say so any more
            handle.notify(records.frames_done(camera.name).spec.name)

    def reopen(self) -> None:
        """Try again to open a source that could not be read."""
        if self._source is None:
            self.fill()

    def fill(self) -> bool:
        """Fill the newest order, if that is not done; was there anything to do?"""
        try:
            source = self._source or self._open()
            timed = self._orders.read(self._handle.clock.now())
            if source is None or timed is None or timed.sequence == self._filled:
                return False
            order = timed.value
            self._keeper.order(order.instant)
            source.grab(np.frombuffer(self._frames.payload(order.slot), dtype=np.uint8).reshape(self._shape))
        except SourceError as error:
            self._source, self._handle.note = None, str(error)
            return False
        self._filled, now = timed.sequence, self._handle.clock.now()
        self._exposures.write(FrameDone(order.number), now, now)
        self._handle.notify(records.frames_done(self._handle.camera.name).spec.name)
        self._handle.note = ""
        return True

    def _open(self) -> Played | None:
        """Try once a second."""
        now = self._handle.clock.now()
        if now - self._opened < REOPEN_EVERY_S * NS_PER_S:
            return None
        self._opened = now
        source = open_played(self._handle.settings, self._handle.camera, self._handle.clock, paced=False)
        source.prepare()
        source.keeper = self._keeper = OrderedKeeper(source.rate_hz)
        self._about.write(info_of(source, self._handle.settings.source.uri), now, now)
        self._handle.notify(records.source(self._handle.camera.name).spec.name)
        self._source = source
        return source
