"""A calibration of the camera, as the page draws it."""

import math

from msgspec import to_builtins

from app.web.background import JobState
from app.web.calibration.job import CameraCalibration
from app.web.reports.base import Report

Point = tuple[float, float]


class ReasonReport(Report):
    """Why a calibration is refused."""

    text: str
    advice: str


class LineReport(Report):
    """One painted line of the field."""

    name: str
    points_px: list[Point]
    """Where the camera puts it: a path."""
    found: float
    """Share of its visible part that shows paint at its place, 0..1."""
    rms_px: float | None
    """Of the paint's distances from its place; null where none was found."""
    held_out_px: float | None
    """The same when the camera is fitted to all other lines; null where they do not suffice."""
    residuals: list[tuple[float, float, float, float]]
    """x, y and the step x, y to where the paint is [px]."""


class CalibrationResult(Report):
    """A camera that was calibrated, or an attempt."""

    accepted: bool
    """It may be taken."""
    reasons: list[ReasonReport]
    """Why it is refused; empty when it is accepted."""
    notes: list[str]
    lines: list[LineReport]
    samples: int
    """Sections of lines that count; where too few do, what could not be measured is null."""
    rms_px: float | None
    floor_error_mm: float | None
    """Two standard deviations of a place on the floor, where it is largest."""
    marker_error_mm: float | None
    """The same at the height of the robots' markers."""
    coverage: float
    """Share of the field inside the hull of the sections that count, 0..1."""
    height_m: float | None
    """Of the camera."""
    focal_px: float | None


class CalibrationReport(Report):
    """The picture that is calibrated by, and the newest job."""

    picture: int | None
    """Number of its frame; null: none was taken."""
    width_px: int
    height_px: int
    state: JobState
    """none, running, done (with a result, accepted or refused), failed (see error) or cancelled."""
    what: str
    """What is being done."""
    share: float
    """0..1 of the work is done."""
    error: str
    result: CalibrationResult | None


def calibration_from(job: CameraCalibration) -> CalibrationReport:
    """The report of the newest job."""
    picture, step = job.picture, job.step
    height, width = picture.pixels.shape[:2] if picture is not None else (0, 0)
    return CalibrationReport(
        picture=picture.number if picture is not None else None,
        width_px=width,
        height_px=height,
        state=job.state,
        what=step.what,
        share=step.share,
        error=step.error,
        result=_result(job),
    )


def _result(job: CameraCalibration) -> CalibrationResult | None:
    result = job.result
    if result is None:
        return None
    return CalibrationResult(
        accepted=result.accepted,
        reasons=[ReasonReport(text=reason.text, advice=reason.advice) for reason in result.reasons],
        notes=list(result.notes),
        lines=[LineReport(**{key: to_builtins(line)[key] for key in LineReport.model_fields}) for line in result.lines],
        samples=result.samples,
        rms_px=_finite(result.rms_px),
        floor_error_mm=_finite(result.floor_error_m * 1e3),
        marker_error_mm=_finite(result.marker_error_m * 1e3),
        coverage=result.coverage,
        height_m=_finite(result.camera.position_m[2]),
        focal_px=_finite(result.camera.focal_px),
    )


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None
