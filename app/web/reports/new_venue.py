"""A venue that is being set up, as the page shows it."""

from typing import Any

from app.web.background import JobState
from app.web.reports.base import Report
from app.web.reports.calibration import LineReport, Point
from app.web.reports.reasons import ReasonReport
from app.web.venue.desk import Desk
from vision_core.patterns.pattern import Pattern
from vision_core.settings.schema import FieldSettings
from vision_core.setup.choices import missing_colors, needed_colors, pattern_choices
from vision_core.setup.draft import Draft
from vision_core.setup.findings import CameraTrial, FieldTrial, PictureTrial, VenueTrial, painted_share
from vision_core.venues.loader import own_venues_folder
from vision_core.venues.presets import field_of, shipped_fields


class GoalMeasures(Report):
    """Both goals [m]."""

    width_m: float
    depth_m: float


class FieldMeasures(Report):
    """The field's measures, from the outer edge of one line to the outer edge of the opposite one [m]."""

    name: str
    length_m: float
    width_m: float
    margin_m: float
    walls: bool
    wall_height_m: float
    corner_cut_m: float
    line_width_m: float
    center_circle_radius_m: float
    penalty_depth_m: float
    penalty_width_m: float
    goal: GoalMeasures


class DraftPictureReport(Report):
    """One picture of the venue."""

    file: str
    """Its name on the server: another picture has another one."""
    name: str
    width_px: int
    height_px: int


class DraftCameraReport(Report):
    """The camera that was taken."""

    model: str
    how: str
    """How it was made, in words."""


class CameraTrialReport(Report):
    """A camera that was searched."""

    is_accepted: bool
    is_current: bool
    """It is for the pictures and the field of the draft as it is now."""
    is_taken: bool
    by_lines: bool
    """Painted lines checked it; false: from corners alone."""
    reasons: list[ReasonReport]
    """Why it is refused; empty when it is accepted."""
    notes: list[str]
    lines: list[LineReport]
    painted: float
    """Share of the painted lines, by their length, that show paint at their places."""
    rms_px: float | None
    floor_error_mm: float | None
    marker_error_mm: float | None
    coverage: float | None
    height_m: float | None
    is_height_unknown: bool
    """Neither the lines nor a tape measure tell it."""
    measures_m: dict[str, float]
    """Measures of the field that were solved with it."""


class FieldTrialReport(Report):
    """How well a preset explains the pictures."""

    preset: str
    is_accepted: bool
    painted: float
    rms_px: float | None
    reason: str
    """Why its camera is refused, the first reason; empty when it is accepted."""


class PaintReport(Report):
    """The color of one paint that was found."""

    name: str
    color: str
    """#rrggbb"""
    patches: int
    """How many patches show it; 0: its name alone tells it."""


class ColorTrialReport(Report):
    """Colors that were found without a click."""

    is_accepted: bool
    is_current: bool
    """They are of the draft's pictures, markers and ball as they are now."""
    is_taken: bool
    paints: list[PaintReport]
    robots: int
    """That are read with these colors, in all pictures."""
    with_id: int
    balls: int
    reasons: list[ReasonReport]
    """What is doubtful."""


class SeenRobotReport(Report):
    """A robot that was found."""

    team: str
    id: int | None
    x_m: float
    y_m: float


class PictureTrialReport(Report):
    """What is seen in one picture."""

    robots: list[SeenRobotReport]
    read: int
    """Robots whose id is read."""
    balls: int
    obstacles: int
    reasons: list[str]
    error: str
    before: str
    """What the settings in use see there, in words; empty: they are not for such pictures."""


class VenueTrialReport(Report):
    """What is seen with the venue."""

    is_current: bool
    """It is what the draft as it is now sees."""
    pictures: list[PictureTrialReport]
    why_not_before: str
    """Why there is nothing to compare with; empty where there is."""


