"""Readiness names the first broken link of the chain, in words."""

from dataclasses import replace

import pytest

from app.blackboard import FrameStamp, Readings
from app.readiness import reasons_not_ready
from vision_core.clock import Instant
from vision_core.rtdb.records import Processes, ProcessInfo, ServiceInfo, Serving, T, TaskInfo, Timed
from vision_core.settings_files import load_settings
from vision_core.types.objects import Sightings

NOW = Instant(100_000_000_000)
SEEN = Sightings("main", 7, NOW, NOW, (), (), complete=True)
RUNNING = ("capture", "perceive", "obstacles", "diagnose", "serve", "web")


def timed(value: T, age_s: float = 0.01, *, valid: bool = True) -> Timed[T]:
    """A reading of some age."""
    return Timed(value, 1, NOW, NOW, age_s, valid)


def processes(**states: tuple[str, str]) -> Timed[Processes]:
    """All processes well but for the named ones."""
    table = {"compile": ("done", ""), **dict.fromkeys(RUNNING, ("running", "")), **states}
    return timed(Processes(tuple(ProcessInfo(name, 1, state, 0, detail) for name, (state, detail) in table.items())))


@pytest.fixture(scope="module")
def well() -> Readings:
    """A service that serves."""
    service = ServiceInfo("1", Instant(0), "http://h:1", "h:2", load_settings())
    return Readings(
        now=NOW,
        service=service,
        processes=processes(),
        frame=FrameStamp(7, NOW, 0.02),
        source=None,
        sightings=timed(SEEN),
        obstacles=None,
        diagnosis=None,
        world=None,
        views=None,
        serving=timed(Serving((), 0.0, 0.0, ())),
        tasks={},
    )


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
def test_who_only_explains_is_not_waited_for(well: Readings, state: str) -> None:
    assert reasons_not_ready(replace(well, processes=processes(diagnose=(state, "ended with exit status 1")))) == ()
    without_obstacles = replace(well, processes=processes(obstacles=(state, "")))
    assert reasons_not_ready(without_obstacles) == (f"process obstacles is {state}",)


def test_no_image_hides_what_follows_from_it(well: Readings) -> None:
    readings = replace(well, frame=None, sightings=None, serving=None)
    assert reasons_not_ready(readings) == ("no image yet",)


def test_the_note_of_the_responsible_task_is_told(well: Readings) -> None:
    note = TaskInfo(1, 0, 0, 0.0, 0.0, 0.0, "camera 0; found: no such device")
    readings = replace(well, frame=None, tasks={"capture": timed(note)})
    assert reasons_not_ready(readings) == ("no image yet (camera 0; found: no such device)",)


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
