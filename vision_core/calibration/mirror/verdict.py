"""Judges a mirror that was fitted to pairs: how sure its curve is, what it rests on, and why it is refused."""

from collections.abc import Iterator

import numpy as np

from vision_core.calibration.mirror.contradictions import contradictions, rivals
from vision_core.calibration.mirror.fit import PARAMETERS, FocalPrior, MirrorFit, fit_mirror, radii_of
from vision_core.calibration.mirror.pairs import HALF_PX, Pairs
from vision_core.calibration.mirror.result import CurvePoint, MirrorCalibration, PairResult
from vision_core.calibration.mirror.rounding import Rounding
from vision_core.calibration.result import Progress, no_progress
from vision_core.errors import SettingsError
from vision_core.geometry import Floats
from vision_core.models.field import diagonal_m
from vision_core.models.mirror import Mirror, check_span
from vision_core.settings.schema import FieldSettings
from vision_core.types.reasons import Reason

SPAN_MM = np.linspace(100.0, 2500.0, 97)
"""Where the curve is judged and drawn."""
MIN_DISTANCES, MIN_RATIO = 6, 5.0
SAME = 0.01
"""Distances that differ by less than this share are one."""
MAX_OUTLIERS = 0.25
"""Largest share of pairs that may contradict the curve."""
MAX_NOISE_PX = 3.0
MAX_BAND_PX, BAND_PX = 3.0, 1.0
"""Two deviations of the curve: more are refused, or noted."""
FOCAL_SIGMAS = 4.0
"""A focal length that lies farther from what the pairs alone say is noted."""
MAX_CONDITION = 500.0
"""Above it A, B and C cannot be told from each other."""
NAMED = 5
DIGITS = 9
"""Of A, B, C: their rounding moves the curve by less than a thousandth of a pixel."""


def calibrate_mirror(
    pairs: Pairs, prior: FocalPrior | None, field: FieldSettings | None = None, *, progress: Progress = no_progress
) -> MirrorCalibration:
    """The mirror of equation 1 through pairs, with its verdict.

    prior: the focal length of the on-board camera; None: unknown. field: which the mirror has to resolve; None: no
    matter. What is refused says so in its reasons. Raises what progress raises.
    """
    reasons = tuple(_without_fit(pairs))
    if reasons:
        return _unfitted(pairs, reasons)
    known = prior or FocalPrior()
    progress("fitting the mirror", 0.1)
    fit = fit_mirror(pairs, known)
    progress("checking the result", 0.5)
    mirror, broken = _mirror(fit, field)
    reasons = (*_refusals(pairs, fit), *broken)
    if not reasons:
        either = next(rivals(pairs, known, fit), None)
        if either is not None:
            text = f"either {either} is wrong, and the other pairs do not tell which"
            reasons = (Reason(text, "Measure both again, or add pairs near them."),)
    result = _result(pairs, fit, mirror, reasons, tuple(_notes(pairs, prior, fit)))
    progress("done", 1.0)
    return result


def _without_fit(pairs: Pairs) -> Iterator[Reason]:
    """Why nothing can be fitted."""
    if len(pairs) <= PARAMETERS or _distinct(pairs.distances_mm) <= PARAMETERS:
        found = f"{_distinct(pairs.distances_mm)} distances are not enough for three constants"
        yield Reason(found, f"Measure at {MIN_DISTANCES} distances at least.")
    elif np.median(pairs.measured_px) > np.median(pairs.distances_mm):
        text = (
            f"the usual distance, {np.median(pairs.distances_mm):g} mm, is less than the usual radius,"
            f" {np.median(pairs.radii_px):g} px"
        )
        yield Reason(text, "Are both columns exchanged, or the distances in metres? A header names the units.")


