"""Keeps the record of fairness in the database, so that it outlives the process that counts."""

import time

from vision_core.clock import Instant, seconds_between
from vision_core.net.fairness import FairnessRecord
from vision_core.rtdb import records
from vision_core.rtdb.infos import LiveSettings
from vision_core.scheduling.handle import Handle

PUBLISH_EVERY_S = 2.0
"""A process that is killed loses the counts of so long; the record has 170 kB."""


class FairnessKeeper:
    """Writes the records ``fairness`` and ``fairness_ended``."""

    def __init__(self, handle: Handle, record: FairnessRecord) -> None:
        """Go on with the record of an earlier process, if there was one."""
        self._clock = handle.clock
        self._record = record
        self._writer = handle.raw_writer(records.FAIRNESS_RECORD.name)
        self._ended = handle.raw_writer(records.FAIRNESS_ENDED.name)
        self._published_at: Instant | None = None
        kept = handle.raw_reader(records.FAIRNESS_RECORD.name).read(self._clock.now())
        if kept is not None:
            record.load(kept.value)
        if not record.has_begun:  # else the live settings say how it goes on: the files may not know of the match
            self.follow(LiveSettings.of(handle.settings))

    def follow(self, live: LiveSettings) -> None:
        """Begin a new record if the settings ask for one."""
        now = self._clock.now()
        ended = self._record.follow(live.match, live.fairness_asked, now, time.time())
        if ended is not None:
            self._ended.write(ended, now, now)
            self._published_at = None

    def publish(self, now: Instant) -> None:
        """Write the record, unless it was written lately."""
        if self._published_at is None or seconds_between(self._published_at, now) >= PUBLISH_EVERY_S:
            self._writer.write(self._record.memory, now, now)
            self._published_at = now
