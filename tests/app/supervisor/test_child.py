"""When a process that has ended is started again, when it is disabled, and when a heartbeat is overdue."""

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import pytest

from app.supervisor.child import CRASHES_TO_DISABLE, FIRST_DELAY_S, MAX_DELAY_S, STEADY_S, Child
from app.supervisor.lifecycle import TRANSITIONS, Change, next_state
from app.supervisor.plan import ChildPlan
from vision_core.clock import NS_PER_S
from vision_core.rtdb.process_state import ProcessState

PLAN = ChildPlan("one", "nothing", (), (), (), after="", once=False, heartbeat_s=0.3, longest_run_s=1.0)
REAL_TIME = replace(PLAN, real_time=True)


def child(plan: ChildPlan = PLAN) -> Child:
    nothing: Any = None
    return Child(plan, nothing, nothing)


def ended(one: Child, lived_s: float, at_s: float, *, killed: bool = False) -> float:
    """Let it run for some time and end by SIGKILL, as a hung process if killed. Returns the delay of its next start."""
    now = round(at_s * NS_PER_S)
    process: Any = SimpleNamespace(returncode=-9, stdin=None, stdout=None)
    one.process, one.started, one.state = process, now - round(lived_s * NS_PER_S), ProcessState.RUNNING
    one.killed = killed
    one.reap(now)
    return (one.due - now) / NS_PER_S


def test_a_process_that_ran_for_a_while_is_started_again_at_once() -> None:
    one = child()
    assert [ended(one, STEADY_S, 10.0 * number) for number in range(1, CRASHES_TO_DISABLE)] == [0.0] * 4
    assert one.state == ProcessState.RESTARTING


def test_repeated_crashes_double_the_delay_and_disable_the_process() -> None:
    one = child()
    waits = [ended(one, 1.0, 100.0 + number) for number in range(CRASHES_TO_DISABLE - 1)]
    assert waits == [0.0, FIRST_DELAY_S, 2 * FIRST_DELAY_S, 4 * FIRST_DELAY_S]
    ended(one, 1.0, 110.0)
    assert one.state == ProcessState.DISABLED
    assert one.detail == "5 crashes within a minute; the last time it ended with signal SIGKILL"


def test_crashes_of_more_than_a_minute_ago_do_not_count() -> None:
    one = child()
    for number in range(CRASHES_TO_DISABLE - 1):
        ended(one, 1.0, 100.0 + number)
    assert ended(one, STEADY_S, 200.0) == 0.0
    assert one.state == ProcessState.RESTARTING


def test_an_ordinary_process_is_not_disabled_for_being_killed_as_hung_but_waits_longer_each_time() -> None:
    one = child()
    waits = [ended(one, 1.0, 100.0 + number, killed=True) for number in range(4 * CRASHES_TO_DISABLE)]
    assert one.state == ProcessState.RESTARTING
    assert waits[:3] == [0.0, FIRST_DELAY_S, 2 * FIRST_DELAY_S]
    assert waits[-1] == MAX_DELAY_S
    assert one.detail == "was killed because it did not answer"


def test_a_real_time_process_is_disabled_for_being_killed_as_hung() -> None:
    one = child(REAL_TIME)
    for number in range(CRASHES_TO_DISABLE):
        ended(one, STEADY_S, 100.0 + number, killed=True)
    assert one.state == ProcessState.DISABLED


def test_a_disabled_process_that_is_enabled_again_starts_at_once_with_its_crashes_forgotten() -> None:
    one = child()
    for number in range(CRASHES_TO_DISABLE):
        ended(one, 1.0, 100.0 + number)
    one.re_enable(200 * NS_PER_S)
    assert (one.state, one.due, one.crashes) == (ProcessState.RESTARTING, 200 * NS_PER_S, [])


def test_every_transition_that_the_table_lacks_raises() -> None:
    for state in ProcessState:
        for change in Change:
            if (state, change) in TRANSITIONS:
                assert next_state(state, change) == TRANSITIONS[state, change]
            else:
                with pytest.raises(ValueError, match=f"a process that is {state}: {change} was found"):
                    next_state(state, change)


def test_every_state_is_reached_from_waiting() -> None:
    reached = {ProcessState.WAITING}
    for _ in ProcessState:
        reached |= {after for (state, _), after in TRANSITIONS.items() if state in reached}
    assert reached == set(ProcessState)


def test_a_disabled_process_cannot_crash() -> None:
    one = child()
    for number in range(CRASHES_TO_DISABLE):
        ended(one, 1.0, 100.0 + number)
    with pytest.raises(ValueError, match="disabled"):
        one._crashed(200 * NS_PER_S, "ended")


@pytest.mark.parametrize(("last_heartbeat", "watched", "expected"), [(5, 1, 5), (5, 7, 7), (0, 1, 4)])
def test_a_heartbeat_is_expected_from_the_last_one_the_start_or_the_first_turn_in_time(
    last_heartbeat: int, watched: int, expected: int
) -> None:
    one = child()
    process: Any = SimpleNamespace(pid=1)
    one.process, one.started, one.last_heartbeat, one.patience_s = process, 4, last_heartbeat, PLAN.heartbeat_s
    assert one.overdue_at(watched) == expected + round(PLAN.heartbeat_s * NS_PER_S)
    one.killed = True
    assert one.overdue_at(watched) is None