def _refusals(pairs: Pairs, fit: MirrorFit) -> Iterator[Reason]:
    """Everything that is wrong with a fit, the most telling first."""
    kept = pairs.distances_mm[fit.kept]
    outliers = int((~fit.kept).sum())
    if outliers > MAX_OUTLIERS * len(pairs) or fit.noise_px > MAX_NOISE_PX:
        worst = "; ".join(contradictions(pairs, min(fit.noise_px, 1.0)))
        text = f"the pairs contradict each other: {outliers} of {len(pairs)} lie beside the curve of all others"
        if fit.noise_px > MAX_NOISE_PX:
            text = f"the pairs contradict each other: they lie {fit.noise_px:.1f} px beside the curve of one mirror"
        yield Reason(f"{text} ({worst})" if worst else text, "Measure again, from the robot's center on the floor.")
        return
    count = _distinct(kept)
    if count < MIN_DISTANCES:
        beside = f" ({_named(pairs, fit)} left out)" if outliers else ""
        text = f"pairs at {count} distances agree{beside}, {MIN_DISTANCES} are needed"
        yield Reason(text, f"Add pairs at other distances, {MIN_DISTANCES - count} more.")
    nearest, farthest = float(kept.min()), float(kept.max())
    if farthest < MIN_RATIO * nearest:
        text = f"the longest distance, {farthest:.0f} mm, is only {farthest / nearest:.1f} times the shortest"
        advice = f"Add pairs beyond {MIN_RATIO * nearest:.0f} mm, or nearer than {farthest / MIN_RATIO:.0f} mm."
        yield Reason(f"{text}, {MIN_RATIO:g} times are needed", advice)
    elif (band := _band_px(fit)) > MAX_BAND_PX:
        text = f"the curve would be up to {band:.1f} px off at {_widest_mm(fit):.0f} mm"
        yield Reason(text, "Add pairs near that distance, or give the camera's focal length.")


def _mirror(fit: MirrorFit, field: FieldSettings | None) -> tuple[Mirror | None, tuple[Reason, ...]]:
    """The mirror that a fit is, and the rule that it breaks."""
    try:
        mirror = Mirror(*(float(f"{value:.{DIGITS}g}") for value in fit.shape.constants))
    except SettingsError as error:
        text = f"the pairs want a mirror that is not allowed ({error.found}); accepted: {error.accepted}"
        return None, (
            Reason(
                text,
                "Check that radii are in pixels, distances in millimetres, and all of them measured from the center.",
            ),
        )
    if field is None:
        return mirror, ()
    try:
        check_span(mirror, diagonal_m(field))
    except SettingsError as error:
        text = f"{error.asked} is wanted: {error.found}; accepted: {error.accepted}"
        return mirror, (Reason(text, "Take a mirror that shows far places farther apart."),)
    return mirror, ()


def _notes(pairs: Pairs, prior: FocalPrior | None, fit: MirrorFit) -> Iterator[str]:
    if not fit.kept.all():
        yield f"{_named(pairs, fit)} left out: at least {np.abs(fit.off_px[~fit.kept]).min():.1f} px beside the curve"
    if pairs.are_cut:
        why = "all radii are whole numbers" if pairs.rounding is Rounding.AUTO else "as was said"
        yield f"radii count as cut by int() ({why}): {HALF_PX:g} px were added to each"
    if prior is None:
        yield "no focal length was given: it would make A, B and C meaningful"
    elif (alone := _other_focal_px(pairs, prior)) is not None:
        yield (
            f"the pairs alone want a focal length of {alone:.0f} px, not {prior.focal_px:g} px as given: is it in"
            " pixels, of pictures of this size?"
        )
    if (band := _band_px(fit)) > BAND_PX:
        yield f"add pairs near {_widest_mm(fit):.0f} mm: there the curve is only known to {band:.1f} px"
    if fit.shared_deviation_px(SPAN_MM).max() > fit.deviation_px(SPAN_MM).max() / np.sqrt(2.0):
        yield (
            f"all pairs of pictures share errors, of distances up to {pairs.shared[:, 0].max():g} mm: more pictures do"
            " not make the band narrower"
        )
    if fit.alike > 0.0:
        yield (
            f"the residuals are no noise: neighbours are alike (correlation {fit.alike:.2f}). Is the image's center"
            " right, are targets on the floor, and is the mirror hyperboloidal?"
        )


