"""The heartbeat and the metrics of the web process, written like those of every task."""

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
    """The web process's line of the task table: the one with a loop of its own."""
    return next(task for task in tasks if task.own_loop)


async def keep_beating(store: Store, task: Task, metrics: TaskMetrics, live: Live) -> None:
    """Write the process's heartbeat for ever, and its metrics about twice a second.

    It runs in the loop that serves pages, so that the heartbeat stops when that loop is blocked. A run of this task is
    one set of messages made for the pages.
    """
    heartbeat = store.writer(records.heartbeat(task.process).name)
    clock = MonotonicClock()
    while True:
        now = clock.now()
        heartbeat.write(b"", now, now)
        metrics.note = f"{live.pages} page{'' if live.pages == 1 else 's'} open"
        metrics.publish_if_due(now, task, ORDINARY, ())
        await asyncio.sleep(EVERY_S)
