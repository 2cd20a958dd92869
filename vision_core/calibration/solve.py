"""From pictures, the field's measures and, if there is one, a first guess to a camera and a verdict."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from vision_core.calibration.align import look, searched, shifted
from vision_core.calibration.find import corners_m, find_field
from vision_core.calibration.judge import Measured, Scene, judged, picture_reasons
from vision_core.calibration.lens import Lens
from vision_core.calibration.moved import moved_notes, moved_reasons, pictures_seen
from vision_core.calibration.painted import Painted, sections_for
from vision_core.calibration.profiles import FloatImage, luma_of, sharpest_edge_px
from vision_core.calibration.result import Calibration, PictureResult, Progress, no_progress
from vision_core.calibration.ridges import find_ridges
from vision_core.calibration.solver import Fit, fit
from vision_core.calibration.start import Start, start_from_points, start_without_lines, with_free_measures
from vision_core.errors import SettingsError
from vision_core.geometry import Bytes, Floats, Mask
from vision_core.settings.schema import FieldSettings, LensSettings
from vision_core.types.reasons import Reason

FINE_PX = (3.0, 2.5, 2.0)
"""How far beside their places edges are searched in the last rounds; in a picture over 800 px wide in proportion."""
FREE_PX = (8.0, 5.0)
"""Rounds before these where the field's measures are estimates: lines along walls count from here on."""
BESIDE_PX, LINE_SHARE, SCATTER_PX = 16.0, 0.5, 1.0
"""A line is seen beside its place when so much of it is found up to so far away, scattered by no more than this."""
SPOT = 0.1
"""A line counts when at least this share of its sections shows paint: less may be anything."""
NEAR_PX = 3.0
"""Of several first guesses the one counts after which most paint lies so near to its place."""
MAX_SEARCHED, SHOWN = 3, 0.5
"""In so many pictures the field is searched, until this share of its sections shows paint."""
MAX_SIGMAS = 3.0
"""Sections that miss the lens by more do not count."""
MAX_ALIKE = 0.95
"""Largest correlation between the distances of neighbouring sections."""
RIVAL = 0.85
"""Another place of the field is a rival if it explains at least this share of the sections of the best one."""
RIVAL_ERROR, RIVAL_ERROR_PX = 2.0, 1.0
"""A place of the field that was found is tried when its error is at most so many times that of the best and more."""
CHANGED = 0.005
"""Relative difference from which on another measure of the field is named."""
APART = 0.01
"""Two places of the field differ when its corners are so far apart, as a share of its size."""


@dataclass(frozen=True, slots=True, eq=False)
class _Try:
    """A first guess that was moved onto the lines."""

    start: Start
    lens: Lens
    sections: int
    """Sections that show paint near their places."""


@dataclass(frozen=True, slots=True)
class _Known:
    """What is known besides the pictures."""

    height_m: float | None
    held: LensSettings | None
    marker_height_m: float
    names: tuple[str, ...]
    """Of the pictures."""


def calibrate(
    pictures: Sequence[Bytes],
    field: FieldSettings,
    start: Start | None,
    *,
    names: Sequence[str] = (),
    height_m: float | None = None,
    frees_measures: bool = False,
    held: LensSettings | None = None,
    marker_height_m: float = 0.0,
    advises: bool = True,
    progress: Progress = no_progress,
) -> Calibration:
    """Calibrate one camera by the painted lines in one or more of its pictures, between which it did not move.

    pictures: shape (height, width, 3) each, of one size; start: a camera that shows the lines at most a sixth of the
    picture beside their places; None: the field is searched, which must be wholly visible, and height_m is the camera's
    height by tape measure, if somebody measured it; names: what messages call the pictures; held: a lens that was
    measured with a board, of which start knows already; frees_measures: the field's measures, except its length, are
    estimates that are solved as well; marker_height_m: of the robots; advises: if it is refused, other measures of the
    field are tried, which takes as long again. What is refused says so in its reasons. Raises what progress raises.
    """
    called = tuple(names) or tuple(f"picture {number}" for number in range(1, len(pictures) + 1))
    known = _Known(height_m, held, marker_height_m, called)
    result = _calibrate(pictures, field, start, frees_measures, known, progress)
    if result.accepted or frees_measures or not advises or not result.samples or _has_moved(result):
        return result
    progress("trying other measures of the field", 1.0)
    other = _calibrate(pictures, field, start, True, known, no_progress)
    return replace(result, reasons=(*result.reasons, _better_measures(field, other))) if other.accepted else result


def from_other_end(result: Calibration) -> Calibration:
    """The same with left and right goal exchanged: lines do not tell which end is which."""
    return replace(result, camera=Lens.from_settings(result.camera).from_other_end().settings())


def _better_measures(field: FieldSettings, other: Calibration) -> Reason:
    """That the lines would fit if the field had other measures."""
    changed = [
        f"{name} = {value:.3f} (not {getattr(field, name):g})"
        for name, value in other.measures_m.items()
        if abs(value - getattr(field, name)) > CHANGED * value
    ]
    text = f"the lines would fit to {other.rms_px:.1f} px if the field had {' and '.join(changed) or 'other measures'}"
    return Reason(text, "Measure it with a tape, or let the measures be solved too (--measures).")


