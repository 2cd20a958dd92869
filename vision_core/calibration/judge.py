"""Judges a calibration: how sure it is, line by line, and why it is refused."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from vision_core.calibration.certainty import hull_area, is_visible, place_error_m
from vision_core.calibration.lens import CENTER, FOCAL, HEIGHT, MEASURES, STRETCH, Lens
from vision_core.calibration.painted import TOUCH_LINES, Painted, placed, sections_for
from vision_core.calibration.result import Calibration, LineResult
from vision_core.calibration.solver import Fit, Prior, Sights, fit
from vision_core.calibration.start import FIXED
from vision_core.geometry import Bytes, Floats, Mask
from vision_core.settings.schema import FieldSettings, LensSettings
from vision_core.types.colors import LUMA_BGR
from vision_core.types.reasons import Reason

DARK, BRIGHT = 40.0, 250.0
"""A picture whose brightest hundredth is darker, or of which half is brighter, shows no lines [grey levels]."""
MIN_SIDE_PX = 64
MIN_SAMPLES, MIN_LINES = 40, 4
MIN_COVERAGE, MIN_COVERAGE_HELD = 0.5, 0.3
"""Least share of the field inside the hull of the lines: for any lens, and for one that was measured with a board."""
MIN_ACROSS = 0.1
"""Least share of sections on lines along, and on lines across the field."""
MIN_FOUND = 0.5
"""Least share of the visible lines' length that shows paint."""
LINE_FOUND = 0.5
"""A line counts as found when so much of its visible part shows paint."""
MAX_RMS_PX, MAX_RMS = 1.0, 0.0012
"""Largest rms distance: in pixels, or as a share of the picture's longer side."""
MAX_HELD_OUT_PX, MAX_HELD_OUT = 3.0, 0.004
"""Largest distance of a line from the place that all others give it, likewise."""
MAX_RISE_PX, MAX_RISE = 6.0, 0.008
"""Longest edge from carpet to paint, likewise: longer ones are blurred."""
MAX_FLOOR_ERROR_M, MAX_FLOOR_ERROR = 0.01, 0.005
"""Largest floor error: in metres, or as a share of the field's length."""
MAX_STEPS = 0.9
"""Largest share of sections along a wall that show a single edge, where the line's paint is seen."""
KNOWN = 0.5
"""A measure of the field was found when its deviation is less than this share of the one before."""
CENTER_SIGMAS = 4.0
"""A principal point or focal length that is pulled farther from its prior than so many deviations is none."""
GRID = 13


@dataclass(frozen=True)
class Scene:
    """What is calibrated."""

    field: FieldSettings
    size_px: tuple[int, int]
    prior: Prior
    marker_height_m: float
    edge_px: float
    """Length of the picture's sharpest edges."""
    held: LensSettings | None = None
    """A lens that was measured with a board, of which the prior knows."""

    @property
    def frees_measures(self) -> bool:
        """Are the field's measures solved as well?"""
        return bool((self.prior.deviations[STRETCH] > FIXED).any())

    @cached_property
    def grid_m(self) -> Floats:
        """Points all over the field, shape (GRID * GRID, 2)."""
        x, y = (np.linspace(-0.5, 0.5, GRID) * side for side in (self.field.length_m, self.field.width_m))
        return np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2)


@dataclass(frozen=True, slots=True, eq=False)
class Measured:
    """The sections that count, and the lens that fits them."""

    painted: Painted
    sights: Sights
    sections: NDArray[np.intp]
    """Index of each sight's section in painted, shape (n,)."""
    is_step: Mask
    """As of ``align.Seen``, shape (n,)."""
    rise_px: float
    beside_px: Floats
    """How far beside its place each line is seen that shows no paint there; nan for the others; shape (lines,)."""
    trust: float
    """As of ``solver.fit``."""
    fit: Fit

    @property
    def lens(self) -> Lens:
        """The camera."""
        return self.fit.lens

    @property
    def line(self) -> NDArray[np.intp]:
        """Index of each sight's line, shape (n,)."""
        return self.painted.line[self.sections]

    @property
    def shows_touch_paint(self) -> bool:
        """Do the touch lines show paint, not just where the floor ends at a wall?"""
        own = self.is_step[self.line < len(TOUCH_LINES)]
        return bool(own.mean() < MAX_STEPS) if len(own) else False


