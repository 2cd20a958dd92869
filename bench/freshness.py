"""Helper process: checks that a running service never presents a stale value as valid.

    python -m bench.freshness SERVICE        until standard input ends

It reads every record 100 times a second and checks each reading independently:

- A reading may be called valid only while its age, from the slot's own timestamp and this process's clock, is within
  the record's validity.
- No timestamp lies in the future, and no record's sequence number decreases.
- A valid sighting, world or view belongs to a frame that capture has published. A restarted process must not write
  results of its predecessor again.

Prints JSON: {"policy", "reads", "valid", "violations": at most 100 sentences}.
"""

import json
import sys
import time

from bench.frame_path import FRAMES, SIGHTINGS, VIEWS
from bench.helpers import READY, has_stdin_ended, request_realtime
from bench.record_timestamps import WriteHistory, timestamps_of
from vision_core.clock import NS_PER_S, Instant, MonotonicClock
from vision_core.net.control import attach_to
from vision_core.rtdb.slots import Reading, SlotReader
from vision_core.rtdb.store import Store

POLL_EVERY_S = 0.01
PRIORITY = 10
"""Lower than that of every real-time task of the service."""
FRAME_RECORDS = (SIGHTINGS, "world", VIEWS)
"""Records whose values belong to one frame each."""
UNKNOWN_FRAMES_S = 1.0
"""After a frame's timestamp was missed, values of unknown frames are accepted for so long."""
MAX_REPORTED = 100


class FreshnessChecker:
    """Reads every record; of the images it reads the timestamps only."""

    def __init__(self, store: Store) -> None:
        self._clock = MonotonicClock()
        self._readers = {name: store.reader(name) for name in store.specs if name != FRAMES}
        self._newest = dict.fromkeys(self._readers, 0)
        self._frames = WriteHistory(store.reader(FRAMES))
        self._frames.poll()
        self._published: set[int] = set()
        """When each frame that capture has published was measured [ns of CLOCK_MONOTONIC]."""
        self._incomplete_until = self._clock.now() + round(UNKNOWN_FRAMES_S * NS_PER_S)
        self.reads = self.valid = 0
        self.violations: list[str] = []

    def poll(self) -> None:
        """Read and check every record once."""
        readings = [
            (name, now, reading)
            for name, reader in self._readers.items()
            if (reading := reader.read(now := self._clock.now())) is not None
        ]
        self._poll_frames()
        for name, now, reading in readings:
            self.reads += 1
            self.valid += reading.valid
            self._check(name, now, reading)

    def _poll_frames(self) -> None:
        missed = self._frames.missed
        self._frames.poll()
        if self._frames.missed > missed:
            self._incomplete_until = self._clock.now() + round(UNKNOWN_FRAMES_S * NS_PER_S)
        self._published.update(measured for measured, _ in self._frames.timestamps)
        self._frames.timestamps.clear()

    def _check(self, name: str, now: Instant, reading: Reading) -> None:
        reader, sequence = self._readers[name], reading.sequence
        if sequence < self._newest[name]:
            self._report(f"{name} went back from {self._newest[name]} to {sequence}")
        self._newest[name] = sequence
        timestamps = timestamps_of(reader, sequence)
        if timestamps is None:  # overwritten since it was read
            return
        measured, written = timestamps
        if max(measured, written) > self._clock.now():
            self._report(f"{name} {sequence} lies in the future: measured {measured}, written {written}")
        if reading.valid != is_fresh(reader, measured, now):
            validity = "valid" if reading.valid else "invalid"
            self._report(f"{name} {sequence} is called {validity} at {now}, measured {measured}")
        known = measured in self._published or self._clock.now() < self._incomplete_until
        if name in FRAME_RECORDS and reading.valid and not known:
            self._report(f"{name} {sequence} belongs to a frame of {measured}, which was never published")

    def _report(self, violation: str) -> None:
        if len(self.violations) < MAX_REPORTED:
            self.violations.append(violation)


def is_fresh(reader: SlotReader, measured: int, now: int) -> bool:
    """Is a value that was measured at an instant still within its record's validity [ns of CLOCK_MONOTONIC]?"""
    limit_ns = round(reader.spec.validity_s * NS_PER_S)
    return limit_ns == 0 or now - measured <= limit_ns


def main(service: str) -> None:
    """Attach to a service's database, check it until standard input ends, print the report."""
    checker = FreshnessChecker(attach_to(service).store)
    policy = request_realtime(PRIORITY)
    print(READY, flush=True)
    while not has_stdin_ended():
        time.sleep(POLL_EVERY_S)
        checker.poll()
    counts = {"reads": checker.reads, "valid": checker.valid}
    print(json.dumps({"policy": policy, **counts, "violations": checker.violations}))


if __name__ == "__main__":
    main(sys.argv[1])
