"""``/api/v1/tasks``: what runs, and how it is slowed, re-prioritized and switched off while it runs."""

from http import HTTPStatus
from typing import Any

from fastapi import APIRouter

from app.web.blackboard import Blackboard
from app.web.overrides import Proposals
from app.web.problems import MEDIA_TYPE, Problem, RequestRefused
from app.web.reports.base import Report
from app.web.reports.tasks import Task, Wish, task_from, tasks_from

PROBLEM: dict[str, Any] = {"content": {MEDIA_TYPE: {"schema": Problem.model_json_schema()}}}
REFUSALS: dict[int | str, dict[str, Any]] = {
    403: PROBLEM | {"description": "From another machine, a foreign page, or no JSON"},
    404: PROBLEM | {"description": "No task of this name"},
    409: PROBLEM | {"description": "The task has a loop of its own"},
    422: PROBLEM | {"description": "An unknown key, an impossible rate, or a priority that there is not"},
}


class Change(Report):
    """A task that somebody wants to run in another way."""

    task: Task
    """Its ``proposed`` is what is wanted now; the rest follows in a moment, when the task has obeyed."""
    before: Wish
    """What was wanted before: sent in a PATCH it undoes the change."""


def task_routes(blackboard: Blackboard, proposals: Proposals) -> APIRouter:
    """List, change, undo."""
    router = APIRouter(prefix="/api/v1/tasks", tags=["tasks"])

    @router.get("")
    async def tasks() -> list[Task]:
        """Every task of the table: when it runs, what it has got, how it does."""
        return tasks_from(blackboard.read())

    @router.patch("/{name}", responses=REFUSALS)
    async def change(name: str, wish: Wish) -> Change:
        """Switch a task on or off, slow it, give it another priority: only keys that are sent change, null is the
        table's value. The wish outlives a restart of any process, not of the service."""
        before = _wanted(name)
        proposals.change(name, wish)
        return Change(task=task_from(blackboard.read(), name), before=before)

    @router.delete("/{name}", responses=REFUSALS)
    async def undo(name: str) -> Change:
        """Let a task run as the table has it again."""
        before = _wanted(name)
        proposals.withdraw(name)
        return Change(task=task_from(blackboard.read(), name), before=before)

    def _wanted(name: str) -> Wish:
        if name not in blackboard.task_names:
            names = ", ".join(blackboard.task_names)
            raise RequestRefused(HTTPStatus.NOT_FOUND, "a task", found=name, accepted=names)
        return Wish.of(proposals.wanted(name))

    return router
