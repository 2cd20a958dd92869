"""Readiness names the first broken link of the chain, in words."""

from dataclasses import replace

import pytest

from app.web.blackboard import FrameStamp, Readings
from app.web.reports.readiness import reasons_not_ready
from tests.app.fake_readings import NOW, SEEN, processes, readings, timed, told
from vision_core.rtdb.infos import Processes, Serving
from vision_core.venues.loader import load_settings


@pytest.fixture(scope="module")
def well() -> Readings:
    """A service that serves."""
    return readings()


def test_a_service_that_serves_is_ready(well: Readings) -> None:
    assert reasons_not_ready(well) == ()


def test_an_empty_field_is_ready(well: Readings) -> None:
    """Nothing detected is for the cameras' reasons to tell, not a failure of the service."""
    assert well.sightings is not None
    assert not well.sightings.value.robots
    assert reasons_not_ready(well) == ()


@pytest.mark.parametrize("state", ["waiting", "starting", "running"])
def test_compiling_is_the_only_reason(well: Readings, state: str) -> None:
    table = processes(compile=(state, "3 of 7: label pixels"), capture=("waiting", ""), serve=("waiting", ""))
    readings = replace(well, processes=table, frame=None, sightings=None, serving=None)
    assert reasons_not_ready(readings) == ("compiling: 3 of 7: label pixels",)


def test_a_failed_compiler_is_not_called_compiling(well: Readings) -> None:
    readings = replace(well, processes=processes(compile=("disabled", "ended with exit status 1")))
    assert reasons_not_ready(readings) == ("compiling failed: ended with exit status 1",)


def test_every_broken_process_is_named(well: Readings) -> None:
    table = processes(capture=("restarting", "ended with signal SIGKILL"), perceive=("disabled", "5 ends in a minute"))
    assert reasons_not_ready(replace(well, processes=table)) == (
        "process capture is restarting: ended with signal SIGKILL",
        "process perceive is disabled: 5 ends in a minute",
    )


@pytest.mark.parametrize("state", ["starting", "restarting", "disabled"])
@pytest.mark.parametrize("name", ["diagnose", "watch", "obstacles", "spare-1"])
def test_who_only_watches_or_stands_by_is_not_waited_for(well: Readings, name: str, state: str) -> None:
    assert reasons_not_ready(replace(well, processes=processes(**{name: (state, "ended")}))) == ()


def test_the_source_of_a_simulated_camera_is_waited_for(well: Readings) -> None:
    starting = replace(well, processes=processes(source=("starting", "")))
    assert reasons_not_ready(starting) == ("process source is starting",)


def test_a_needed_task_may_share_a_process(well: Readings) -> None:
    shared = {"perceive": told("perceive", process="watch")}
    broken = replace(well, tasks=shared, processes=processes(watch=("disabled", "")))
    assert reasons_not_ready(broken) == ("process watch is disabled",)


@pytest.mark.parametrize("task", ["source", "capture", "perceive", "serve"])
def test_a_needed_task_that_is_switched_off(well: Readings, task: str) -> None:
    off = replace(well, tasks={task: told(task, enabled=False)}, frame=None, sightings=None)
    assert reasons_not_ready(off) == (f"task {task} is switched off",)
    watcher = replace(well, tasks={"lines": told("lines", enabled=False)})
    assert reasons_not_ready(watcher) == ()


def test_no_image_hides_what_follows_from_it(well: Readings) -> None:
    readings = replace(well, frame=None, sightings=None, serving=None)
    assert reasons_not_ready(readings) == ("no image yet",)


def test_the_note_of_the_responsible_task_is_told(well: Readings) -> None:
    note = "camera 0; found: no such device"
    silent = replace(well, frame=None, tasks={"capture": told("capture", note=note), "source": told("source")})
    assert reasons_not_ready(silent) == (f"no image yet ({note})",)
    cause = told("source", note="file a.png; found: nothing")
    both = replace(silent, tasks=silent.tasks | {"source": cause})
    assert reasons_not_ready(both) == ("no image yet (file a.png; found: nothing)",), "the source comes first"


def test_an_old_image_tells_its_age(well: Readings) -> None:
    readings = replace(well, frame=FrameStamp(7, NOW, 1.2), sightings=timed(SEEN, 1.2, valid=False))
    assert reasons_not_ready(readings) == ("the camera's image is 1.2 s old",)


def test_a_slow_camera_is_given_its_periods(well: Readings) -> None:
    settings = load_settings(options={"camera.rate_hz": 2.0})
    slow = replace(well, service=replace(well.service, settings=settings), frame=FrameStamp(7, NOW, 0.9))
    assert reasons_not_ready(slow) == ()
    assert reasons_not_ready(replace(slow, frame=FrameStamp(7, NOW, 1.6))) == ("the camera's image is 1.6 s old",)


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        ({"sightings": None}, "nothing was perceived yet"),
        (
            {"sightings": timed(SEEN, 2.0, valid=False)},
            "nothing is perceived: the newest sightings are 2.0 s old",
        ),
        ({"serving": None}, "clients are not served yet"),
        (
            {"serving": timed(Serving((), 0.0, 0.0, ()), 3.0, valid=False)},
            "clients have not been served for 3.0 s",
        ),
        ({"processes": None}, "the supervisor has said nothing yet"),
        (
            {"processes": timed(Processes(()), 4.0, valid=False)},
            "the supervisor has been silent for 4.0 s",
        ),
    ],
)
def test_each_broken_link(well: Readings, change: dict[str, object], reason: str) -> None:
    assert reasons_not_ready(replace(well, **change)) == (reason,)  # type: ignore[arg-type]