def _other_focal_px(pairs: Pairs, prior: FocalPrior) -> float | None:
    """The focal length that the pairs alone say, where it contradicts what was given."""
    alone = fit_mirror(pairs, FocalPrior())
    apart = abs(float(alone.logs[2]) - np.log(prior.focal_px))
    is_other = apart > FOCAL_SIGMAS * np.hypot(np.sqrt(alone.covariance[2, 2]), prior.share)
    return alone.shape.focal_px if is_other else None


def _words(fit: MirrorFit) -> Iterator[str]:
    """The verdict in sentences."""
    off = np.abs(fit.off_px[fit.kept])
    rms = np.sqrt((off**2).mean())
    spread = f"half of them within {np.median(off):.2f} px, the worst {off.max():.2f} px"
    yield f"{rms:.2f} px rms over {len(off)} pairs, {spread}"
    widest = f"two deviations, at {_widest_mm(fit):.0f} mm"
    yield f"the curve is known to {_band_px(fit):.2f} px between 0.1 and 2.5 m ({widest})"
    if fit.condition > MAX_CONDITION:
        shares = np.sqrt(np.diag(fit.constants_covariance())) / fit.shape.constants
        known = ", ".join(f"{name} to {share:.0%}" for name, share in zip("ABC", shares, strict=True))
        yield (
            f"A, B, C are not individually meaningful ({known}), the curve is (condition number {fit.condition:.2g})"
        )


def _result(
    pairs: Pairs, fit: MirrorFit, mirror: Mirror | None, reasons: tuple[Reason, ...], notes: tuple[str, ...]
) -> MirrorCalibration:
    off = np.abs(fit.off_px[fit.kept])
    rows = zip(SPAN_MM, radii_of(fit.shape, SPAN_MM), fit.deviation_px(SPAN_MM), strict=True)
    return MirrorCalibration(
        mirror=mirror,
        shape=fit.shape,
        reasons=reasons,
        notes=notes,
        words=tuple(_words(fit)),
        pairs=_pairs(pairs, fit),
        curve=tuple(CurvePoint(*(float(value) for value in row)) for row in rows),
        rms_px=float(np.sqrt((off**2).mean())),
        median_px=float(np.median(off)),
        worst_px=float(off.max()),
        band_px=_band_px(fit),
        covariance=tuple((float(a), float(b), float(c)) for a, b, c in fit.constants_covariance()),
        condition=fit.condition,
    )


def _unfitted(pairs: Pairs, reasons: tuple[Reason, ...]) -> MirrorCalibration:
    return MirrorCalibration(None, None, reasons, (), (), _pairs(pairs, None))


def _pairs(pairs: Pairs, fit: MirrorFit | None) -> tuple[PairResult, ...]:
    off: list[float | None] = [None] * len(pairs) if fit is None else fit.off_px.tolist()
    kept = [False] * len(pairs) if fit is None else fit.kept.tolist()
    rows = zip(pairs.names, pairs.measured_px.tolist(), pairs.distances_mm.tolist(), off, kept, strict=True)
    return tuple(PairResult(*row) for row in rows)


def _named(pairs: Pairs, fit: MirrorFit) -> str:
    """The pairs that were left out, the worst first."""
    worst = [number for number in np.argsort(-np.abs(fit.off_px)).tolist() if not fit.kept[number]]
    named = [f"{pairs.names[number]} ({fit.off_px[number]:+.1f} px)" for number in worst[:NAMED]]
    more = len(worst) - len(named)
    return ", ".join(named) + (f" and {more} more" if more else "")


def _band_px(fit: MirrorFit) -> float:
    return 2.0 * float(fit.deviation_px(SPAN_MM).max())


def _widest_mm(fit: MirrorFit) -> float:
    return float(SPAN_MM[int(np.argmax(fit.deviation_px(SPAN_MM)))])


def _distinct(distances_mm: Floats) -> int:
    """How many different distances there are."""
    count, last = 0, 0.0
    for distance in np.sort(distances_mm).tolist():
        if distance > last * (1.0 + SAME):
            count, last = count + 1, distance
    return count
