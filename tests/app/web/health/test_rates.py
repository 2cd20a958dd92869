"""Rates below their limits and lags above theirs are causes of worse service."""

from dataclasses import replace

import pytest

from app.web.blackboard import ServiceSnapshot
from app.web.health.rates import MAX_LAG_S, MIN_RATE, rate_degradations
from tests.app.fake_snapshot import serving_snapshot, task_report, timed, with_records
from vision_core.rtdb.infos import SourceInfo
from vision_core.tasks.table import task_table
from vision_core.venues.loader import load_settings

PATH = ("capture", "perceive", "serve")


@pytest.fixture(scope="module")
def well() -> ServiceSnapshot:
    """A service whose tasks handle 30 pictures a second, as the venue configures."""
    return replace(serving_snapshot(), tasks={name: task_report(name) for name in PATH})


def sentences(snapshot: ServiceSnapshot) -> list[str]:
    return [cause.sentence for cause in rate_degradations(snapshot)]


def with_rates(snapshot: ServiceSnapshot, **rates_hz: float) -> ServiceSnapshot:
    """The snapshot with other rates of some tasks [1/s]."""
    changed = {name: task_report(name, rate_hz=rate_hz) for name, rate_hz in rates_hz.items()}
    return replace(snapshot, tasks={**snapshot.tasks, **changed})


def played(snapshot: ServiceSnapshot, rate_hz: float) -> ServiceSnapshot:
    """The snapshot with a recording of some rate [1/s] as source."""
    return with_records(snapshot, source=timed(SourceInfo("file:a.avi", "video a.avi", True, rate_hz)))


def test_full_rates_are_no_cause(well: ServiceSnapshot) -> None:
    assert sentences(well) == []


def test_tasks_that_have_not_reported_are_no_cause(well: ServiceSnapshot) -> None:
    assert sentences(replace(well, tasks={})) == []
    late = timed(task_report("capture", rate_hz=9.0).value, 3.0, valid=False)
    assert sentences(replace(well, tasks={"capture": late})) == []


def test_a_camera_that_delivers_less_than_configured(well: ServiceSnapshot) -> None:
    slow = with_rates(well, capture=9.0, perceive=9.0, serve=9.0)
    assert sentences(slow) == ["the camera delivers 9.0 of 30 pictures a second"]
    limit_hz = MIN_RATE * 30.0
    assert sentences(with_rates(well, capture=limit_hz, perceive=limit_hz, serve=limit_hz)) == []


def test_a_camera_that_promises_less_than_configured_is_compared_with_the_venue(well: ServiceSnapshot) -> None:
    camera = with_records(well, source=timed(SourceInfo("camera:0", "camera 0", False, 15.0)))
    slow = with_rates(camera, capture=15.0, perceive=15.0, serve=15.0)
    assert sentences(slow) == ["the camera delivers 15.0 of 30 pictures a second"]


def test_a_recording_is_compared_with_its_own_rate(well: ServiceSnapshot) -> None:
    recording = with_rates(played(well, 15.0), capture=15.0, perceive=15.0, serve=15.0)
    assert sentences(recording) == []


@pytest.mark.parametrize(
    ("rates_hz", "task"),
    [
        ({"perceive": 12.0, "serve": 12.0}, "perceive"),
        ({"serve": 12.0}, "serve"),
    ],
)
def test_the_first_task_that_skips_pictures_is_named(
    well: ServiceSnapshot, rates_hz: dict[str, float], task: str
) -> None:
    assert sentences(with_rates(well, **rates_hz)) == [
        f"only 12.0 of 30.0 pictures a second reach the robots: task {task} runs too rarely"
    ]


def test_a_slow_source_is_measured_to_one_run_in_five_seconds(well: ServiceSnapshot) -> None:
    counted = with_rates(played(well, 0.5), capture=0.6, perceive=0.4, serve=0.4)
    assert all("pictures a second" not in sentence for sentence in sentences(counted))


def test_a_task_that_the_venue_slows_is_no_cause(well: ServiceSnapshot) -> None:
    venue = load_settings(options={"tasks.serve.period_ms": 100.0})
    slowed = replace(
        with_rates(well, serve=10.0), service=replace(well.service, settings=venue, tasks=task_table(venue))
    )
    assert sentences(slowed) == []
    assert len(sentences(with_rates(slowed, serve=5.0))) == 1


def test_a_lag_over_the_limit(well: ServiceSnapshot) -> None:
    tasks = {
        "perceive": task_report("perceive", response_median_ms=40.0),
        "serve": task_report("serve", response_median_ms=1e3 * MAX_LAG_S - 40.0),
    }
    assert sentences(replace(well, tasks={**well.tasks, **tasks})) == []
    tasks["serve"] = task_report("serve", response_median_ms=12.0)
    assert sentences(replace(well, tasks={**well.tasks, **tasks})) == [
        "views are sent 52 ms after their picture, at most 50 are good: perception and serving take too long"
    ]


@pytest.mark.parametrize(("rate_hz", "is_slow"), [(0.5, True), (3.9, True), (4.0, False), (30.0, False)])
def test_a_source_whose_pictures_are_farther_apart_than_robots_are_remembered(
    well: ServiceSnapshot, rate_hz: float, is_slow: bool
) -> None:
    source = with_rates(played(well, rate_hz), capture=rate_hz, perceive=rate_hz, serve=rate_hz)
    period = f"{1.0 / rate_hz:.3g}"
    hint = f"the source delivers a picture every {period} s: robots are forgotten after 0.25 s between two pictures"
    assert sentences(source) == ([hint] if is_slow else [])
