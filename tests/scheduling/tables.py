"""Lines of a task table with times in seconds, for tests."""

from dataclasses import replace
from typing import Any

import msgspec

from vision_core.rtdb.task import Task
from vision_core.settings.schema import TaskTimes

IN_MS = ("period_s", "offset_s", "budget_s")


def line(name: str, trigger: str, reads: tuple[str, ...], writes: tuple[str, ...], process: str, **times: Any) -> Task:
    """A line; times: fields of TaskTimes, durations in seconds."""
    always: dict[str, Any] = {"priority": 0, "period_ms": 0.0, "budget_ms": 0.0}
    return Task(name, "m", trigger, reads, writes, process, TaskTimes(**always | _in_ms(times)))


def changed(task: Task, **changes: Any) -> Task:
    """A line with other facts or times."""
    times = {name: value for name, value in _in_ms(changes).items() if name in TaskTimes.__struct_fields__}
    facts = {name: value for name, value in changes.items() if name in Task.__dataclass_fields__}
    return replace(task, times=msgspec.structs.replace(task.times, **times), **facts)


def _in_ms(values: dict[str, Any]) -> dict[str, Any]:
    return {
        f"{name.removesuffix('_s')}_ms" if name in IN_MS else name: value * 1e3 if name in IN_MS else value
        for name, value in values.items()
    }
