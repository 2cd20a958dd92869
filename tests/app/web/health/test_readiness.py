"""Readiness reports the first broken link of the chain."""

from dataclasses import replace
from typing import Any

import pytest

from app.web.blackboard import FrameStamp, ServiceSnapshot
from app.web.health.readiness import is_starting
from app.web.health.readiness import reasons_not_ready as causes_not_ready
from tests.app.fake_snapshot import (
    EMPTY_FIELD,
    NOW,
    SEEN,
    processes,
    serving_snapshot,
    task_report,
    timed,
    with_records,
)
from vision_core.rtdb.infos import Processes, Serving, TaskOverride
from vision_core.rtdb.items import Timed
from vision_core.tasks.table import task_table
from vision_core.venues.loader import load_settings


@pytest.fixture(scope="module")
def well() -> ServiceSnapshot:
    """A service that serves."""
    return serving_snapshot()


def reasons_not_ready(snapshot: ServiceSnapshot) -> tuple[str, ...]:
    """The sentences of the reasons."""
    return tuple(cause.sentence for cause in causes_not_ready(snapshot))


def test_a_service_that_serves_is_ready(well: ServiceSnapshot) -> None:
    assert reasons_not_ready(well) == ()


def test_an_empty_field_is_ready(well: ServiceSnapshot) -> None:
    """A service that detects nothing is degraded, but it serves."""
    assert reasons_not_ready(with_records(well, sightings=timed(EMPTY_FIELD))) == ()


@pytest.mark.parametrize("state", ["waiting", "starting", "running"])
def test_compiling_is_the_only_reason(well: ServiceSnapshot, state: str) -> None:
    table = processes(compile=(state, "3 of 7: label pixels"), capture=("waiting", ""), serve=("waiting", ""))
    snapshot = with_records(replace(well, frame=None), processes=table, sightings=None, serving=None)
    assert reasons_not_ready(snapshot) == ("compiling: 3 of 7: label pixels",)


def test_a_failed_compiler_is_not_called_compiling(well: ServiceSnapshot) -> None:
    snapshot = with_records(well, processes=processes(compile=("disabled", "ended with exit status 1")))
    assert reasons_not_ready(snapshot) == ("compiling failed: ended with exit status 1",)


def test_every_broken_process_is_named(well: ServiceSnapshot) -> None:
    table = processes(capture=("restarting", "ended with signal SIGKILL"), perceive=("disabled", "5 ends in a minute"))
    assert reasons_not_ready(with_records(well, processes=table)) == (
        "process capture is restarting: ended with signal SIGKILL",
        "process perceive is disabled: 5 ends in a minute",
    )


@pytest.mark.parametrize("state", ["starting", "restarting", "disabled"])
@pytest.mark.parametrize("name", ["diagnose", "watch", "obstacles", "spare-1"])
def test_readiness_does_not_wait_for_watchers_and_spares(well: ServiceSnapshot, name: str, state: str) -> None:
    assert reasons_not_ready(with_records(well, processes=processes(**{name: (state, "ended")}))) == ()


def test_the_source_of_a_simulated_camera_is_waited_for(well: ServiceSnapshot) -> None:
    starting = with_records(well, processes=processes(source=("starting", "")))
    assert reasons_not_ready(starting) == ("process source is starting",)


def test_a_needed_task_may_share_a_process(well: ServiceSnapshot) -> None:
    tasks = task_table(load_settings(options={"tasks.perceive.process": "watch"}))
    broken = with_records(
        replace(well, service=replace(well.service, tasks=tasks)), processes=processes(watch=("disabled", ""))
    )
    assert reasons_not_ready(broken) == ("process watch is disabled",)


@pytest.mark.parametrize("task", ["source", "capture", "perceive", "serve"])
def test_a_needed_task_that_is_switched_off(well: ServiceSnapshot, task: str) -> None:
    blind = with_records(replace(well, frame=None), sightings=None)
    off = replace(blind, tasks={task: task_report(task, TaskOverride(enabled=False))})
    assert reasons_not_ready(off) == (f"task {task} is switched off",)
    watcher = replace(well, tasks={"lines": task_report("lines", TaskOverride(enabled=False))})
    assert reasons_not_ready(watcher) == ()


