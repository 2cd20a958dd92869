"""Slow causes of worse service: fewer pictures than configured, tasks that skip pictures, views that are late."""

from collections.abc import Iterator

from app.web.blackboard import ServiceSnapshot
from app.web.health.cause import Cause, Subject
from app.web.health.frame_path import frame_path
from vision_core.clock import MS_PER_S
from vision_core.rtdb import records
from vision_core.rtdb.task import Task
from vision_core.timing.running_rate import WINDOW_S

MIN_RATE = 0.9
"""Share of the expected rate below which pictures are missing. Jitter and a dropped picture now and then cost less
than 1 %; a camera that falls back to its next lower mode delivers 25 of 30 pictures or fewer."""
RATE_ERROR_HZ = 2.0 / WINDOW_S
"""A rate is a number of runs over the last 5 s; two of them differ by one run each when they are the same."""
RATE_HOLD_S = WINDOW_S + 1.0
"""A gap that is over still lowers a rate for 5 s."""
MAX_LAG_S = 0.05
"""From the publication of a picture to its last datagram. A robot that drives 2 m/s moves by its radius, 0.1 m, in this
time; perception and serving together need less than 5 ms on an idle machine."""
LAG_HOLD_S = 3.0
"""One slow half second, as when a process is replaced, is no degradation."""


def rate_degradations(snapshot: ServiceSnapshot) -> Iterator[Cause]:
    """Everything that makes views rarer or later than the source's pictures allow."""
    yield from _slow_source(snapshot)
    yield from _rates(snapshot)
    yield from _lag(snapshot)


def _slow_source(snapshot: ServiceSnapshot) -> Iterator[Cause]:
    """A source whose pictures are farther apart than robots are remembered."""
    validity_s = snapshot.service.settings.tracks.validity_ms / MS_PER_S
    source = snapshot.of(records.source)
    rate_hz = source.value.rate_hz if source else snapshot.camera.rate_hz
    if rate_hz * validity_s < 1.0:
        delivers = f"the source delivers a picture every {1.0 / rate_hz:.3g} s"
        forgotten = f"robots are forgotten after {validity_s:g} s between two pictures"
        advice = "Choose a source of a higher rate, or raise tracks.validity_ms on the settings page."
        yield Cause("slow source", Subject.CAMERA, f"{delivers}: {forgotten}", advice)


def _rates(snapshot: ServiceSnapshot) -> Iterator[Cause]:
    """The first task of the frame's path that runs too rarely: later ones run rarely because of it."""
    expected_hz = _expected_hz(snapshot)
    camera, *following = frame_path(snapshot)
    measured_hz = _rate_hz(snapshot, camera)
    if measured_hz is None:
        return
    if _is_below(measured_hz, expected_hz):
        delivers = f"the camera delivers {measured_hz:.1f} of {expected_hz:g} pictures a second"
        advice = "Give the camera more light and a fast USB port of its own, or set camera.rate_hz to what it delivers."
        yield Cause("camera rate", Subject.CAMERA, delivers, advice, hold_s=RATE_HOLD_S)
    for task in following:
        wanted_hz = task.rate_hz(measured_hz)
        rate_hz = _rate_hz(snapshot, task)
        if rate_hz is not None and _is_below(rate_hz, wanted_hz):
            used = f"only {rate_hz:.1f} of {wanted_hz:.1f} pictures a second reach the robots"
            advice = "Close other programs on this computer, or let the watchers run less often on the timing page."
            detail = f"task {task.name} runs too rarely"
            yield Cause("task rate", Subject.LAG, used, advice, detail, RATE_HOLD_S)
            return


def _is_below(rate_hz: float, expected_hz: float) -> bool:
    """Is a measured rate below the accepted share of another, beyond the error of measurement?"""
    return rate_hz < MIN_RATE * expected_hz - RATE_ERROR_HZ


def _expected_hz(snapshot: ServiceSnapshot) -> float:
    """Pictures per second that the source has to deliver [1/s].

    A recording is played at its own rate; a camera has to deliver the rate that the venue configures.
    """
    source = snapshot.of(records.source)
    return source.value.rate_hz if source and source.value.repeats else snapshot.camera.rate_hz


def _rate_hz(snapshot: ServiceSnapshot, task: Task) -> float | None:
    """Runs per second of a task [1/s]; None while it does not report."""
    timed = snapshot.tasks.get(task.name)
    return timed.value.rate_hz if timed and timed.valid else None


def _lag(snapshot: ServiceSnapshot) -> Iterator[Cause]:
    """The tasks after the camera's follow each other, so their response times add up."""
    following = frame_path(snapshot)[1:]
    reports = [timed for task in following if (timed := snapshot.tasks.get(task.name)) and timed.valid]
    lag_s = sum(timed.value.response_median_ms for timed in reports) / MS_PER_S
    if lag_s > MAX_LAG_S:
        text = (
            f"views are sent {lag_s * MS_PER_S:.0f} ms after their picture, at most {MAX_LAG_S * MS_PER_S:.0f} are good"
        )
        advice = "Close other programs on this computer, or let the watchers run less often on the timing page."
        yield Cause("lag", Subject.LAG, text, advice, "perception and serving take too long", LAG_HOLD_S)
