"""What the periodic checks found in the newest images: boundary, lines, contours, exposure, colors.

A new check needs its record in ``vision_core.rtdb.records.CATALOG``, and here its model, its field of ``Checks`` and
its line of ``checks_from``.
"""

from app.web.blackboard import ServiceSnapshot
from app.web.reports.adaptation import Adaptation, adaptation_from
from app.web.reports.base import Report
from vision_core.rtdb import records
from vision_core.rtdb.items import Timed
from vision_core.types.objects import Team
from vision_core.types.regions import (
    BallVisibility,
    BodyContours,
    ColorDrift,
    ExposureCheck,
    FieldBoundary,
    Finding,
    LineCheck,
)


class Check(Report):
    """What one check found."""

    age_s: float
    """Age of the image that was checked [s]."""


class RobotReport(Report):
    """A robot, by its marker."""

    team: Team
    id: int | None
    """Marker id; null where it cannot be read."""


class BoundaryReport(Check):
    """Where the field's carpet ends in the picture."""

    found: float
    """Share of the directions in which the end of the carpet is seen, of those in which it should be."""
    error_px: float | None
    """Median distance of the carpet's end from its place in the venue, outward positive [px]: shows a wrong scale.
    null: too little of it is seen."""
    off_px: float | None
    """The largest median distance of the field's four sides, without its sign [px]: shows a camera that was moved.
    null: too little of it is seen."""


class LinesReport(Check):
    """Whether the painted lines are where the venue has them: shows a camera that was moved."""

    known: int
    """Lines that can be judged; 0 where none are painted, or all are too thin."""
    found: int
    """Lines that are where the venue has them."""
    samples: float | None
    """Share of the points of the known lines at which there is paint; null where none is known."""
    residual_px: float | None
    """Median distance of the found lines from their place [px]; null where none was found."""
    outside: float
    """Share of all lines' points that lie outside of the picture."""


class ContoursReport(Check):
    """Where robots hide the floor, and what that says about the ball."""

    ball: BallVisibility
    """seen; may be hidden: robots cover the place where it should be; out of the picture; gone: it should be where
    nothing hides it; unknown: it was not seen yet."""
    hiding: list[RobotReport]
    """Robots that cover some of the place where the ball should be."""
    can_hide_ball: list[RobotReport]
    """Robots behind which a ball that touches them may not be seen."""


class ExposureReport(Check):
    """How light the field is [grey levels]; null where the picture shows nothing of the field."""

    brightest: float | None
    """99.8 % of the field's pixels are darker than this in their brightest channel."""
    median_luma: float | None
    """Median brightness of the field."""
    white: float | None
    """Share of the field in which a channel is saturated."""
    reasons: list[str]
    """What is wrong with the light, and what to do, a line each; empty when nothing is."""


class ColorsReport(Check):
    """How the light differs from the light in which the colors were sampled."""

    gain_bgr: tuple[float, float, float]
    """Factors for blue, green and red that turn the picture into one in the venue's light."""
    reason: str
    """Why the light cannot be judged; empty when it can."""


class Checks(Report):
    """The newest finding of each check; null while the check does not run."""

    boundary: BoundaryReport | None
    lines: LinesReport | None
    contours: ContoursReport | None
    exposure: ExposureReport | None
    colors: ColorsReport | None
    adaptation: Adaptation | None
    """What colors and light became since the set-up; null before the task follow runs."""


def checks_from(snapshot: ServiceSnapshot) -> Checks:
    """The findings that are recent enough to be believed."""
    return Checks(
        boundary=_boundary(snapshot.recent(records.boundary)),
        lines=_lines(snapshot.recent(records.lines)),
        contours=_contours(snapshot.recent(records.contours)),
        exposure=_exposure(snapshot.recent(records.exposure)),
        colors=_colors(snapshot.recent(records.colors)),
        adaptation=adaptation_from(snapshot),
    )


def _boundary(timed: Timed[Finding[FieldBoundary]] | None) -> BoundaryReport | None:
    if timed is None:
        return None
    seen = timed.value.found
    return BoundaryReport(age_s=timed.age_s, found=seen.found, error_px=seen.error_px, off_px=seen.off_px)


def _lines(timed: Timed[Finding[LineCheck]] | None) -> LinesReport | None:
    if timed is None:
        return None
    seen = timed.value.found
    return LinesReport(
        age_s=timed.age_s,
        known=seen.known,
        found=seen.found,
        samples=seen.samples,
        residual_px=seen.residual_px,
        outside=seen.outside,
    )


def _contours(timed: Timed[Finding[BodyContours]] | None) -> ContoursReport | None:
    if timed is None:
        return None
    seen = timed.value.found
    return ContoursReport(
        age_s=timed.age_s,
        ball=seen.ball,
        hiding=[RobotReport(team=team, id=marker) for team, marker in seen.hiding],
        can_hide_ball=[RobotReport(team=body.team, id=body.id) for body in seen.bodies if body.can_hide_ball],
    )


def _exposure(timed: Timed[Finding[ExposureCheck]] | None) -> ExposureReport | None:
    if timed is None:
        return None
    seen = timed.value.found
    return ExposureReport(
        age_s=timed.age_s,
        brightest=seen.brightest,
        median_luma=seen.median_luma,
        white=seen.white,
        reasons=[str(reason) for reason in seen.reasons],
    )


def _colors(timed: Timed[Finding[ColorDrift]] | None) -> ColorsReport | None:
    if timed is None:
        return None
    return ColorsReport(age_s=timed.age_s, gain_bgr=timed.value.found.gain_bgr, reason=timed.value.found.reason)
