"""Overlays of the camera's picture: tells the task ``overlay`` that somebody looks, and reads what it has drawn."""

from collections.abc import Collection

from vision_core.clock import Instant, MonotonicClock, after, seconds_between
from vision_core.rtdb import records
from vision_core.rtdb.store import Store
from vision_core.types.overlay import Layer, Looking, Overlay

PREFIX = "overlay/"
LAYER_OF = {f"{PREFIX}{layer}": layer for layer in Layer}
"""The layer of each topic."""
LOOKS_S = 2.0
"""The task draws for so long after it was last told that somebody looks."""
RENEW_S = 0.5


class Overlays:
    """The record ``looking``, of which the web process is the only writer, and the record ``overlay``."""

    def __init__(self, store: Store, camera: str) -> None:
        """camera: its name."""
        self._clock = MonotonicClock()
        self._looking = records.LOOKING.writer(store)
        self._overlays = records.overlay(camera).reader(store)
        self._told: tuple[Layer, ...] = ()
        self._told_at = Instant(0)
        self._newest: tuple[int, Overlay] | None = None
        """Number and value of the overlay that was read last: each layer is a topic of its own."""

    def look(self, topics: Collection[str], now: Instant) -> None:
        """Tell which layers are looked at, if somebody looks."""
        layers = tuple(layer for topic, layer in LAYER_OF.items() if topic in topics)
        is_due = layers != self._told or seconds_between(self._told_at, now) >= RENEW_S
        if layers and is_due:
            self._looking.write(Looking(after(now, LOOKS_S), layers), now, now)
            self._told_at = now
        self._told = layers

    @property
    def number(self) -> int:
        """How often an overlay was drawn."""
        return self._overlays.sequence

    def newest(self) -> Overlay | None:
        """The newest overlay; None before the first, and when nobody has looked lately."""
        timed = self._overlays.read(self._clock.now()) if self._is_newer() else None
        if timed is not None:
            self._newest = (timed.sequence, timed.value) if timed.valid else None
        return self._newest[1] if self._newest else None

    def _is_newer(self) -> bool:
        return self._newest is None or self._newest[0] != self.number
