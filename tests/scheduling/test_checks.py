"""A table of tasks is refused for two writers, missing inputs, cycles and rates that do not add up."""

import os

import pytest

from tests.scheduling.tables import changed, line
from vision_core.rtdb.task import DRIVER, MAX_RUN_S, PERIOD, Task
from vision_core.scheduling.checks import TableProblem, load, problems, warnings

GIVEN = ("service",)
CAMERA = line("camera", DRIVER, (), ("frames",), "camera", priority=50, budget_s=0.001)
EYES = line("eyes", "frames", ("frames",), ("seen",), "eyes", priority=45, budget_s=0.003)
LINES = line("lines", PERIOD, ("frames",), ("lines",), "lines", priority=20, period_s=0.4, budget_s=0.01)
SOUND = (CAMERA, EYES, LINES)


def found(*tasks: Task, rate_hz: float = 30.0) -> list[tuple[str, str]]:
    return [(problem.key, problem.found) for problem in problems(tasks, GIVEN, rate_hz)]


def test_a_sound_table_has_no_problems() -> None:
    assert found(*SOUND) == []


def test_two_writers_are_named() -> None:
    second = changed(LINES, name="again")
    assert found(*SOUND, second) == [("tasks.again.writes", "lines, which lines writes")]
    assert found(*SOUND, changed(LINES, name="x", writes=("service",))) == [
        ("tasks.x.writes", "service, which the service itself writes")
    ]


def test_an_unknown_record_is_named_with_those_that_are_known() -> None:
    (problem,) = problems((*SOUND, changed(LINES, name="x", reads=("ghost",), writes=())), GIVEN, 30.0)
    assert problem == TableProblem(
        "tasks.x.reads", "ghost, which no task writes", "a record that is written: frames, lines, seen, service"
    )


def test_a_trigger_must_be_read() -> None:
    assert found(*SOUND, changed(EYES, name="x", reads=("seen",), writes=())) == [
        ("tasks.x.trigger", "frames, which it does not read")
    ]


def test_every_task_of_a_cycle_is_named() -> None:
    one = changed(EYES, name="one", trigger="b", reads=("b",), writes=("a",))
    two = changed(EYES, name="two", trigger="a", reads=("a",), writes=("b",))
    behind = changed(EYES, name="behind", trigger="b", reads=("b",), writes=())
    assert found(one, two, behind) == [
        ("tasks.one.trigger", "a cycle: one <- two <- one"),
        ("tasks.two.trigger", "a cycle: two <- one <- two"),
    ]


@pytest.mark.parametrize(
    ("change", "key"),
    [
        ({"period_s": 0.0}, "period_ms"),
        ({"period_s": 0.0005}, "period_ms"),
        ({"period_s": float("nan")}, "period_ms"),
        ({"offset_s": 0.4}, "offset_ms"),
        ({"budget_s": 0.5}, "budget_ms"),
        ({"priority": 91}, "priority"),
        ({"process": "camera"}, "process"),
    ],
)
def test_impossible_rates_are_named(change: dict[str, float], key: str) -> None:
    named = {name for name, _ in found(CAMERA, EYES, changed(LINES, **change))}
    assert f"tasks.{'camera' if key == 'process' else 'lines'}.{key}" in named


def test_a_budget_after_which_the_task_is_taken_for_hung_is_no_budget() -> None:
    slow = changed(LINES, period_s=60.0, budget_s=MAX_RUN_S + 0.5)
    assert ("tasks.lines.budget_ms", "4500") in found(CAMERA, EYES, slow)
    assert found(CAMERA, EYES, changed(slow, budget_s=MAX_RUN_S)) == []


def test_a_frame_task_must_be_done_before_the_next_frame() -> None:
    assert ("tasks.eyes.budget_ms", "3 for what comes every 2.5 ms: an impossible rate") in found(*SOUND, rate_hz=400.0)


def test_budgets_must_fit_into_the_cores() -> None:
    cores = len(os.sched_getaffinity(0))
    heavy = [changed(LINES, name=f"h{n}", process=f"h{n}", writes=(f"h{n}",), budget_s=0.39) for n in range(cores + 1)]
    assert any(
        key == "tasks.h0.budget_ms" and "cores at a camera of 30 Hz" in text for key, text in found(*SOUND, *heavy)
    )
    assert load(heavy, 30.0) == pytest.approx((cores + 1) * 0.39 / 0.4)
    ordinary = [changed(task, priority=0) for task in heavy]
    assert found(*SOUND, *ordinary) == []


def test_tasks_that_share_a_process_share_its_core() -> None:
    pair = [
        changed(LINES, name=f"p{n}", process="shared", writes=(f"p{n}",), budget_s=0.3, priority=0) for n in range(2)
    ]
    assert found(*SOUND, *pair) == [("tasks.p0.budget_ms", "budgets that fill 1.50 cores in process shared")]


def test_equal_priority_and_offset_are_a_warning() -> None:
    twin = changed(LINES, name="twin", process="twin", writes=("twin",))
    assert found(*SOUND, twin) == []
    assert warnings((*SOUND, twin)) == [
        "lines and twin have equal priority (20) and offset (0 ms): they swap places and give each other jitter"
    ]
    assert warnings((*SOUND, changed(twin, offset_s=0.05))) == []
    assert warnings((*SOUND, changed(twin, process="lines"))) == []
