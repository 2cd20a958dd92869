"""What people want changed while the service runs: checked as the task table was at the start, then written down.

The record ``proposed_settings`` has one writer, the web process; every process of the service looks at it in its own
time and says in ``task/<name>`` what is so. A web process that was started again goes on with what is there.
"""

from collections.abc import Sequence
from dataclasses import fields, replace
from http import HTTPStatus

from app.web.problems import RequestRefused
from app.web.reports.tasks import Task, Wish
from vision_core.clock import MonotonicClock
from vision_core.rtdb import records
from vision_core.rtdb.infos import ProposedSettings, TaskOverride
from vision_core.rtdb.store import Store
from vision_core.scheduling import task as table
from vision_core.scheduling.checks import problems
from vision_core.settings.schema import Settings

FIXED = {"capture": "its camera", "source": "capture's orders"}
"""Tasks whose period is not theirs, and whose it is."""
LOOPS = ("web",)
"""Tasks with a loop of their own, which nobody can slow or stop from outside."""
MS_PER_S = 1e3


class Proposals:
    """All proposals, in the database."""

    def __init__(self, store: Store, settings: Settings) -> None:
        self._settings = settings
        self._clock = MonotonicClock()
        self._writer = records.PROPOSED.writer(store)
        told = records.PROPOSED.reader(store).read(self._clock.now())
        self._tasks = dict(told.value.tasks) if told else {}

    def wanted(self, name: str) -> TaskOverride:
        """What is wanted of a task."""
        return self._tasks.get(name, TaskOverride())

    def change(self, tasks: Sequence[Task], name: str, wish: Wish) -> None:
        """Want something of a task beside what was wanted: only the keys that the wish names count.

        tasks: all of them, as they are. Raises RequestRefused for what cannot be.
        """
        task = next(task for task in tasks if task.name == name)
        changed = replace(self.wanted(name), **{key: getattr(wish, key) for key in wish.model_fields_set})
        self._check(tasks, task, wish, changed)
        self._propose(name, changed)

    def withdraw(self, name: str) -> None:
        """Want nothing of a task but what the table says."""
        self._propose(name, TaskOverride())

    def _propose(self, name: str, proposal: TaskOverride) -> None:
        if proposal == self.wanted(name):
            return
        self._tasks.pop(name, None)
        if proposal != TaskOverride():
            self._tasks[name] = proposal
        now = self._clock.now()
        self._writer.write(ProposedSettings(dict(self._tasks)), now, now)

    def _check(self, tasks: Sequence[Task], task: Task, wish: Wish, changed: TaskOverride) -> None:
        if task.name in LOOPS or task.trigger == table.NONE:
            raise RequestRefused(
                HTTPStatus.CONFLICT,
                f"a change of task {task.name}",
                found="it runs in a loop of its own",
                accepted="a change of its line in the venue file, at the next start",
            )
        asked = f"{_words(wish)} for task {task.name}"
        if wish.period_ms and task.name in FIXED:
            raise RequestRefused(
                HTTPStatus.UNPROCESSABLE_ENTITY,
                asked,
                found=f"its period is that of {FIXED[task.name]}",
                accepted="null or 0",
            )
        rate_hz = self._settings.camera.rate_hz
        before = [self._line(each, self.wanted(each.name)) for each in tasks]
        after = [self._line(each, changed if each is task else self.wanted(each.name)) for each in tasks]
        given = [line.trigger for line in after]
        known = problems(before, given, rate_hz)
        for problem in problems(after, given, rate_hz):
            if problem not in known:
                raise RequestRefused(
                    HTTPStatus.UNPROCESSABLE_ENTITY,
                    asked,
                    found=f"{problem.key}: {problem.found}",
                    accepted=problem.accepted,
                )

    def _line(self, task: Task, proposal: TaskOverride) -> table.Task:
        """A task's line of the table as somebody wants it, without what it reads and writes."""
        declared = self._settings.tasks[task.name]
        trigger = task.trigger or table.PERIOD
        period_ms = declared.period_ms if proposal.period_ms is None else proposal.period_ms
        return table.Task(
            name=task.name,
            module="",
            trigger=trigger,
            reads=(trigger,),
            writes=(),
            process=task.process,
            priority=declared.priority if proposal.priority is None else proposal.priority,
            period_s=period_ms / MS_PER_S,
            budget_s=declared.budget_ms / MS_PER_S,
            enabled=declared.enabled if proposal.enabled is None else proposal.enabled,
        )


def _words(wish: Wish) -> str:
    """period_ms 50, enabled null."""
    named = ((entry.name, getattr(wish, entry.name)) for entry in fields(TaskOverride))
    said = (f"{key} {_value(value)}" for key, value in named if key in wish.model_fields_set)
    return ", ".join(said)


def _value(value: float | None) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    return "null" if value is None else f"{value:g}"