def picture_reasons(pictures: Sequence[Bytes], field: FieldSettings) -> tuple[Reason, ...]:
    """Why pictures cannot serve at all; () when they can."""
    if not field.line_width_m:
        text = f"the field {field.name!r} has no painted lines (line_width_m is 0)"
        return (Reason(text, "Set the width of its lines, or use named points."),)
    if reasons := size_reasons(pictures):
        return reasons
    lumas = [picture[::4, ::4] @ LUMA_BGR for picture in pictures]
    if (bright := max(float(np.percentile(luma, 99)) for luma in lumas)) < DARK:
        return (Reason(f"the picture is too dark: 99 % of it is below level {bright:.0f}", "Turn on the lamps."),)
    if (middle := min(float(np.median(luma)) for luma in lumas)) > BRIGHT:
        return (Reason(f"the picture is overexposed: half of it is above level {middle:.0f}", "Expose it shorter."),)
    return ()


def size_reasons(pictures: Sequence[Bytes]) -> tuple[Reason, ...]:
    """Why the sizes of pictures do not serve; () when they do."""
    sizes = {picture.shape[1::-1] for picture in pictures}
    if len(sizes) > 1:
        found = ", ".join(f"{width}x{height}" for width, height in sorted(sizes))
        return (Reason(f"the pictures have several sizes: {found}", "Use pictures of one camera and size."),)
    if min(min(size) for size in sizes) < MIN_SIDE_PX:
        text = f"the picture is only {min(sizes)[0]}x{min(sizes)[1]} px"
        return (Reason(text, f"Use pictures of {MIN_SIDE_PX} px or more a side."),)
    return ()


def judged(scene: Scene, lens: Lens, measured: Measured | None, reasons: tuple[Reason, ...]) -> Calibration:
    """The verdict on a lens. measured: None when no line could be found."""
    lines = _lines(scene, lens, measured)
    covariance = np.diag(scene.prior.deviations**2)
    if measured is not None:
        covariance = measured.fit.covariance(scene.prior)
    heights = 0.0, scene.marker_height_m
    floor, marker = (place_error_m(lens, covariance, scene.grid_m, scene.size_px, height) for height in heights)
    has_sights = measured is not None and len(measured.sights) > 0
    rms = float(np.sqrt((measured.sights.distances(lens) ** 2).mean())) if measured and has_sights else float("nan")
    spanned = hull_area(measured.sights.points_m) if measured and has_sights else 0.0
    result = Calibration(
        camera=lens.settings(),
        size_px=scene.size_px,
        measures_m=_measures_m(scene, lens, covariance),
        reasons=reasons,
        notes=(),
        lines=lines,
        samples=0 if measured is None else len(measured.sights),
        rms_px=rms,
        floor_error_m=floor,
        height_deviation_m=float(np.sqrt(covariance[HEIGHT, HEIGHT])),
        marker_error_m=marker,
        condition=float("inf") if measured is None else measured.fit.condition,
        coverage=spanned / (scene.field.length_m * scene.field.width_m),
    )
    if reasons:
        return result
    found = tuple(_refusals(scene, result, measured, lens))
    return replace(result, reasons=found, notes=tuple(_notes(result)))


def _measures_m(scene: Scene, lens: Lens, covariance: Floats) -> dict[str, float]:
    """The field's measures by a lens, where they are solved and the lines say something about them."""
    if not scene.frees_measures:
        return {}
    nominal = {name: getattr(scene.field, name) for name in MEASURES}
    is_known = np.sqrt(np.diag(covariance)[STRETCH]) < KNOWN * scene.prior.deviations[STRETCH]
    rows = zip(nominal.items(), lens.stretch.tolist(), is_known.tolist(), strict=True)
    return {name: round(value + more, 4) for (name, value), more, known in rows if value and known}


