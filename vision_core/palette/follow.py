"""A palette kept right while the light changes.

Every look judges the palette in force on the newest picture. Where robots are no longer read as before, the palette is
learned anew from those that are; when that does not help for a while, it is found from nothing. A change is made only
when the picture is explained clearly better by it, so a hand over the field or an empty field changes nothing.
"""

from dataclasses import dataclass

from vision_core.color.samples import measured_from
from vision_core.geometry import Bytes
from vision_core.palette.find import Palette, find_palette, judged_with, refined
from vision_core.palette.trial import Picture, Trial
from vision_core.settings.schema import Settings

BETTER = 0.4
"""A palette must score so much more than the one in force: about a fifth of a robot that is read."""
FORGET = 0.02
"""How much of what is usual is forgotten with every look."""
LOST_SHARE, LOST_LOOKS = 0.7, 2
"""With less than this share of the usual score, so many times in a row, the palette is found from nothing."""


@dataclass(frozen=True, slots=True)
class Look:
    """What one look at a picture led to."""

    palette: Palette
    """In force from now on."""
    what: str
    """"kept", "learned" or "found"."""


class Follower:
    """Follows the light of one camera."""

    def __init__(self, settings: Settings) -> None:
        self.trial = Trial(settings, settings.colors.light)
        self._start = measured_from(settings.colors.samples)
        self._sampling = settings.colors.sampling
        self._palette: Palette | None = None
        self._usual, self._lost = 0.0, 0

    def reset(self) -> None:
        """Go back to the palette of the settings."""
        self._palette, self._usual, self._lost = None, 0.0, 0

    def look(self, pixels: Bytes) -> Look:
        """Look at a picture, shape (height, width, 3)."""
        picture = self.trial.prepared(pixels)
        now = self._judged(picture)
        self._usual = max(now.score, self._usual * (1.0 - FORGET))
        best, what = now, "kept"
        if now.score < self._usual or self._palette is None:
            learned = refined(self.trial, [picture], now)
            if learned.score > now.score + BETTER:
                best, what = learned, "learned"
        self._lost = self._lost + 1 if best.score < LOST_SHARE * self._usual else 0
        if self._lost >= LOST_LOOKS:
            self._lost = 0
            found = find_palette(self.trial, [picture])
            if found.score > best.score + BETTER:
                best, what = found, "found"
        self._palette = best
        return Look(best, what)

    def _judged(self, picture: Picture) -> Palette:
        """The palette in force, judged on a picture."""
        if self._palette is not None:
            return judged_with(self.trial, [picture], self._palette.measured, self._palette.sampling)
        return judged_with(self.trial, [picture], self._start, self._sampling)
