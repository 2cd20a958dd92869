"""A calibration of the camera, its lens or a mirror, as the page draws it."""

from msgspec import to_builtins

from app.web.background import JobState
from app.web.calibration.job import CameraCalibration, Work
from app.web.calibration.pictures import CalibrationPictures, Shown
from app.web.reports.base import Report
from app.web.reports.mirror import FoundPairReport, MirrorResult, found_from, mirror_from
from app.web.reports.reasons import ReasonReport, finite, reasons_from
from vision_core.calibration.board.result import LensCalibration
from vision_core.calibration.result import Calibration
from vision_core.settings.schema import Settings

Point = tuple[float, float]


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


class SeenReport(Report):
    """What one of several pictures shows of the field."""

    name: str
    sections: int
    """Of lines that are seen."""
    apart_px: float | None
    """How far from where the others show the field; null: too few lines are seen."""


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
    pictures: list[SeenReport]
    """What each of several pictures shows; empty for one."""


class BoardReport(Report):
    """One picture of a board."""

    name: str
    paper: str
    """Of the board: A4 or A3; empty: none was seen."""
    unseen: str
    """Why it does not count; empty: it does."""
    corners: list[tuple[float, float, float, float]]
    """x, y and the step x, y to where the lens puts the corner [px]."""
    rms_px: float | None
    held_out_px: float | None
    """The same by the lens of all other pictures."""
    tilt_deg: float | None


class LensResult(Report):
    """A lens that was measured with a board, or an attempt."""

    accepted: bool
    """It may be taken."""
    reasons: list[ReasonReport]
    notes: list[str]
    pictures: list[BoardReport]
    corners: int
    rms_px: float | None
    bend_error_px: float | None
    """Two standard deviations of a place in the picture, where it is largest."""
    coverage: float
    """Share of the picture in which a board was seen, 0..1."""
    regions: list[float]
    """The same for each ninth of the picture, row by row."""
    focal_px: float | None
    focal_deviation_px: float | None


class CalibrationPictureReport(Report):
    """A picture to calibrate by."""

    number: int
    name: str
    width_px: int
    height_px: int
    ceiling_s: float | None
    """When the ceiling camera's picture beside an on-board one was taken [seconds since 1970]; null: there is none."""


class CalibrationReport(Report):
    """The pictures that are calibrated by, and the newest job."""

    pictures: list[CalibrationPictureReport]
    """Of the field, by one camera that did not move."""
    boards: list[CalibrationPictureReport]
    """Of a board."""
    onboard: list[CalibrationPictureReport]
    """Of a robot's own camera."""
    work: Work
    """What the newest job does: camera, lens, mirror or pairs."""
    state: JobState
    """none, running, done (with a result, accepted or refused), failed (see error) or cancelled."""
    what: str
    """What is being done."""
    share: float
    """0..1 of the work is done."""
    error: str
    result: CalibrationResult | None
    lens: LensResult | None
    mirror: MirrorResult | None
    found: list[FoundPairReport] | None
    """Around the robot in the on-board picture that was looked at last; null: nothing was."""
    held_focal_px: float | None
    """Focal length of the lens that the settings have (camera.lens), which holds; null: they have none."""


def calibration_from(job: CameraCalibration, settings: Settings) -> CalibrationReport:
    """The report of the newest job. settings: with the changes that wait for a restart."""
    step, held = job.step, settings.camera.lens
    return CalibrationReport(
        pictures=_pictures(job.pictures, Shown.FIELD),
        boards=_pictures(job.pictures, Shown.BOARD),
        onboard=_pictures(job.pictures, Shown.ONBOARD),
        work=job.work,
        state=job.state,
        what=step.what,
        share=step.share,
        error=step.error,
        result=None if job.result is None else _result(job.result),
        lens=None if job.lens is None else _lens(job.lens),
        mirror=None if job.mirror is None else mirror_from(job.mirror),
        found=None if job.found is None else found_from(job.found),
        held_focal_px=None if held is None else held.focal_px,
    )


def _pictures(pictures: CalibrationPictures, kind: Shown) -> list[CalibrationPictureReport]:
    return [
        CalibrationPictureReport(
            number=one.number,
            name=one.name,
            width_px=one.size_px[0],
            height_px=one.size_px[1],
            ceiling_s=pictures.ceiling_s(one.number),
        )
        for one in pictures.of(kind)
    ]


def _result(result: Calibration) -> CalibrationResult:
    return CalibrationResult(
        accepted=result.accepted,
        reasons=reasons_from(result.reasons),
        notes=list(result.notes),
        lines=[LineReport(**{key: to_builtins(line)[key] for key in LineReport.model_fields}) for line in result.lines],
        samples=result.samples,
        rms_px=finite(result.rms_px),
        floor_error_mm=finite(result.floor_error_m * 1e3),
        marker_error_mm=finite(result.marker_error_m * 1e3),
        coverage=result.coverage,
        height_m=finite(result.camera.position_m[2]),
        focal_px=finite(result.camera.focal_px),
        pictures=[
            SeenReport(name=one.name, sections=one.sections, apart_px=finite(one.apart_px)) for one in result.pictures
        ],
    )


def _lens(result: LensCalibration) -> LensResult:
    lens = result.lens
    return LensResult(
        accepted=result.accepted,
        reasons=reasons_from(result.reasons),
        notes=list(result.notes),
        pictures=[BoardReport(**to_builtins(one)) for one in result.pictures],
        corners=result.corners,
        rms_px=finite(result.rms_px),
        bend_error_px=finite(result.bend_error_px),
        coverage=result.coverage,
        regions=list(result.regions.values()),
        focal_px=None if lens is None else lens.focal_px,
        focal_deviation_px=None if lens is None else lens.focal_deviation_px,
    )
