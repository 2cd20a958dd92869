"""The web process tells that it lives, and how it does, as every task does."""

import asyncio
from collections.abc import Iterable

from app.web.live.connection import Live
from vision_core.clock import MonotonicClock
from vision_core.rtdb import records
from vision_core.rtdb.store import Store
from vision_core.rtdb.task import Task
from vision_core.scheduling.metrics import TaskMetrics
from vision_core.scheduling.realtime import ORDINARY

EVERY_S = 0.2


def own_line(tasks: Iterable[Task]) -> Task:
    """The line of the task table for the web process: the one with a loop of its own."""
    return next(task for task in tasks if task.own_loop)


async def keep_beating(store: Store, task: Task, metrics: TaskMetrics, live: Live) -> None:
    """Write ``heartbeat/web``, for ever, and about twice a second how it does.

    From the loop that serves pages, so that it stops when they do; a run of this task is a turn that was made.
    """
    beats = store.writer(records.heartbeat(task.process).name)
    clock = MonotonicClock()
    while True:
        now = clock.now()
        beats.write(b"", now, now)
        metrics.note = f"{live.pages} page{'' if live.pages == 1 else 's'} open"
        metrics.publish_if_due(now, task, ORDINARY, ())
        await asyncio.sleep(EVERY_S)