def _refusals(scene: Scene, result: Calibration, measured: Measured | None, lens: Lens) -> Iterator[Reason]:
    """Everything that is wrong with a calibration, the most telling first."""
    preset = f"Is {scene.field.name!r} the preset of this field? Drag the corners nearer to their places."
    visible = [line for line in result.lines if line.visible > 0.2]
    found = [line for line in visible if line.found >= LINE_FOUND]
    if measured is None or result.samples < MIN_SAMPLES or len(found) < MIN_LINES:
        text = f"only {len(found)} of {len(result.lines)} painted lines were found, {MIN_LINES} are needed"
        blurred = scene.edge_px > max(MAX_RISE_PX, MAX_RISE * max(scene.size_px))
        if blurred:
            yield Reason(
                f"the picture is blurred: its sharpest edges are {scene.edge_px:.0f} px long", "Focus the lens."
            )
        yield Reason(text, preset)
        return
    if measured.rise_px > max(MAX_RISE_PX, MAX_RISE * max(scene.size_px)):
        yield Reason(f"the picture is blurred: edges of lines are {measured.rise_px:.0f} px long", "Focus the lens.")
    along = np.abs(measured.painted.across[measured.sections][:, 1]) > np.sqrt(0.5)
    if min(along.mean(), 1.0 - along.mean()) < MIN_ACROSS:
        yield Reason("nearly all of the lines that were found run in one direction", "Show lines in both directions.")
    needed = MIN_COVERAGE if scene.held is None else MIN_COVERAGE_HELD
    if result.coverage < needed:
        text = f"the lines that were found span {result.coverage:.0%} of the field, {needed:.0%} are needed"
        yield Reason(text, "Move the camera so that it sees the whole field, or clear the lines.")
    share = sum(line.found * line.visible for line in visible) / sum(line.visible for line in visible)
    if share < MIN_FOUND:
        yield Reason(f"only {share:.0%} of the lines' length shows paint at its place", preset)
    if scene.frees_measures and not any(line.name in TOUCH_LINES for line in found):
        text = "neither touch line was found, so nothing tells how wide the field is"
        yield Reason(text, "Clear the touch lines, or measure the field's width and take it as it is.")
    elif scene.frees_measures and scene.field.line_width_m > _most_m(scene) and not measured.shows_touch_paint:
        beside_mm = 2e3 * scene.field.line_width_m
        yield Reason(
            "along the touch lines only the walls' edge is seen, with paint before it or without: that is "
            f"{beside_mm:.0f} mm of the field's width",
            "Measure the field's width and take it as it is; where no touch line is painted, name points at the walls.",
        )
    if result.rms_px > max(MAX_RMS_PX, MAX_RMS * max(scene.size_px)):
        text = f"the lines lie {result.rms_px:.1f} px (rms) beside where one camera can see them"
        yield Reason(text, "Check the field's measures.")
    displaced = [line for line in visible if line.beside_px is not None]
    if displaced:
        worst = max(displaced, key=lambda line: line.beside_px or 0.0)
        yield Reason(
            f"the {worst.name} is seen {worst.beside_px:.0f} px beside its place", "Check the field's measures."
        )
    tested = [(line.held_out_px, line.name) for line in found if line.held_out_px is not None]
    if tested and max(tested)[0] > max(MAX_HELD_OUT_PX, MAX_HELD_OUT * max(scene.size_px)):
        text = f"the {max(tested)[1]} lies {max(tested)[0]:.0f} px beside the place that all other lines give it"
        yield Reason(text, "Check the field's measures.")
    if result.floor_error_m > _most_m(scene):
        advice = "Show more of the lines."
        if result.is_height_unknown:
            advice = "Measure the camera's height with a tape and give it, or show more of the lines."
        yield Reason(f"places on the floor would be {result.floor_error_m * 1e3:.0f} mm off", advice)
    yield from _lens_refusals(scene, lens, preset)


