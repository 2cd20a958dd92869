"""Changes of tasks while the service runs: checked as the task table was at the start, then written to the database.

The record ``proposed_settings`` has one writer, the web process; every process of the service reads it in its own time
and writes to ``task/<name>`` how its tasks run. A web process that was started again keeps the changes of
its predecessor.
"""

from collections.abc import Mapping
from dataclasses import fields, replace
from http import HTTPStatus

from app.web.problems import RequestRefused
from app.web.reports.tasks import Wish
from vision_core.clock import MonotonicClock
from vision_core.rtdb import records
from vision_core.rtdb.infos import ProposedSettings, ServiceInfo, TaskOverride
from vision_core.rtdb.store import Store
from vision_core.scheduling.checks import TableProblem, rate_problems
from vision_core.scheduling.executive import with_override


class Proposals:
    """All overrides, in the database."""

    def __init__(self, store: Store, service: ServiceInfo) -> None:
        self._rate_hz = service.settings.camera.rate_hz
        self._table = {task.name: task for task in service.tasks}
        self._clock = MonotonicClock()
        self._writer = records.PROPOSED.writer(store)
        told = records.PROPOSED.reader(store).read(self._clock.now())
        self._tasks = dict(told.value.tasks) if told else {}

    def wanted(self, name: str) -> TaskOverride:
        """The override of a task."""
        return self._tasks.get(name, TaskOverride())

    def change(self, name: str, wish: Wish) -> None:
        """Change the override of a task by the keys that the wish names.

        Raises RequestRefused when the task cannot be changed so.
        """
        changed = replace(self.wanted(name), **{key: getattr(wish, key) for key in wish.model_fields_set})
        self._check(name, wish, changed)
        self._propose(name, changed)

    def withdraw(self, name: str) -> None:
        """Let a task run as the table has it."""
        self._propose(name, TaskOverride())

    def _propose(self, name: str, proposal: TaskOverride) -> None:
        if proposal == self.wanted(name):
            return
        self._tasks.pop(name, None)
        if proposal != TaskOverride():
            self._tasks[name] = proposal
        now = self._clock.now()
        self._writer.write(ProposedSettings(dict(self._tasks)), now, now)

    def _check(self, name: str, wish: Wish, changed: TaskOverride) -> None:
        task = self._table[name]
        if task.own_loop:
            raise RequestRefused(
                HTTPStatus.CONFLICT,
                f"a change of task {name}",
                found="it runs in a loop of its own",
                accepted="a change of its line in the venue file, at the next start",
            )
        asked = f"{_words(wish)} for task {name}"
        if wish.period_ms and task.period_owner:
            raise RequestRefused(
                HTTPStatus.UNPROCESSABLE_ENTITY,
                asked,
                found=f"its period is that of {task.period_owner}",
                accepted="null or 0",
            )
        overrides = {each: self.wanted(each) for each in self._table}
        known = self._problems(overrides)
        for problem in self._problems(overrides | {name: changed}):
            if problem not in known:
                raise RequestRefused(
                    HTTPStatus.UNPROCESSABLE_ENTITY,
                    asked,
                    found=f"{problem.key}: {problem.found}",
                    accepted=problem.accepted,
                )

    def _problems(self, overrides: Mapping[str, TaskOverride]) -> list[TableProblem]:
        """What is wrong with the rates of the task table when these overrides hold."""
        tasks = [with_override(task, overrides[name]) for name, task in self._table.items()]
        return list(rate_problems(tasks, self._rate_hz))


def _words(wish: Wish) -> str:
    """period_ms 50, enabled null."""
    named = ((entry.name, getattr(wish, entry.name)) for entry in fields(TaskOverride))
    said = (f"{key} {_value(value)}" for key, value in named if key in wish.model_fields_set)
    return ", ".join(said)


def _value(value: float | None) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    return "null" if value is None else f"{value:g}"
