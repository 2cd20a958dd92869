"""A mirror that was fitted to pairs, and pairs that were found in a picture, as the page draws them."""

import numpy as np
from msgspec import to_builtins

from app.web.reports.base import Report
from app.web.reports.mirrors import MirrorShape, shape_of
from app.web.reports.reasons import ReasonReport, finite, reasons_from
from vision_core.calibration.job import FoundPairs
from vision_core.calibration.mirror.result import MirrorCalibration


class FoundPairReport(Report):
    """A pair that was found in an on-board picture."""

    name: str
    r_px: float
    r_mm: float
    shared_mm: float
    """Standard deviations of the errors that it shares with the others, for the request of a fit."""
    shared_px: float
    place_px: tuple[float, float]
    """In the picture."""


class PairReport(Report):
    """One pair."""

    name: str
    """What messages call it: "line 7", "row 7", or as the request said."""
    r_px: float
    """As it was fitted: with half a pixel more than given where radii were cut to whole numbers."""
    r_mm: float
    off_px: float | None
    """How much farther from the center it lies than the curve; null: there is none."""
    counts: bool
    """false: it contradicts the others and was left out."""


class CurveReport(Report):
    """The curve at one distance."""

    r_mm: float
    r_px: float
    deviation_px: float
    """Standard deviation: the band is twice as wide to either side."""


class ConstantsReport(MirrorShape):
    """A, B, C of equation 1 as they were fitted."""

    deviations: tuple[float, float, float]
    """Standard deviations of A, B, C."""


class MirrorResult(Report):
    """A mirror that was fitted, or an attempt."""

    accepted: bool
    """It may be taken."""
    reasons: list[ReasonReport]
    """Why it is refused; empty when it is accepted."""
    notes: list[str]
    words: list[str]
    """The verdict in sentences."""
    constants: ConstantsReport | None
    """null: there are too few pairs, or they want a mirror that is not allowed."""
    pairs: list[PairReport]
    """In the order in which they were given."""
    curve: list[CurveReport]
    """From 0.1 to 2.5 m; empty without one."""
    rms_px: float | None
    median_px: float | None
    worst_px: float | None
    """Of the distances of pairs that count from the curve."""
    band_px: float | None
    """Two standard deviations of the curve, where they are largest between 0.1 and 2.5 m."""
    condition: float | None


def mirror_from(result: MirrorCalibration) -> MirrorResult:
    """The report of a result."""
    return MirrorResult(
        accepted=result.accepted,
        reasons=reasons_from(result.reasons),
        notes=list(result.notes),
        words=list(result.words),
        constants=_constants(result),
        pairs=[PairReport(**to_builtins(pair)) for pair in result.pairs],
        curve=[CurveReport(**to_builtins(point)) for point in result.curve],
        rms_px=finite(result.rms_px),
        median_px=finite(result.median_px),
        worst_px=finite(result.worst_px),
        band_px=finite(result.band_px),
        condition=finite(result.condition),
    )


def found_from(found: FoundPairs) -> list[FoundPairReport]:
    """The report of the pairs of a picture."""
    return [
        FoundPairReport(
            name=pair.name,
            r_px=pair.r_px,
            r_mm=pair.r_mm,
            shared_mm=pair.shared.distance_mm,
            shared_px=pair.shared.radius_px,
            place_px=place,
        )
        for pair, place in zip(found.pairs, found.places_px, strict=True)
    ]


def _constants(result: MirrorCalibration) -> ConstantsReport | None:
    if result.mirror is None:
        return None
    deviation_a, deviation_b, deviation_c = np.sqrt(np.diag(np.array(result.covariance))).tolist()
    return ConstantsReport(deviations=(deviation_a, deviation_b, deviation_c), **shape_of(result.mirror))