def _most_m(scene: Scene) -> float:
    """How far off places on the floor may be [m]."""
    return max(MAX_FLOOR_ERROR_M, MAX_FLOOR_ERROR * scene.field.length_m)


def _lens_refusals(scene: Scene, lens: Lens, preset: str) -> Iterator[Reason]:
    """A lens that is far from what was known of it before."""
    pulled = np.abs(scene.prior.distances(lens))
    is_other = pulled[FOCAL] > CENTER_SIGMAS or pulled[CENTER].max() > CENTER_SIGMAS
    if scene.held is None:
        if is_other:
            text = "the lines fit only a lens that is not a usual one"
            yield Reason(f"{text}: focal length or center are far from what is expected", preset)
        return
    if is_other:
        focal = f"{lens.focal_px:.0f} px, not {scene.held.focal_px:.0f} px"
        text = f"the lines contradict the lens that was measured with the board: they want a focal length of {focal}"
        yield Reason(text, "Was the lens turned since? Measure it anew, or take [camera.lens] out.")
    if pulled[HEIGHT] > CENTER_SIGMAS:
        text = f"lens and lines put the camera {lens.position_m[2]:.2f} m high, not {scene.prior.values[HEIGHT]:.2f} m"
        yield Reason(text, "Measure the camera's height again, or the lens.")


def _notes(result: Calibration) -> Iterator[str]:
    height_m = result.camera.position_m[2]
    if result.is_height_unknown:
        yield (
            f"lines on the floor do not say how high the camera is ({height_m:.2f} m +- {result.height_deviation_m:.2f}"
            f" m): robots may be up to {result.marker_error_m * 1e3:.0f} mm off; measure it with a tape"
        )
    yield (
        "the lines look the same from both ends: which goal is at the left follows from the first guess, not from the"
        " picture"
    )
    missing = [line.name for line in result.lines if line.visible > 0.2 and line.found < LINE_FOUND]
    if missing:
        yield f"without paint at its place: {', '.join(missing)}"


def _lines(scene: Scene, lens: Lens, measured: Measured | None) -> tuple[LineResult, ...]:
    painted = sections_for(scene.field, lens) if measured is None else measured.painted
    middles = placed(painted, lens).points_px.mean(axis=1)
    visible = is_visible(middles, scene.size_px)
    results = []
    for number, name in enumerate(painted.names):
        own = painted.line == number
        path = middles[own][np.isfinite(middles[own]).all(axis=1)].round(1)
        points = tuple((x, y) for x, y in path.tolist())
        share = float(visible[own].mean())
        beside = None if measured is None or np.isnan(measured.beside_px[number]) else float(measured.beside_px[number])
        if measured is None or not (mine := measured.line == number).any():
            results.append(LineResult(name, points, share, 0.0, None, beside, None, ()))
            continue
        sights = measured.sights.chosen(mine)
        distances = sights.distances(lens)
        shown = len(sights) / max(float(visible[own].sum()), 1.0)
        held_out = _held_out_px(scene, measured, ~mine)
        vectors = np.column_stack([sights.pixels, -sights.normals * distances[:, None]])
        places = np.column_stack([lens.project(sights.places_m(lens)), vectors[:, 2:]]).round(2).tolist()
        results.append(
            LineResult(
                name,
                points,
                share,
                min(shown, 1.0),
                _rms(distances),
                beside,
                held_out,
                tuple((x, y, u, v) for x, y, u, v in places),
            )
        )
    return tuple(results)


def _held_out_px(scene: Scene, measured: Measured, rest: NDArray[np.bool_]) -> float | None:
    """How far a line lies beside the place that all other lines give it [px rms]."""
    if rest.sum() < MIN_SAMPLES // 2:
        return None
    lens = fit(measured.lens, measured.sights.chosen(rest), scene.prior, trust=measured.trust, steps=3).lens
    return _rms(measured.sights.chosen(~rest).distances(lens))


def _rms(distances: Floats) -> float:
    return float(np.sqrt((distances**2).mean()))
