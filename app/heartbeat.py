"""The web process tells that it lives, and how it does, as every task does."""

import asyncio
import os
import statistics
import time

from app.live import Live
from vision_core.clock import MonotonicClock
from vision_core.rtdb import records
from vision_core.rtdb.records import TaskInfo
from vision_core.rtdb.store import Store

NAME = "web"
EVERY_S = 0.5
MS_PER_S = 1e3


async def beat(store: Store, live: Live) -> None:
    """Write ``task/web`` twice a second, for ever: from the loop that serves pages, so that it stops when they do."""
    writer = records.task(NAME).writer(store)
    clock = MonotonicClock()
    sent, since_s = 0, time.monotonic()
    while True:
        durations_s, live.work.durations_s = live.work.durations_s, []
        now_s = time.monotonic()
        info = TaskInfo(
            pid=os.getpid(),
            runs=live.work.sent,
            missed=0,
            rate_hz=(live.work.sent - sent) / max(now_s - since_s, EVERY_S),
            response_median_ms=statistics.median(durations_s) * MS_PER_S if durations_s else 0.0,
            response_max_ms=max(durations_s, default=0.0) * MS_PER_S,
            note=f"{live.pages} page{'' if live.pages == 1 else 's'} open",
        )
        sent, since_s = live.work.sent, now_s
        writer.write(info, clock.now(), clock.now())
        await asyncio.sleep(EVERY_S)
