"""When an ended process is started again, and when a silent one hangs."""

from types import SimpleNamespace
from typing import Any

import pytest

from app.supervisor.child import CRASHES_TO_DISABLE, FIRST_DELAY_S, STEADY_S, Child
from app.supervisor.plan import ChildPlan
from vision_core.clock import NS_PER_S

PLAN = ChildPlan("one", "nothing", (), (), (), after_compile=False, once=False, heartbeat_s=0.3, longest_run_s=1.0)


def child() -> Child:
    nothing: Any = None
    return Child(PLAN, nothing, nothing)


def ended(one: Child, lived_s: float, at_s: float) -> float:
    """Let it live for so long and be killed; how long it then waits [s]."""
    now = round(at_s * NS_PER_S)
    process: Any = SimpleNamespace(returncode=-9, stdin=None, stdout=None)
    one.process, one.started = process, now - round(lived_s * NS_PER_S)
    one.reap(now)
    return (one.due - now) / NS_PER_S


def test_what_has_lived_is_replaced_at_once_however_often() -> None:
    one = child()
    assert [ended(one, STEADY_S, 10.0 * number) for number in range(1, CRASHES_TO_DISABLE)] == [0.0] * 4
    assert one.state == "restarting"


def test_what_falls_again_and_again_waits_twice_as_long_each_time_and_is_disabled() -> None:
    one = child()
    waits = [ended(one, 1.0, 100.0 + number) for number in range(CRASHES_TO_DISABLE - 1)]
    assert waits == [0.0, FIRST_DELAY_S, 2 * FIRST_DELAY_S, 4 * FIRST_DELAY_S]
    ended(one, 1.0, 110.0)
    assert one.state == "disabled"


def test_a_minute_later_all_is_forgiven() -> None:
    one = child()
    for number in range(CRASHES_TO_DISABLE - 1):
        ended(one, 1.0, 100.0 + number)
    assert ended(one, STEADY_S, 200.0) == 0.0
    assert one.state == "restarting"


@pytest.mark.parametrize(("last_heartbeat", "watched", "expected"), [(5, 1, 5), (5, 7, 7), (0, 1, 4)])
def test_a_silence_begins_with_the_beat_the_start_or_when_somebody_watched(
    last_heartbeat: int, watched: int, expected: int
) -> None:
    one = child()
    process: Any = SimpleNamespace(pid=1)
    one.process, one.started, one.last_heartbeat, one.patience_s = process, 4, last_heartbeat, PLAN.heartbeat_s
    assert one.overdue_at(watched) == expected + round(PLAN.heartbeat_s * NS_PER_S)
    one.killed = True
    assert one.overdue_at(watched) is None
