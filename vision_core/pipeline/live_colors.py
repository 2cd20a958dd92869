"""The colors that the service has in force just now: those of the settings, or what they became in another light."""

from dataclasses import replace

import numpy as np

from vision_core.clock import Instant
from vision_core.pipeline.perception import Perception
from vision_core.rtdb.items import ItemReader
from vision_core.types.colors import References
from vision_core.types.palette import LivePalette


class LiveColors:
    """Keeps a perception at the colors in force."""

    def __init__(self, perception: Perception, palettes: ItemReader[LivePalette]) -> None:
        self._perception, self._palettes = perception, palettes
        self._own = perception.table
        self._used = 0
        perception.lighting.hold(perception.lighting.light)

    def refresh(self, now: Instant) -> None:
        """See the next image with the colors in force."""
        if self._palettes.sequence == self._used:
            return
        self._used = self._palettes.sequence
        if (palette := self._palettes.read(now)) is not None:
            self._use(palette.value)

    def _use(self, palette: LivePalette) -> None:
        self._perception.lighting.hold(palette.light)
        if not palette.classes:
            self._perception.recolor(self._own)
            return
        means, spreads = np.array(palette.means).reshape(-1, 2), np.array(palette.spreads).reshape(-1, 3)
        classes = np.frombuffer(palette.classes, dtype=np.uint8)
        self._perception.recolor(replace(self._own, classes=classes, references=References(means, spreads)))