def _calibrate(
    pictures: Sequence[Bytes],
    field: FieldSettings,
    start: Start | None,
    frees_measures: bool,
    known: _Known,
    progress: Progress,
) -> Calibration:
    """``calibrate`` with the field's measures as they are, or as estimates."""
    size = pictures[0].shape[1], pictures[0].shape[0]
    progress("looking at the pictures", 0.0)
    first = start or start_without_lines(field, size, height_m=known.height_m, held=known.held)
    scene = Scene(field, size, first.prior, known.marker_height_m, edge_px=0.0, held=known.held)
    if reasons := picture_reasons(pictures, field):
        return judged(scene, first.lens, None, reasons)
    lumas = [luma_of(picture) for picture in pictures]
    scene = replace(scene, edge_px=min(map(sharpest_edge_px, lumas)))
    tries: list[_Try] = []
    for pixels in pictures[:MAX_SEARCHED]:
        progress("searching the field", 0.1)
        starts = _near(start, pixels, field) if start else _found(pixels, field, size, known)
        if frees_measures:
            starts = [with_free_measures(guess, field) for guess in starts]
        for number, guess in enumerate(starts):
            progress("moving it onto the lines", 0.3 + 0.4 * number / len(starts))
            tries += _tries(guess, field, lumas)
        tries.sort(key=lambda one: -one.sections)
        if tries and tries[0].sections > SHOWN * len(sections_for(field, tries[0].lens)):
            break
    if not tries:
        return judged(scene, first.lens, None, ())
    progress("fitting the camera", 0.7)
    scene = replace(scene, prior=tries[0].start.prior)
    measured = _refined(scene, tries[0].lens, lumas)
    progress("checking the result", 0.8)
    result = judged(scene, measured.lens, measured, ())
    if start is None:
        result = replace(result, reasons=result.reasons + _rival(scene, tries, measured, lumas))
    if len(pictures) > 1:
        progress("comparing the pictures", 0.9)
        result = _compared(result, pictures_seen(scene, measured.lens, pictures, lumas, known.names))
    progress("done", 1.0)
    return result


def _has_moved(result: Calibration) -> bool:
    """Did the camera move between the pictures?"""
    return bool(moved_reasons(result.pictures, result.size_px))


def _compared(result: Calibration, seen: tuple[PictureResult, ...]) -> Calibration:
    """The same result with what each picture shows: a camera that moved between them is refused."""
    reasons = moved_reasons(seen, result.size_px) or result.reasons
    return replace(result, pictures=seen, reasons=reasons, notes=(*result.notes, *moved_notes(seen, result.size_px)))


def _near(start: Start, pixels: Bytes, field: FieldSettings) -> list[Start]:
    """A first guess, and the same after a coarse alignment."""
    moved = shifted(start.lens, sections_for(field, start.lens), find_ridges(pixels), start.prior)
    return [start, Start(moved, start.prior)]


def _found(pixels: Bytes, field: FieldSettings, size_px: tuple[int, int], known: _Known) -> list[Start]:
    """First guesses from a search of the whole picture."""
    starts = []
    places = find_field(pixels, field)
    for found in places:
        if found.error_px > RIVAL_ERROR * places[0].error_px + RIVAL_ERROR_PX:
            break
        try:
            starts.append(
                start_from_points(found.corners_px, corners_m(field), size_px, height_m=known.height_m, held=known.held)
            )
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
    trust = 1.0
    for reach_px in (*(FREE_PX if scene.frees_measures else ()), *FINE_PX):
        painted = sections_for(scene.field, lens)
        seen = look(painted, lens, lumas, reach_px * scale)
        sights = seen.sights.chosen(_is_shown(painted, seen.sections))
        found: Fit = fit(lens, sights, scene.prior, trust=trust)
        lens = found.lens
        trust = _trust(seen.sights.distances(lens), painted.line[seen.sections])
    near = np.abs(seen.sights.distances(lens)) <= MAX_SIGMAS * found.noise_px
    near &= _is_shown(painted, seen.sections)
    sights, sections, is_step = seen.sights.chosen(near), seen.sections[near], seen.is_step[near]
    found = fit(lens, sights, scene.prior, trust=trust)
    beside = _beside(painted, found.lens, lumas, sections)
    return Measured(painted, sights, sections, is_step, seen.rise_px, beside, trust, found)


def _is_shown(painted: Painted, sections: NDArray[np.intp]) -> Mask:
    """Which sections belong to lines that show more than a spot of paint at their places."""
    count = len(painted.names)
    shown = np.bincount(painted.line[sections], minlength=count)
    enough = shown >= SPOT * np.bincount(painted.line, minlength=count)
    is_shown: Mask = enough[painted.line[sections]]
    return is_shown


def _beside(painted: Painted, lens: Lens, lumas: Sequence[FloatImage], shown: NDArray[np.intp]) -> Floats:
    """How far beside its place each line is seen that shows no paint there, nan for the others; shape (lines,) [px].

    shown: indices of the sections that show paint at their places.
    """
    scale = max(max(lumas[0].shape) / 800.0, 1.0)
    seen = look(painted, lens, lumas, BESIDE_PX * scale, singles=False)
    distances, line = seen.sights.distances(lens), painted.line[seen.sections]
    beside = np.full(len(painted.names), np.nan)
    for number in range(len(painted.names)):
        own, count = distances[line == number], (painted.line == number).sum()
        if len(own) < LINE_SHARE * count or (painted.line[shown] == number).sum() > LINE_SHARE * count:
            continue
        middle = float(np.median(own))
        if abs(middle) > NEAR_PX * scale and np.median(np.abs(own - middle)) < SCATTER_PX * scale:
            beside[number] = abs(middle)
    return beside


def _trust(distances: Floats, line: NDArray[np.intp]) -> float:
    """The share of sections that count as independent, by how alike the distances of neighbours on a line are."""
    pairs = (distances[:-1] * distances[1:])[line[:-1] == line[1:]]
    alike = float(pairs.mean() / max(float((distances**2).mean()), 1e-12)) if len(pairs) else 0.0
    alike = min(max(alike, 0.0), MAX_ALIKE)
    return (1.0 - alike) / (1.0 + alike)