class NewVenueReport(Report):
    """The draft of a new venue, what its steps found, and the step that runs."""

    number: int
    """Of the draft; each change makes another one."""
    undo: str | None
    """What undo takes back; null: nothing."""
    redo: str | None
    notice: str
    """What happened to a damaged draft."""
    name: str
    about: str
    source: str
    pictures: list[DraftPictureReport]
    preset: str
    field: FieldMeasures | None
    is_own_field: bool
    """The measures differ from the preset's."""
    camera: DraftCameraReport | None
    pattern: str
    robot_radius_m: float
    robot_height_m: float
    numbers: int
    ball_color: str
    ball_radius_m: float
    samples: dict[str, list[str]]
    needed_colors: list[str]
    """Classes that the markers and the ball have, the ball's first."""
    missing_colors: list[str]
    """Those without a sample."""
    job: str
    """The newest step: field, camera, colors or trial; empty: none."""
    state: JobState
    what: str
    share: float
    error: str
    fields: list[FieldTrialReport] | None
    """Every preset, the best first; null: not tried with these pictures."""
    found_camera: CameraTrialReport | None
    found_colors: ColorTrialReport | None
    trial: VenueTrialReport | None
    is_saved: bool
    """There is a venue's file of this name."""


class PatternChoice(Report):
    """A marker pattern that comes with PSLV."""

    name: str
    ids: list[int]
    radius_m: float
    height_m: float
    outline: str
    colors: list[str]
    """Of the code patches."""


class FieldChoice(Report):
    """A field preset that comes with PSLV."""

    preset: str
    measures: FieldMeasures


class ChoicesReport(Report):
    """What there is to choose from."""

    fields: list[FieldChoice]
    patterns: list[PatternChoice]


class ClassReport(Report):
    """A color class in a picture."""

    name: str
    share: float
    """Of the picture, 0..1."""
    color: str
    """In which it is drawn, #rrggbb."""


class ClassesReport(Report):
    """The classes of a picture's pixels."""

    number: int
    """Of the draft."""
    classes: list[ClassReport]


class SampledReport(Report):
    """A color that was measured, and the draft with it."""

    color: str
    words: str
    venue: NewVenueReport


class SavedReport(Report):
    """A venue's file that was written."""

    path: str
    command: str
    """With which a service starts with it."""


class DifferenceReport(Report):
    """A setting that the venue changes."""

    key: str
    before: Any
    after: Any


def choices_from() -> ChoicesReport:
    """Presets and patterns."""
    return ChoicesReport(
        fields=[FieldChoice(preset=name, measures=_measures(field)) for name, field in shipped_fields().items()],
        patterns=[_pattern(name, pattern) for name, pattern in pattern_choices().items()],
    )


def venue_from(desk: Desk) -> NewVenueReport:
    """The draft and everything that is known of it."""
    draft, drafts, job = desk.draft, desk.drafts, desk.job
    return NewVenueReport(
        number=drafts.number,
        undo=drafts.undoable,
        redo=drafts.redoable,
        notice=drafts.notice,
        name=draft.name,
        about=draft.about,
        source=draft.source,
        pictures=[
            DraftPictureReport(file=one.file, name=one.name, width_px=one.width_px, height_px=one.height_px)
            for one in draft.pictures
        ],
        preset=draft.preset,
        field=_measures(draft.field) if draft.field else None,
        is_own_field=draft.field is not None and draft.field != field_of(draft.preset),
        camera=DraftCameraReport(model=draft.camera.model, how=draft.camera.how) if draft.camera else None,
        pattern=draft.pattern,
        robot_radius_m=draft.robot_radius_m,
        robot_height_m=draft.robot_height_m,
        numbers=draft.numbers,
        ball_color=draft.ball_color,
        ball_radius_m=draft.ball_radius_m,
        samples={name: list(colors) for name, colors in draft.samples.items()},
        needed_colors=needed_colors(draft),
        missing_colors=missing_colors(draft),
        job=desk.step,
        state=job.state,
        what=job.step.what,
        share=job.step.share,
        error=job.step.error,
        fields=_fields(desk),
        found_camera=_camera(desk, draft),
        found_colors=_colors(desk, draft),
        trial=_trial(desk),
        is_saved=(own_venues_folder() / f"{draft.name}.toml").exists(),
    )


def _measures(field: FieldSettings) -> FieldMeasures:
    goal = GoalMeasures(width_m=field.goal.width_m, depth_m=field.goal.depth_m)
    return FieldMeasures(
        goal=goal, **{name: getattr(field, name) for name in FieldMeasures.model_fields if name != "goal"}
    )


def _pattern(name: str, pattern: Pattern) -> PatternChoice:
    return PatternChoice(
        name=name,
        ids=list(pattern.code_by_id),
        radius_m=pattern.robot.radius_m,
        height_m=pattern.robot.height_m,
        outline=pattern.robot.outline,
        colors=list(pattern.code.colors),
    )


