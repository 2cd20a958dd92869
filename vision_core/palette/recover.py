"""A palette that was right, found again in another light.

What lamps and camera do to every paint alike is known: they shift log B/G and log R/G (von Kries), and haze, black
level or another curve makes all colors paler or purer. So the palette of the set-up is tried with shifts and scales,
the small ones first, until as many robots are read as there were. This is quicker than to find one from nothing.
"""

import itertools
import math

import numpy as np

from vision_core.palette.find import Progress, is_too_wide, no_progress, refined_on
from vision_core.palette.reading import Palette, cells_of, completed, judged_with
from vision_core.palette.starts import FIRST, palette_at, plain_colors
from vision_core.palette.trial import Picture, Trial

SHIFTS = (0.0, -0.2, 0.2, -0.45, 0.45)
SCALES = (1.0, 0.75, 1.35, 0.55)
TRIES = tuple(
    sorted(
        itertools.product(SCALES, SHIFTS, SHIFTS),
        key=lambda one: math.hypot(one[1], one[2]) + abs(math.log(one[0])),
    )
)
"""Scale, shift of log B/G, shift of log R/G: the smallest change first."""
REFINED = 3
"""So many of the best tries are learned on when none reads all robots at once."""


def recovered(
    trial: Trial, picture: Picture, start: Palette, robots: int, progress: Progress = no_progress
) -> Palette | None:
    """The palette of the set-up in the light of a picture; None when no try reads a robot.

    start: of the set-up; robots: how many there are to be read. Raises SettingsError for a pattern that cannot be read.
    """
    plain, cells = plain_colors([picture]), cells_of([picture])
    means = start.table.references.means[1:]
    tried: list[Palette] = []
    best: Palette | None = None
    for number, (scale, *shift) in enumerate(TRIES):
        progress(number / len(TRIES), "trying the palette of the set-up in other lights")
        measured = palette_at(trial, scale * means + np.array(shift), plain)
        if is_too_wide(measured, FIRST, picture):
            continue
        guess = judged_with(trial, [picture], measured, FIRST, cells)
        if guess.read < robots:
            tried.append(guess)
            continue
        best = _better(best, refined_on(trial, [picture], guess, cells, ball_as_read=True))
        if best.read >= robots:
            return completed(best)
    for guess in sorted(tried, key=lambda one: -one.score)[:REFINED]:
        if guess.read:
            best = _better(best, refined_on(trial, [picture], guess, cells, ball_as_read=True))
    return best and completed(best)


def _better(one: Palette | None, other: Palette) -> Palette:
    return other if one is None or (other.read, other.score) > (one.read, one.score) else one
