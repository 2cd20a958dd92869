"""``/api/v1/tasks``: lists tasks, and slows, re-prioritizes or switches them off while the service runs."""

from http import HTTPStatus
from typing import Any

from fastapi import APIRouter

from app.web.blackboard import Blackboard
from app.web.overrides import TaskOverrides
from app.web.problems import MEDIA_TYPE, ProblemDetails, RequestRefused
from app.web.reports.base import Report
from app.web.reports.tasks import Override, TaskReport, task_from, tasks_from

PROBLEM: dict[str, Any] = {"content": {MEDIA_TYPE: {"schema": ProblemDetails.model_json_schema()}}}
REFUSALS: dict[int | str, dict[str, Any]] = {
    403: PROBLEM | {"description": "The request comes from another machine or a foreign page, or is not JSON"},
    404: PROBLEM | {"description": "No task of this name"},
    409: PROBLEM | {"description": "The task runs a loop of its own and cannot be changed"},
    422: PROBLEM | {"description": "An unknown key, a rate that is impossible, or a priority out of range"},
}


class Change(Report):
    """A change of a task's override."""

    task: TaskReport
    """The task with its new override in ``proposed``; its other fields follow when the task has applied it."""
    before: Override
    """The override before the change; sent in a PATCH, it undoes the change."""


def task_routes(blackboard: Blackboard, overrides: TaskOverrides) -> APIRouter:
    """Listing tasks, changing one, undoing the change."""
    router = APIRouter(prefix="/api/v1/tasks", tags=["tasks"])

    @router.get("")
    async def tasks() -> list[TaskReport]:
        """Every task of the task table: what starts it, its granted priority, its rate and response times."""
        return tasks_from(blackboard.read())

    @router.patch("/{name}", responses=REFUSALS)
    async def change(name: str, request: Override) -> Change:
        """Switches a task on or off, slows it, or gives it another priority. Only the keys that are sent change; null
        stands for the value of the settings. The override lasts until the service ends, whatever process restarts."""
        before = _override(name)
        overrides.change(name, request)
        return Change(task=task_from(blackboard.read(), name), before=before)

    @router.delete("/{name}", responses=REFUSALS)
    async def undo(name: str) -> Change:
        """Lets a task run as the settings have it again."""
        before = _override(name)
        overrides.withdraw(name)
        return Change(task=task_from(blackboard.read(), name), before=before)

    def _override(name: str) -> Override:
        if name not in blackboard.task_names:
            names = ", ".join(blackboard.task_names)
            raise RequestRefused(HTTPStatus.NOT_FOUND, "a task", found=name, accepted=names)
        return Override.of(overrides.of(name))

    return router
