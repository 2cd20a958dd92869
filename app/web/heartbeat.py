"""The web process tells that it lives, and how it does, as every task does."""

import asyncio

from app.web.live.connection import Live
from vision_core.clock import MonotonicClock
from vision_core.rtdb import records
from vision_core.rtdb.store import Store
from vision_core.scheduling.metrics import TaskMetrics
from vision_core.scheduling.realtime import ORDINARY
from vision_core.scheduling.task import NONE, Task
from vision_core.settings.schema import Settings

NAME = "web"
EVERY_S = 0.2
S_PER_MS = 1e-3


def own_line(settings: Settings) -> Task:
    """The web process's line of the task table, as far as it tells of it."""
    line = settings.tasks[NAME]
    return Task(
        name=NAME,
        module="app.web.process",
        trigger=NONE,
        reads=(),
        writes=(records.PROPOSED.spec.name,),
        process=NAME,
        period_s=line.period_ms * S_PER_MS,
        budget_s=line.budget_ms * S_PER_MS,
    )


async def keep_beating(store: Store, task: Task, metrics: TaskMetrics, live: Live) -> None:
    """Write ``heartbeat/web``, for ever, and about twice a second how it does.

    From the loop that serves pages, so that it stops when they do; a run of this task is a turn that was made.
    """
    beats = store.writer(records.heartbeat(NAME).name)
    clock = MonotonicClock()
    while True:
        now = clock.now()
        beats.write(b"", now, now)
        metrics.note = f"{live.pages} page{'' if live.pages == 1 else 's'} open"
        metrics.publish_if_due(now, task, ORDINARY, "")
        await asyncio.sleep(EVERY_S)
