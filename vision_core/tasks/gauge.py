"""How a task does: counts its runs and says so twice a second, which is also its heartbeat.

The heartbeat begins with the first look at what is due, when the task is ready to work: until then, while it
opens a camera or loads its kernels, the supervisor has the longer patience of a start.
"""

import os
import statistics

from vision_core.clock import NS_PER_S, Instant, seconds_between
from vision_core.rtdb import records
from vision_core.rtdb.attachment import Attachment
from vision_core.rtdb.records import TaskInfo

PUBLISH_EVERY_S = 0.5
MS_PER_S = 1e3
LONGEST_NOTE = 500


class Gauge:
    """Measures one task; the runner measures, not the stage."""

    def __init__(self, attachment: Attachment, now: Instant) -> None:
        self._writer = records.task(attachment.handed.process).writer(attachment.store)
        self._runs = 0
        self._missed = 0
        self._responses_s: list[float] = []
        self._since = now
        self._begun = False
        self.note = ""

    def ran(self, released: Instant, done: Instant, missed: int = 0) -> None:
        """One run, from its release to its result; missed: releases that were skipped before it."""
        self._runs += 1
        self._missed += missed
        self._responses_s.append(seconds_between(released, done))

    def publish_if_due(self, now: Instant) -> None:
        """Publish the first time, and when half a second has passed since the last time."""
        if not self._begun or now - self._since >= PUBLISH_EVERY_S * NS_PER_S:
            self.publish(now)

    def publish(self, now: Instant) -> None:
        """Write the record and begin the next interval."""
        elapsed_s = max(seconds_between(self._since, now), 1e-9)
        responses = self._responses_s
        info = TaskInfo(
            pid=os.getpid(),
            runs=self._runs,
            missed=self._missed,
            rate_hz=len(responses) / elapsed_s,
            response_median_ms=statistics.median(responses) * MS_PER_S if responses else 0.0,
            response_max_ms=max(responses, default=0.0) * MS_PER_S,
            note=self.note[:LONGEST_NOTE],
        )
        self._writer.write(info, now, now)
        self._begun = True
        self._since = now
        self._responses_s = []
