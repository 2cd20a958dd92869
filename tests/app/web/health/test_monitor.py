"""The state of the service: ready, degraded, not ready."""

from dataclasses import replace

import pytest

from app.web.blackboard import ServiceSnapshot
from app.web.health.monitor import HealthMonitor, HealthState
from app.web.health.rates import RATE_HOLD_S
from tests.app.fake_snapshot import processes, serving_snapshot, task_report, with_records
from vision_core.clock import after


@pytest.fixture
def well() -> ServiceSnapshot:
    """A service that serves."""
    return serving_snapshot()


def later(snapshot: ServiceSnapshot, seconds: float) -> ServiceSnapshot:
    """The same records, read later."""
    return replace(snapshot, now=after(snapshot.now, seconds))


def test_a_service_that_serves_is_ready(well: ServiceSnapshot) -> None:
    health = HealthMonitor().judge(well)
    assert (health.state, health.is_ready, health.causes) == (HealthState.READY, True, ())


def test_a_slow_camera_degrades_the_service_when_it_lasts(well: ServiceSnapshot) -> None:
    monitor = HealthMonitor()
    slow = replace(well, tasks={"capture": task_report("capture", rate_hz=9.0)})
    assert monitor.judge(slow).state is HealthState.READY
    for at_s in (2.0, 4.0):
        assert monitor.judge(later(slow, at_s)).state is HealthState.READY
    health = monitor.judge(later(slow, RATE_HOLD_S))
    assert (health.state, health.is_ready) == (HealthState.DEGRADED, True)
    assert [cause.sentence for cause in health.causes] == ["the camera delivers 9.0 of 30 pictures a second"]


def test_what_follows_from_not_being_ready_is_not_listed(well: ServiceSnapshot) -> None:
    monitor = HealthMonitor()
    slow = replace(well, tasks={"capture": task_report("capture", rate_hz=9.0)})
    monitor.judge(slow)
    broken = with_records(slow, processes=processes(serve=("disabled", ""), watch=("disabled", "")))
    health = monitor.judge(later(broken, RATE_HOLD_S))
    assert (health.state, health.reasons[0].text) == (HealthState.NOT_READY, "process serve is disabled")
    assert [cause.key for cause in health.degradations] == ["process watch disabled"]
    assert monitor.judge(later(slow, 2 * RATE_HOLD_S)).state is HealthState.READY, "the rate has to last anew"


def test_a_short_gap_leaves_what_was_reported(well: ServiceSnapshot) -> None:
    monitor = HealthMonitor()
    slow = replace(well, tasks={"capture": task_report("capture", rate_hz=9.0)})
    for at_s in (0.0, 2.0, 4.0, RATE_HOLD_S):
        monitor.judge(later(slow, at_s))
    gap = replace(slow, frame=None)
    assert monitor.judge(later(gap, RATE_HOLD_S + 1.0)).state is HealthState.NOT_READY
    assert monitor.judge(later(slow, RATE_HOLD_S + 2.0)).state is HealthState.DEGRADED


def test_a_cause_says_since_when_it_is_reported_and_when_it_was_first(well: ServiceSnapshot) -> None:
    monitor, off = HealthMonitor(), with_records(well, processes=processes(watch=("disabled", "")))
    (key,) = [cause.key for cause in monitor.judge(off).causes]
    assert monitor.judge(later(off, 4.0)).seen[key].since == off.now
    assert monitor.judge(later(well, 5.0)).seen == {}
    again = monitor.judge(later(off, 9.0)).seen[key]
    assert (again.first, again.since) == (off.now, after(off.now, 9.0))
