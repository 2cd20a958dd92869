"""A palette from pictures alone: nobody has named a color.

Many first guesses (``starts``) are judged by the hot path itself (``trial``); from the best ones on, what is read
teaches what the paints and the floor look like, and with these colors the pictures are read again, until nothing gets
better. The palette under which the pictures are explained best wins.
"""

from collections.abc import Callable, Sequence
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from vision_core.color.samples import Measured, claims_by_samples, places_of
from vision_core.geometry import Bytes
from vision_core.palette.learn import LEARNED, learn
from vision_core.palette.light import light_from
from vision_core.palette.reading import Palette, cells_of, completed, judged_again, judged_with, read_with
from vision_core.palette.result import ColorsFound, result_of
from vision_core.palette.starts import FIRST, starts_for
from vision_core.palette.trial import Picture, Trial
from vision_core.settings.schema import SamplingSettings, Settings

Progress: TypeAlias = Callable[[float, str], None]
"""Called with the share that is done, 0..1, and what is done next. It may raise an exception to cancel."""


def no_progress(_share: float, _what: str) -> None:
    """Show no progress."""


MAX_COVERED = 0.15
"""A palette under which more of the field is colored is not tried: it takes long, and it cannot be right."""
FIRST_PICTURES = 3
"""The first guesses are judged by so many pictures."""
REFINED = 6
"""So many of the first guesses of each kind are refined."""
ROUNDS = 5
GUESS_SHARE = 0.7
"""Learned colors are preferred to guessed ones that score a little more."""


def find_colors(pictures: Sequence[Bytes], settings: Settings, progress: Progress = no_progress) -> ColorsFound:
    """The colors of a venue's paints, from pictures that show robots in about the same light.

    pictures: at least one, shape (height, width, 3), of the camera's size; settings: with the camera, the field, the
    patterns and the ball; their colors are not used. Raises SettingsError for a pattern that cannot be read.
    """
    trial = Trial(settings, light_from(pictures[0], settings))
    prepared = [trial.prepared(pixels) for pixels in pictures]
    return result_of(trial, read_with(trial, prepared, find_palette(trial, prepared, progress)))


def find_palette(trial: Trial, pictures: Sequence[Picture], progress: Progress = no_progress) -> Palette:
    """The palette that explains pictures best."""
    progress(0.0, "searching for shapes of markers")
    first = pictures[:FIRST_PICTURES]
    starts, cells = starts_for(trial, first), cells_of(pictures)
    tried: dict[str, list[Palette]] = {}
    progress(0.3, f"trying {len(starts)} first guesses")
    for kind, measured in starts:
        if not is_too_wide(measured, FIRST, first[0]):
            tried.setdefault(kind, []).append(judged_with(trial, first, measured, FIRST, cells))
    chosen = [one for kind in tried.values() for one in sorted(kind, key=lambda one: -one.score)[:REFINED]]
    best: Palette | None = None
    for number, start in enumerate(chosen):
        progress(0.5 + 0.5 * number / len(chosen), f"learning from what is read, guess {number + 1} of {len(chosen)}")
        found = refined_on(trial, pictures, judged_again(trial, pictures, start), cells)
        if best is None or found.score > best.score:
            best = found
    return completed(best or judged_with(trial, pictures, starts[0][1], FIRST, cells))


def refined(trial: Trial, pictures: Sequence[Picture], start: Palette, *, ball_as_read: bool = False) -> Palette:
    """Learn from what is read, read again, and so on; the best of all.

    start: judged on these pictures; ball_as_read: as of ``learn``.
    """
    best = refined_on(trial, pictures, start, cells_of(pictures), ball_as_read=ball_as_read)
    return best if best is start else completed(best)


def refined_on(
    trial: Trial,
    pictures: Sequence[Picture],
    start: Palette,
    cells: NDArray[np.int64],
    *,
    ball_as_read: bool = False,
) -> Palette:
    """The same; cells: of ``cells_of`` these pictures, to which the table is limited."""
    best = last = start
    for _ in range(ROUNDS):
        measured, counts = learn(trial, pictures, last.judged, ball_as_read=ball_as_read)
        if is_too_wide(measured, LEARNED, pictures[0]):
            break
        last = judged_with(trial, pictures, measured, LEARNED, cells, counts)
        if last.score > (best.score if best.learned else GUESS_SHARE * best.score):
            best = last
        elif best.learned:
            break
    return best


def is_too_wide(measured: Measured, sampling: SamplingSettings, picture: Picture) -> bool:
    """Has more than MAX_COVERED of a picture's field a class?"""
    claims = claims_by_samples(places_of(picture.floor_bgr[::5]), measured, sampling)
    return sum(float(claim.mean()) for claim in claims.values()) > MAX_COVERED
