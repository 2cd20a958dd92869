"""Causes of worse service that the pictures show: no robot, bad light, a camera that was moved."""

from collections.abc import Iterator

from app.web.blackboard import ServiceSnapshot
from app.web.health.cause import Cause, Subject
from vision_core.rtdb import records

NO_ROBOT_HOLD_S = 5.0
"""Robots are taken off the field for a moment in every match."""
LIGHT_HOLD_S = 2.0
"""Several looks of the exposure check, which looks five times a second: a person under the camera passes."""
MOVED_HOLD_S = 5.0
"""A dozen looks of the line check: robots and people hide lines for a moment."""
MOVED = "the camera was moved, or the venue does not fit the field"
MIN_LINES_FOUND = 0.3
"""Share of the painted lines that must be where the venue has them; some fields lack some of their preset's lines."""
MAX_LINE_OFF_PX = 2.0
"""Median distance of painted lines from their place [px]. A good calibration leaves 0.5 px."""
MAX_BOUNDARY_OFF_PX = 8.0
"""The same for the carpet's boundary, which is judged only where no line can be: carpets are laid by hand."""
MIN_BOUNDARY_FOUND = 0.5
"""Share of the boundary that must be seen to judge by it."""


def sighting_degradations(snapshot: ServiceSnapshot) -> Iterator[Cause]:
    """What the newest sightings and checks of the picture report."""
    yield from _no_robot(snapshot)
    light = list(_light(snapshot))
    yield from light or _moved(snapshot)  # in bad light no line is found where it is


def _no_robot(snapshot: ServiceSnapshot) -> Iterator[Cause]:
    """Every venue expects robots: a match has at least one number a team."""
    sightings, diagnosis = snapshot.of(records.sightings), snapshot.recent(records.diagnosis)
    if sightings and not sightings.value.robots:
        explained = diagnosis.value.reasons if diagnosis else ()
        why, advice = "", "Put robots on the field; if there are some, see what the camera page shows of them."
        if explained:
            why, advice = explained[0].text, explained[0].advice
        yield Cause("no robot", Subject.CAMERA, "no robot is seen", advice, why, NO_ROBOT_HOLD_S)


def _light(snapshot: ServiceSnapshot) -> Iterator[Cause]:
    exposure = snapshot.recent(records.exposure)
    for reason in exposure.value.found.reasons if exposure else ():
        yield Cause("light", Subject.CAMERA, reason.text, reason.advice, hold_s=LIGHT_HOLD_S)


def _moved(snapshot: ServiceSnapshot) -> Iterator[Cause]:
    """What is wrong with the calibration: by the reasons of the checks, which say where and by how much, or by figures.

    Painted lines, or where none can be judged the carpet's boundary, are not where the venue has them.
    """
    line_check, boundary_check = snapshot.recent(records.lines), snapshot.recent(records.boundary)
    lines = line_check.value.found if line_check else None
    boundary = boundary_check.value.found if boundary_check else None
    diagnosis = snapshot.recent(records.diagnosis)
    explained = [reason for reason in diagnosis.value.reasons if reason.is_calibration] if diagnosis else []
    if reason := next(iter((*explained, *(lines.reasons if lines else ()))), None):
        yield Cause("camera moved", Subject.CAMERA, reason.text, reason.advice, hold_s=MOVED_HOLD_S)
    elif lines and lines.known:
        if lines.found < MIN_LINES_FOUND * lines.known:
            found = f"{lines.found} of {lines.known} painted lines are where the venue has them"
            yield _camera_moved(found)
        elif lines.residual_px is not None and lines.residual_px > MAX_LINE_OFF_PX:
            yield _camera_moved(f"painted lines are {lines.residual_px:.1f} px from their place")
    elif boundary and boundary.found >= MIN_BOUNDARY_FOUND and (boundary.off_px or 0.0) > MAX_BOUNDARY_OFF_PX:
        yield _camera_moved(f"the carpet ends {boundary.off_px:.1f} px from where the venue has its end")


def _camera_moved(evidence: str) -> Cause:
    advice = "Put the camera back or calibrate it anew; on another field choose its venue."
    return Cause("camera moved", Subject.CAMERA, MOVED, advice, evidence, MOVED_HOLD_S)
