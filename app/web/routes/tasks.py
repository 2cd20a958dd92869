"""``/api/v1/tasks``: lists tasks, and slows, re-prioritizes or switches them off while the service runs."""

from http import HTTPStatus

from fastapi import APIRouter, Request

from app.web.auth.identity import identity_of
from app.web.blackboard import Blackboard
from app.web.configuration.task_changes import TaskChanges
from app.web.problems import REFUSED, RequestRefused
from app.web.reports.base import Report
from app.web.reports.tasks import Override, TaskReport, task_from, tasks_from


class TaskChange(Report):
    """A change of a task's override."""

    task: TaskReport
    """The task with its new override in ``proposed``; its other fields follow when the task has applied it."""
    before: Override
    """The override before the change; sent in a PATCH, it undoes the change."""


def task_routes(blackboard: Blackboard, changes: TaskChanges) -> APIRouter:
    """Listing tasks, changing one, undoing the change."""
    router = APIRouter(prefix="/api/v1/tasks", tags=["tasks"])

    @router.get("")
    async def tasks() -> list[TaskReport]:
        """Every task of the task table: what starts it, its granted priority, its rate and response times."""
        return tasks_from(blackboard.read())

    @router.patch("/{name}", responses=REFUSED)
    def change(name: str, override: Override, request: Request) -> TaskChange:
        """Switches a task on or off, slows it, or gives it another priority. Only the keys that are sent change; null
        stands for the value of the settings. The change is kept, as every change of
        the page, until it is taken back."""
        before = _override(name)
        changes.change(name, override, identity_of(request).name)
        return TaskChange(task=task_from(blackboard.read(), name), before=before)

    @router.delete("/{name}", responses=REFUSED)
    def undo(name: str, request: Request) -> TaskChange:
        """Lets a task run as the settings have it again."""
        before = _override(name)
        changes.withdraw(name, identity_of(request).name)
        return TaskChange(task=task_from(blackboard.read(), name), before=before)

    def _override(name: str) -> Override:
        if name not in blackboard.task_names:
            names = ", ".join(blackboard.task_names)
            raise RequestRefused(HTTPStatus.NOT_FOUND, "a task", found=name, accepted=names)
        return Override.of(changes.of(name))

    return router
