"""From pictures, the field's measures and, if there is one, a first guess to a camera and a verdict."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from vision_core.calibration.align import look, searched, shifted
from vision_core.calibration.find import corners_m, find_field
from vision_core.calibration.judge import Measured, Scene, judged, picture_reasons
from vision_core.calibration.lens import Lens
from vision_core.calibration.painted import sections_for
from vision_core.calibration.profiles import FloatImage, luma_of
from vision_core.calibration.result import Calibration, Progress
from vision_core.calibration.ridges import find_ridges
from vision_core.calibration.solver import Fit, fit
from vision_core.calibration.start import Start, start_from_points, start_without_lines
from vision_core.errors import SettingsError
from vision_core.geometry import Bytes, Floats
from vision_core.settings.schema import FieldSettings
from vision_core.types.reasons import Reason

FINE_PX = (3.0, 2.5, 2.0)
"""How far beside their places edges are searched in the last rounds; in a picture over 800 px wide in proportion."""
NEAR_PX = 3.0
"""Of several first guesses the one counts after which most paint lies so near to its place."""
MAX_SIGMAS = 3.0
"""Sections that miss the lens by more do not count."""
RIVAL = 0.85
"""Another place of the field is a rival if it explains at least this share of the sections of the best one."""
APART = 0.01
"""Two places of the field differ when its corners are so far apart, as a share of its size."""


@dataclass(frozen=True, slots=True, eq=False)
class _Try:
    """A first guess that was moved onto the lines."""

    start: Start
    lens: Lens
    sections: int
    """Sections that show paint near their places."""


def no_progress(_what: str, _share: float) -> None:
    """For callers that show none."""


def calibrate(
    pictures: Sequence[Bytes],
    field: FieldSettings,
    start: Start | None,
    *,
    height_m: float | None = None,
    marker_height_m: float = 0.0,
    progress: Progress = no_progress,
) -> Calibration:
    """Calibrate one camera by the painted lines in one or more of its pictures.

    pictures: shape (height, width, 3) each, of one size; start: a camera that shows the lines at most a sixth of the
    picture beside their places; None: the field is searched, which must be wholly visible, and height_m is the camera's
    height by tape measure, if somebody measured it; marker_height_m: of the robots. What is refused says so in its
    reasons. Raises what progress raises.
    """
    size = pictures[0].shape[1], pictures[0].shape[0]
    progress("looking at the pictures", 0.0)
    first = start or start_without_lines(field, size, height_m=height_m)
    if reasons := picture_reasons(pictures, field):
        return judged(Scene(field, size, first.prior, marker_height_m), first.lens, None, reasons)
    lumas = [luma_of(picture) for picture in pictures]
    progress("searching the field", 0.1)
    starts = _near(start, pictures[0], field) if start else _found(pictures[0], field, size, height_m)
    tries: list[_Try] = []
    for number, guess in enumerate(starts):
        progress("moving it onto the lines", 0.3 + 0.4 * number / len(starts))
        tries += _tries(guess, field, lumas)
    tries.sort(key=lambda one: -one.sections)
    if not tries:
        return judged(Scene(field, size, first.prior, marker_height_m), first.lens, None, ())
    progress("fitting the camera", 0.7)
    scene = Scene(field, size, tries[0].start.prior, marker_height_m)
    measured = _refined(scene, tries[0].lens, lumas)
    progress("checking the result", 0.8)
    result = judged(scene, measured.lens, measured, ())
    if start is None:
        result = replace(result, reasons=result.reasons + _rival(scene, tries, measured, lumas))
    progress("done", 1.0)
    return result


def _near(start: Start, pixels: Bytes, field: FieldSettings) -> list[Start]:
    """A first guess, and the same after a coarse alignment."""
    moved = shifted(start.lens, sections_for(field, start.lens), find_ridges(pixels), start.prior)
    return [start, Start(moved, start.prior)]


def _found(pixels: Bytes, field: FieldSettings, size_px: tuple[int, int], height_m: float | None) -> list[Start]:
    """First guesses from a search of the whole picture."""
    starts = []
    for found in find_field(pixels, field):
        try:
            starts.append(start_from_points(found.corners_px, corners_m(field), size_px, height_m=height_m))
        except SettingsError:  # corners that no camera over the field sees so
            continue
    return starts


def _tries(start: Start, field: FieldSettings, lumas: Sequence[FloatImage]) -> Iterator[_Try]:
    """A first guess moved onto the lines: once by a near search, once by a wide one."""
    painted = sections_for(field, start.lens)
    for wide in (False, True):
        found = searched(start.lens, painted, lumas, start.prior, wide=wide)
        if found is not None:
            seen = look(sections_for(field, found.lens), found.lens, lumas, NEAR_PX)
            yield _Try(start, found.lens, len(seen.sections))


def _rival(scene: Scene, tries: Sequence[_Try], measured: Measured, lumas: Sequence[FloatImage]) -> tuple[Reason, ...]:
    """Is there another place of the field, not just turned by half a turn, that explains the picture as well?"""
    corners = corners_m(scene.field)
    best = measured.lens.project(corners)
    for other in tries[1:]:
        if other.sections < RIVAL * tries[0].sections:
            break
        if _apart(other.lens.project(corners), best) < APART:
            continue
        refined = _refined(scene, other.lens, lumas)
        if len(refined.sights) >= RIVAL * len(measured.sights) and _apart(refined.lens.project(corners), best) > APART:
            text = "the field may lie at two places in the picture: the lines that are seen do not tell which"
            return (Reason(text, "Name its corners."),)
    return ()


def _apart(quad: Floats, other: Floats) -> float:
    """Largest distance between two fields' corners, shape (4, 2), whichever end is left, as a share of their size."""
    apart = min(np.abs(quad - other).max(), np.abs(np.roll(quad, 2, axis=0) - other).max())
    return float(apart / np.ptp(other, axis=0).max())


def _refined(scene: Scene, lens: Lens, lumas: Sequence[FloatImage]) -> Measured:
    """Edges and lens in turn; sections that miss the lens by much more than the others are left out in the end."""
    scale = max(max(scene.size_px) / 800.0, 1.0)
    for reach_px in FINE_PX:
        painted = sections_for(scene.field, lens)
        seen = look(painted, lens, lumas, reach_px * scale)
        found: Fit = fit(lens, seen.sights, scene.prior)
        lens = found.lens
    near = np.abs(seen.sights.distances(lens)) <= MAX_SIGMAS * found.noise_px
    sights, sections = seen.sights.chosen(near), seen.sections[near]
    return Measured(painted, sights, sections, seen.rise_px, len(lumas), fit(lens, sights, scene.prior))
