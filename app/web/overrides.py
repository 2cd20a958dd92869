"""Changes of tasks while the service runs: checked like the task table at the start, then written to the database.

The web process is the only writer of the record ``live_settings``. Every process reads it between two runs, applies
it, and reports in ``task/<name>`` how its task runs then. A restarted web process continues with the record's content.
"""

from collections.abc import Mapping
from dataclasses import fields, replace
from http import HTTPStatus

from msgspec import structs

from app.web.problems import RequestRefused
from app.web.reports.tasks import Override
from vision_core.clock import MonotonicClock
from vision_core.models.camera_setup import CameraSetup
from vision_core.rtdb import records
from vision_core.rtdb.infos import LiveSettings, ServiceInfo, TaskOverride
from vision_core.rtdb.store import Store
from vision_core.scheduling.checks import TableProblem, rate_problems
from vision_core.scheduling.executive import with_override


class TaskOverrides:
    """The overrides of all tasks, kept in the database."""

    def __init__(self, store: Store, service: ServiceInfo) -> None:
        self._rate_hz = CameraSetup.from_settings(service.settings).rate_hz
        self._table = {task.name: task for task in service.tasks}
        self._clock = MonotonicClock()
        self._writer = records.LIVE_SETTINGS.writer(store)
        stored = records.LIVE_SETTINGS.reader(store).read(self._clock.now())
        self._live = stored.value if stored else LiveSettings.of(service.settings)
        self._tasks = dict(self._live.tasks)

    def of(self, name: str) -> TaskOverride:
        """The override of a task; without values when it runs as the settings have it."""
        return self._tasks.get(name, TaskOverride())

    def change(self, name: str, request: Override) -> None:
        """Change the override of a task by the keys that the request contains; its other values stay.

        Raises RequestRefused when the tasks could not run that way.
        """
        changed = replace(self.of(name), **{key: getattr(request, key) for key in request.model_fields_set})
        self._check(name, request, changed)
        self._write(name, changed)

    def withdraw(self, name: str) -> None:
        """Let a task run as the settings have it again."""
        self._write(name, TaskOverride())

    def _write(self, name: str, override: TaskOverride) -> None:
        if override == self.of(name):
            return
        self._tasks.pop(name, None)
        if override != TaskOverride():
            self._tasks[name] = override
        now = self._clock.now()
        self._live = replace(self._live, revision=self._live.revision + 1, tasks=dict(self._tasks))
        self._writer.write(self._live, now, now)

    def _check(self, name: str, request: Override, changed: TaskOverride) -> None:
        task = self._table[name]
        if task.own_loop:
            raise RequestRefused(
                HTTPStatus.CONFLICT,
                f"a change of task {name}",
                found="it runs in a loop of its own",
                accepted="a change of its line in the venue file, at the next start",
            )
        asked = f"{_in_words(request)} for task {name}"
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


def _in_words(request: Override) -> str:
    """The keys and values of a request: "period_ms 50, enabled null"."""
    named = ((entry.name, getattr(request, entry.name)) for entry in fields(TaskOverride))
    sent = (f"{key} {_value(value)}" for key, value in named if key in request.model_fields_set)
    return ", ".join(sent)


def _value(value: float | None) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    return "null" if value is None else f"{value:g}"
