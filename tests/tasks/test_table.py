"""The task table proves itself."""

from dataclasses import replace

from vision_core.settings_files import load_settings
from vision_core.tasks.table import Task, problems, record_specs, task_table


def test_our_table_is_in_order() -> None:
    assert problems(task_table("main")) == []


def test_every_record_of_the_table_has_a_place() -> None:
    tasks = task_table("main")
    places = {spec.name for spec in record_specs(load_settings(), tasks)}
    for task in tasks:
        assert {*task.reads, *task.writes, f"task/{task.name}"} <= places


def test_two_writers_are_named() -> None:
    tasks = task_table("main")
    twice = Task("again", "m", None, (), ("world",))
    assert problems([*tasks, twice]) == ["world is written by serve and by again"]


def test_an_input_that_nobody_writes_is_named() -> None:
    lonely = Task("lonely", "m", None, ("ghost",), ())
    assert problems([*task_table("main"), lonely]) == ["lonely reads ghost, which nobody writes"]


def test_a_trigger_must_be_read() -> None:
    blind = Task("blind", "m", "world", (), ())
    assert problems([*task_table("main"), blind]) == ["blind is triggered by world, which it does not read"]


def test_a_cycle_is_found() -> None:
    first = Task("first", "m", "b", ("b",), ("a",))
    second = replace(first, name="second", trigger="a", reads=("a",), writes=("b",))
    assert problems([first, second]) == [
        "first is released by a cycle through first",
        "second is released by a cycle through second",
    ]
