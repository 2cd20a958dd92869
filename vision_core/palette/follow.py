"""Colors kept right while the light changes.

First the light: its gains are measured on the field, often, since that is cheap, and taken out of the pictures once
they have settled (``color.settling``). What is left of the change the palette follows: every look judges the palette in
force on the newest picture. Where fewer robots are read than usual, the palette is learned anew from those that still
are; when that does not bring back all, that of the set-up is tried in other lights (``recover``); at last one is found
from nothing. A change is made only when more robots are read with it and the picture is explained clearly better. What
counts there is the shape of the markers, which no color can feign: so a hand over the field or an empty field changes
nothing. The palette of the settings comes back as soon as it explains the picture as well.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from vision_core.color.settling import SettlingLight
from vision_core.geometry import Bytes
from vision_core.palette.find import Progress, find_palette, no_progress, refined
from vision_core.palette.reading import Palette, judged_again, palette_of_settings
from vision_core.palette.recover import recovered
from vision_core.palette.trial import Picture, Trial
from vision_core.settings.schema import Settings
from vision_core.types.colors import ColorTable, Light

FORGET = 0.01
"""How many robots fewer are usual after every look: they leave the field."""
PATIENCE = 2
"""Looks to wait after an attempt that did not help; twice as many after the next one, up to MAX_PATIENCE. A robot less
than in the last look is a reason not to wait."""
MAX_PATIENCE = 64
JUDGE_EVERY = 10
"""The palette is judged once in so many pictures whose light is measured, and when another light has settled."""
WAIT_FOR_LIGHT = 40
"""While the light does not settle the palette is judged once in so many."""


@dataclass(frozen=True, slots=True)
class Look:
    """What one look at a picture led to."""

    palette: Palette
    """In force from now on."""
    what: str
    """"kept"; "learned" from what is read; "found" from nothing; or "start": back to that of the settings."""


class Follower:
    """Follows the light of one camera. Raises SettingsError for a pattern that cannot be read."""

    def __init__(self, settings: Settings, table: ColorTable, progress: Progress = no_progress) -> None:
        """table: of the settings' colors; progress: is called while a palette is found."""
        self.trial = Trial(settings, settings.colors.light)
        self._max_shift = settings.colors.light.max_shift
        self._settling = SettlingLight(settings, self.trial.camera)
        self._start = palette_of_settings(self.trial, table)
        self._progress = progress
        self.reset()

    def warm_up(self) -> None:
        """Load or compile the kernels."""
        dark = self.trial.camera.black_image()
        picture = self.trial.prepared(dark)
        self.trial.shapes(picture, self.trial.kinds[0])
        self.watch(dark)
        self.look(dark)
        self.reset()

    def reset(self) -> None:
        """Go back to the light and the palette of the settings."""
        self._settling.reset()
        self._watched = JUDGE_EVERY
        self.is_due = True
        """Is it time for a look?"""
        self._palette: Palette | None = None
        self._usual, self._last, self._wait, self._patience = 0.0, 0, 0, PATIENCE

    @property
    def light(self) -> Light:
        """In force."""
        return self._settling.light

    def watch(self, pixels: Bytes) -> bool:
        """Measure the light of the newest picture, shape (height, width, 3); True when another one is in force now."""
        before = self.light
        is_settled = self._settling.look(pixels)
        self._watched += 1
        has_moved = self.light.gain_bgr != before.gain_bgr
        if has_moved and self._reads_fewer(pixels, before):
            self._settling.refuse()
        self.is_due = has_moved or self._watched >= (JUDGE_EVERY if is_settled else WAIT_FOR_LIGHT)
        return self.light != before

    def look(self, pixels: Bytes) -> Look:
        """Judge the palette on a picture in the light in force, shape (height, width, 3), and change it if need be."""
        self._watched, self.is_due = 0, False
        picture = self.trial.prepared(pixels, self.light)
        start = judged_again(self.trial, [picture], self._start)
        now = start if self._palette is None else judged_again(self.trial, [picture], self._palette)
        self._usual = max(float(now.read), self._usual - FORGET)
        self._wait = max(self._wait - 1, 0)
        if now.read < self._last:
            self._wait, self._patience = 0, PATIENCE
            self._settling.reconsider()
        self._last = now.read
        if self._palette is not None and (start.read, start.score) >= (max(now.read, self.expected), now.score):
            self._palette = None
            return Look(start, "start")
        if now.read >= self.expected and self._palette is not None:
            self._patience = PATIENCE
            return Look(now, "kept")
        if self._wait:
            return Look(now, "kept")
        return self._improved(picture, now)

    def _reads_fewer(self, pixels: Bytes, before: Light) -> bool:
        """Are fewer robots read in the light in force than in the one before?

        What changed is no gain then: another curve of the camera or its black level, for example.
        """
        palettes = [self._start] if self._palette is None else [self._palette, self._start]
        old, new = (
            max(judged_again(self.trial, [self.trial.prepared(pixels, light)], palette).read for palette in palettes)
            for light in (before, self.light)
        )
        return new < old

    @property
    def expected(self) -> int:
        """How many robots should be read: as many as usual."""
        return round(self._usual)

    def _improved(self, picture: Picture, now: Palette) -> Look:
        """A better palette, if there is one: the quickest way to one that reads all robots."""
        best, what = now, "kept"
        ways: tuple[tuple[str, Callable[[], Palette | None]], ...] = (
            ("learned", lambda: refined(self.trial, [picture], now, ball_as_read=True)),
            ("found", lambda: recovered(self.trial, picture, self._start, self.expected, self._progress)),
            ("found", lambda: find_palette(self.trial, [picture], self._progress)),
        )
        for name, way in ways:
            found = way()
            if found is not None and self._is_better(found, best):
                best, what = found, name
            if best.read >= self.expected:
                break
        if what == "kept":
            self._wait, self._patience = self._patience, min(2 * self._patience, MAX_PATIENCE)
            return Look(now, what)
        self._palette, self._last = best, best.read
        return Look(best, what)

    def _is_better(self, one: Palette, other: Palette) -> bool:
        """Does a palette explain the picture clearly better, with no paint that was seen too far from the set-up?"""
        moved = np.abs(one.table.references.means - self._start.table.references.means)[1:]
        is_near = bool((moved[one.counts > 0] <= self._max_shift).all())
        return is_near and one.is_better_than(other)