def _fields(desk: Desk) -> list[FieldTrialReport] | None:
    found = desk.fields()
    if found is None or not desk.is_of_these_pictures(found[0]):
        return None
    return [_field(trial) for trial in found[1]]


def _field(trial: FieldTrial) -> FieldTrialReport:
    camera = trial.camera
    return FieldTrialReport(
        preset=trial.preset,
        is_accepted=camera.camera is not None,
        painted=trial.painted,
        rms_px=_finite(camera.calibration.rms_px) if camera.calibration else None,
        reason=camera.reasons[0].text if camera.reasons else "",
    )


def _camera(desk: Desk, draft: Draft) -> CameraTrialReport | None:
    found = desk.camera()
    if found is None:
        return None
    of, trial = found
    return CameraTrialReport(
        is_accepted=trial.camera is not None,
        is_current=desk.is_current(of),
        is_taken=trial.camera is not None and trial.camera == draft.camera,
        by_lines=trial.calibration is not None,
        reasons=[ReasonReport(text=reason.text, advice=reason.advice) for reason in trial.reasons],
        notes=list(trial.notes),
        lines=_lines(trial),
        painted=painted_share(trial.lines),
        height_m=_finite(trial.height_m),
        is_height_unknown=trial.is_height_unknown,
        measures_m=trial.measures_m,
        **_figures(trial),
    )


def _colors(desk: Desk, draft: Draft) -> ColorTrialReport | None:
    found = desk.colors()
    if found is None:
        return None
    of, trial = found
    return ColorTrialReport(
        is_accepted=trial.is_accepted,
        is_current=desk.is_worn(of),
        is_taken=(trial.samples, trial.light) == (draft.samples, draft.light),
        paints=[PaintReport(name=paint.name, color=paint.color, patches=paint.patches) for paint in trial.paints],
        robots=trial.robots,
        with_id=trial.with_id,
        balls=trial.balls,
        reasons=[ReasonReport(text=reason.text, advice=reason.advice) for reason in trial.reasons],
    )


def _figures(trial: CameraTrial) -> dict[str, float | None]:
    found = trial.calibration
    return {
        "rms_px": _finite(found.rms_px) if found else None,
        "floor_error_mm": _finite(found.floor_error_m * 1e3) if found else None,
        "marker_error_mm": _finite(found.marker_error_m * 1e3) if found else None,
        "coverage": found.coverage if found else None,
    }


def _lines(trial: CameraTrial) -> list[LineReport]:
    return [
        LineReport(
            name=line.name,
            points_px=[point for point in line.points_px if _is_finite(point)],
            found=line.found,
            rms_px=line.rms_px,
            held_out_px=line.held_out_px,
            residuals=list(line.residuals),
        )
        for line in trial.lines
    ]


def _trial(desk: Desk) -> VenueTrialReport | None:
    found = desk.trial()
    if found is None or not desk.is_of_these_pictures(found[0]):
        return None
    of, trial = found
    return VenueTrialReport(
        is_current=desk.is_tried(of),
        pictures=[_picture(trial, index) for index in range(len(trial.pictures))],
        why_not_before=trial.why_not_before,
    )


def _picture(trial: VenueTrial, index: int) -> PictureTrialReport:
    seen = trial.pictures[index]
    return PictureTrialReport(
        robots=[SeenRobotReport(team=r.team, id=r.id, x_m=r.x_m, y_m=r.y_m) for r in seen.robots],
        read=seen.read,
        balls=seen.balls,
        obstacles=seen.obstacles,
        reasons=list(seen.reasons),
        error=seen.error,
        before=_in_words(trial.before[index]) if trial.before else "",
    )


def _in_words(seen: PictureTrial) -> str:
    return seen.error or (
        f"{_counted(len(seen.robots), 'robot')}, {seen.read} with an id, {_counted(seen.balls, 'ball')}"
    )


def _counted(number: int, thing: str) -> str:
    return f"{number} {thing}{'' if number == 1 else 's'}"


def _finite(value: float) -> float | None:
    return value if abs(value) < 1e9 else None


def _is_finite(point: Point) -> bool:
    return all(abs(value) < 1e6 for value in point)
