"""Changes of tasks while the service runs: checked like the task table at the start, before they are kept."""

from collections.abc import Mapping
from dataclasses import fields, replace
from http import HTTPStatus
from typing import Any

from msgspec import structs

from app.web.configuration.configuration import Configuration
from app.web.configuration.keys import setting
from app.web.problems import RequestRefused
from app.web.reports.tasks import Override
from vision_core.models.camera_setup import CameraSetup
from vision_core.rtdb.infos import ServiceInfo, TaskOverride
from vision_core.scheduling.checks import TableProblem, rate_problems
from vision_core.scheduling.executive import with_override
from vision_core.settings.live import LIVE_OF_TASKS


class TaskChanges:
    """Changes of the times of tasks."""

    def __init__(self, configuration: Configuration, service: ServiceInfo) -> None:
        self._configuration = configuration
        self._rate_hz = CameraSetup.from_settings(service.settings).rate_hz
        self._table = {task.name: task for task in service.tasks}

    def of(self, name: str) -> TaskOverride:
        """What was changed of a task; without values when it runs as the files have it."""
        entries = self._configuration.entries
        return TaskOverride(**{key: entries.get(_entry(name, key)) for key in LIVE_OF_TASKS})

    def change(self, name: str, request: Override, who: str) -> None:
        """Change a task's times by the keys that the request contains; the others stay.

        Raises RequestRefused when the tasks could not run that way.
        """
        sent = {key: getattr(request, key) for key in request.model_fields_set}
        self._check(name, request, replace(self.of(name), **sent))
        self._keep(name, sent, who, f"task {name}: {in_words(request)}")

    def withdraw(self, name: str, who: str) -> None:
        """Let a task run as the files have it again."""
        self._keep(name, dict.fromkeys(LIVE_OF_TASKS), who, f"task {name}: as in the files")

    def _keep(self, name: str, values: Mapping[str, Any], who: str, what: str) -> None:
        entries = {_entry(name, key): value for key, value in values.items()}
        self._configuration.change(entries, who=who, what=what)

    def _check(self, name: str, request: Override, changed: TaskOverride) -> None:
        task = self._table[name]
        if task.own_loop:
            raise RequestRefused(
                HTTPStatus.CONFLICT,
                f"a change of task {name}",
                found="it runs in a loop of its own",
                accepted="a change of its line in the venue file, at the next start",
            )
        asked = f"{in_words(request)} for task {name}"
        if request.period_ms and task.period_owner:
            raise RequestRefused(
                HTTPStatus.UNPROCESSABLE_ENTITY,
                asked,
                found=f"its period is that of {task.period_owner}",
                accepted="null or 0",
            )
        overrides = {each: self.of(each) for each in self._table}
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
        """What is wrong with the rates of the task table when these overrides hold.

        Offsets are left out: a grid is shifted by the rest of the offset, whatever period an override gives it.
        """
        changed = [with_override(task, overrides[name]) for name, task in self._table.items()]
        tasks = [replace(task, times=structs.replace(task.times, offset_ms=0.0)) for task in changed]
        return list(rate_problems(tasks, self._rate_hz))


def in_words(request: Override) -> str:
    """The keys and values of a request: "period_ms 50, enabled null"."""
    named = ((entry.name, getattr(request, entry.name)) for entry in fields(TaskOverride))
    sent = (f"{key} {_value(value)}" for key, value in named if key in request.model_fields_set)
    return ", ".join(sent)


def _entry(name: str, key: str) -> str:
    return setting(f"tasks.{name}.{key}")


def _value(value: float | None) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    return "null" if value is None else f"{value:g}"