def test_no_image_hides_what_follows_from_it(well: ServiceSnapshot) -> None:
    snapshot = with_records(replace(well, frame=None), sightings=None, serving=None)
    assert reasons_not_ready(snapshot) == ("no image yet",)


def test_the_note_of_the_responsible_task_is_the_cause(well: ServiceSnapshot) -> None:
    note = "camera 0; found: no such device"
    silent = replace(
        well, frame=None, tasks={"capture": task_report("capture", note=note), "source": task_report("source")}
    )
    assert reasons_not_ready(silent) == (f"no image yet ({note})",)
    cause = task_report("source", note="file a.png; found: nothing")
    both = replace(silent, tasks={**silent.tasks, "source": cause})
    assert reasons_not_ready(both) == ("no image yet (file a.png; found: nothing)",), "the source comes first"


def test_the_age_of_an_old_image_is_reported(well: ServiceSnapshot) -> None:
    old = replace(well, frame=FrameStamp(7, NOW, 1.2))
    snapshot = with_records(old, sightings=timed(SEEN, 1.2, valid=False))
    assert reasons_not_ready(snapshot) == ("the camera's image is 1.2 s old",)


def test_a_slow_camera_is_given_its_periods(well: ServiceSnapshot) -> None:
    settings = load_settings(options={"camera.rate_hz": 2.0})
    slow = replace(well, service=replace(well.service, settings=settings), frame=FrameStamp(7, NOW, 0.9))
    assert reasons_not_ready(slow) == ()
    assert reasons_not_ready(replace(slow, frame=FrameStamp(7, NOW, 1.6))) == ("the camera's image is 1.6 s old",)


@pytest.mark.parametrize(("rate_hz", "longest_s"), [(30.0, 0.25), (9.0, 0.33), (3.2, 0.93), (0.4, 1.0), (0.0, 0.25)])
def test_a_camera_that_has_become_slow_is_given_its_periods_up_to_a_second(
    well: ServiceSnapshot, rate_hz: float, longest_s: float
) -> None:
    slow = replace(well, tasks={"capture": task_report("capture", rate_hz=rate_hz)})
    assert reasons_not_ready(replace(slow, frame=FrameStamp(7, NOW, longest_s))) == ()
    assert reasons_not_ready(replace(slow, frame=FrameStamp(7, NOW, longest_s + 0.1))) != ()


@pytest.mark.parametrize(
    ("states", "starting"),
    [
        ({}, False),
        ({"compile": ("running", "3 of 7")}, True),
        ({"capture": ("waiting", "")}, True),
        ({"serve": ("starting", "")}, True),
        ({"serve": ("disabled", "")}, False),
        ({"diagnose": ("starting", "")}, False),
    ],
)
def test_a_start_is_told_from_a_failure(
    well: ServiceSnapshot, states: dict[str, tuple[str, str]], starting: bool
) -> None:
    assert is_starting(with_records(well, processes=processes(**states))) is starting


def test_a_service_without_a_supervisors_report_is_starting(well: ServiceSnapshot) -> None:
    assert is_starting(with_records(well, processes=None))


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        ({"sightings": None}, "no image has been analyzed yet"),
        (
            {"sightings": timed(SEEN, 2.0, valid=False)},
            "no image has been analyzed for 2.0 s",
        ),
        ({"serving": None}, "clients are not served yet"),
        (
            {"serving": timed(Serving((), 0.0, 0.0, ()), 3.0, valid=False)},
            "clients have not been served for 3.0 s",
        ),
        ({"processes": None}, "the supervisor has not reported yet"),
        (
            {"processes": timed(Processes(()), 4.0, valid=False)},
            "the supervisor has not reported for 4.0 s",
        ),
    ],
)
def test_each_broken_link(well: ServiceSnapshot, change: dict[str, Timed[Any] | None], reason: str) -> None:
    assert reasons_not_ready(with_records(well, **change)) == (reason,)
