"""A field without robots, bad light and a camera that was moved are causes of worse service."""

import pytest

from app.web.blackboard import ServiceSnapshot
from app.web.health.cause import Cause
from app.web.health.sightings import MAX_BOUNDARY_OFF_PX, MAX_LINE_OFF_PX, NO_ROBOT_HOLD_S, sighting_degradations
from tests.app.fake_snapshot import EMPTY_FIELD, NOW, serving_snapshot, timed, with_records
from vision_core.types.objects import Diagnosis
from vision_core.types.reasons import Reason
from vision_core.types.regions import ExposureCheck, FieldBoundary, Finding, LineCheck

MOVED = "the camera was moved, or the venue does not fit the field"
WELL = LineCheck(12, 11, 0.97, 0.4, 0.0)
AT_PLACE = FieldBoundary((), (), 0.94, 0.3, 0.6)


def snapshot(
    lines: LineCheck | None = WELL,
    boundary: FieldBoundary | None = AT_PLACE,
    reasons: tuple[str, ...] = (),
    *,
    valid: bool = True,
) -> ServiceSnapshot:
    """What the checks found in one picture; reasons: of the exposure check; valid: the checks are recent."""
    exposure = ExposureCheck(231.0, 88.0, 0.001, tuple(Reason(text, "Do it.") for text in reasons))
    return with_records(
        serving_snapshot(),
        lines=timed(Finding("main", 7, NOW, lines), valid=valid) if lines else None,
        boundary=timed(Finding("main", 7, NOW, boundary), valid=valid) if boundary else None,
        exposure=timed(Finding("main", 7, NOW, exposure), valid=valid),
    )


def causes(of: ServiceSnapshot) -> list[Cause]:
    return list(sighting_degradations(of))


def test_a_picture_in_order_is_no_cause() -> None:
    assert causes(snapshot()) == []
    assert causes(serving_snapshot()) == [], "no check has looked yet"


def test_no_robot_is_a_cause_when_it_lasts_and_says_why() -> None:
    empty = with_records(snapshot(), sightings=timed(EMPTY_FIELD))
    (cause,) = causes(empty)
    assert (cause.sentence, cause.hold_s) == ("no robot is seen", NO_ROBOT_HOLD_S)
    dark = Diagnosis("main", 7, NOW, (Reason("too dark: lamps?", "Switch them on."), Reason("and more", "Do it.")))
    (cause,) = causes(with_records(empty, diagnosis=timed(dark)))
    assert (cause.sentence, cause.advice) == ("no robot is seen: too dark: lamps?", "Switch them on.")


def test_bad_light_is_reported_in_the_words_of_the_check() -> None:
    assert [cause.sentence for cause in causes(snapshot(reasons=("over-exposed: 60 %",)))] == ["over-exposed: 60 %"]


@pytest.mark.parametrize(
    ("lines", "boundary", "evidence"),
    [
        (LineCheck(12, 3, 0.3, 0.4, 0.0), AT_PLACE, "3 of 12 painted lines are where the venue has them"),
        (LineCheck(12, 4, 0.3, MAX_LINE_OFF_PX, 0.0), AT_PLACE, None),
        (LineCheck(12, 11, 0.9, 2.6, 0.0), AT_PLACE, "painted lines are 2.6 px from their place"),
        (LineCheck(12, 0, 0.0, None, 0.0), AT_PLACE, "0 of 12 painted lines are where the venue has them"),
        (WELL, FieldBoundary((), (), 0.9, 0.3, 30.0), None),
        (LineCheck(0, 0, None, None, 0.0), FieldBoundary((), (), 0.9, 0.3, MAX_BOUNDARY_OFF_PX), None),
        (
            LineCheck(0, 0, None, None, 0.0),
            FieldBoundary((), (), 0.9, 0.3, 12.0),
            "the carpet ends 12.0 px from where the venue has its end",
        ),
        (None, FieldBoundary((), (), 0.9, 0.3, 12.0), "the carpet ends 12.0 px from where the venue has its end"),
        (None, FieldBoundary((), (), 0.4, 0.3, 12.0), None),
        (None, FieldBoundary((), (), 0.4, None, None), None),
    ],
)
def test_a_camera_that_was_moved(lines: LineCheck | None, boundary: FieldBoundary | None, evidence: str | None) -> None:
    assert [cause.sentence for cause in causes(snapshot(lines, boundary))] == (
        [] if evidence is None else [f"{MOVED}: {evidence}"]
    )


def test_where_a_calibration_is_wrong_is_said_before_figures() -> None:
    corner = Reason("corner left top lies 15 px to the left", "Move it.", is_calibration=True)
    off = snapshot(LineCheck(12, 8, 0.7, 1.6, 0.0, (corner,)))
    (cause,) = causes(off)
    assert (cause.sentence, cause.advice) == (corner.text, "Move it.")
    mirrored = Reason("this picture is a mirror image", "Turn it.", 6.0, is_calibration=True)
    other = Reason("no ball", "Lay one.")
    (cause,) = causes(with_records(off, diagnosis=timed(Diagnosis("main", 7, NOW, (other, mirrored)))))
    assert (cause.sentence, cause.advice) == (mirrored.text, "Turn it.")
    assert causes(with_records(snapshot(), diagnosis=timed(Diagnosis("main", 7, NOW, (other,))))) == []


def test_old_findings_are_no_cause() -> None:
    off = LineCheck(12, 0, 0.0, None, 0.0)
    assert len(causes(snapshot(off))) == 1
    assert causes(snapshot(off, valid=False)) == []


def test_bad_light_hides_lines_of_a_camera_that_stands() -> None:
    off = LineCheck(12, 0, 0.0, None, 0.0)
    assert [cause.key for cause in causes(snapshot(off, reasons=("the picture is black",)))] == ["light"]
