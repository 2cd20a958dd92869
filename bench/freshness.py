"""Is anything stale served as fresh? Reads every record of a running service 100 times a second and doubts it.

    python -m bench.freshness SERVICE        until standard input ends

What a read calls valid must be as young as its record's validity says, by the slot's own stamp and a clock of ours; it
must not come from the future; no record may go back. And what tells of a frame (sightings, world, views) must tell of
one that capture has published: a process that came back may not give out again what its predecessor knew. Prints JSON:
{"policy", "reads", "valid", "wrong": what was found to be so, at most a hundred}.
"""

import json
import sys
import time

from bench.frame_path import FRAMES, SIGHTINGS, VIEWS
from bench.helpers import READY, keep_time, told_to_end
from bench.record_timestamps import History, stamp_of
from vision_core.clock import NS_PER_S, Instant, MonotonicClock
from vision_core.net.control import attach_to
from vision_core.rtdb.slots import Reading, SlotReader
from vision_core.rtdb.store import Store

LOOK_EVERY_S = 0.01
PRIORITY = 10
"""Below every task that has one."""
OF_FRAMES = (SIGHTINGS, "world", VIEWS)
UNSURE_S = 1.0
"""After a frame's stamp was lost, since a look came too late."""
MAX_TOLD = 100


class Doubter:
    """Looks at every record but the images, of which it keeps the stamps."""

    def __init__(self, store: Store) -> None:
        self._clock = MonotonicClock()
        self._readers = {name: store.reader(name) for name in store.specs if name != FRAMES}
        self._newest = dict.fromkeys(self._readers, 0)
        self._frames = History(store.reader(FRAMES))
        self._frames.look()
        self._published: dict[int, int] = {}
        self._unsure_until = self._clock.now() + round(UNSURE_S * NS_PER_S)
        self.reads = self.valid = 0
        self.wrong: list[str] = []

    def look(self) -> None:
        """Read everything once."""
        readings = [
            (name, now, reading)
            for name, reader in self._readers.items()
            if (reading := reader.read(now := self._clock.now())) is not None
        ]
        self._look_at_frames()
        for name, now, reading in readings:
            self.reads += 1
            self.valid += reading.valid
            self._doubt(name, now, reading)

    def _look_at_frames(self) -> None:
        lost = self._frames.lost
        self._frames.look()
        if self._frames.lost > lost:
            self._unsure_until = self._clock.now() + round(UNSURE_S * NS_PER_S)
        self._published.update(self._frames.stamps)
        self._frames.stamps.clear()

    def _doubt(self, name: str, now: Instant, reading: Reading) -> None:
        reader, sequence = self._readers[name], reading.sequence
        if sequence < self._newest[name]:
            self._tell(f"{name} went back from {self._newest[name]} to {sequence}")
        self._newest[name] = sequence
        stamp = stamp_of(reader, sequence)
        if stamp is None:  # written over meanwhile
            return
        measured, written = stamp
        if max(measured, written) > self._clock.now():
            self._tell(f"{name} {sequence} comes from the future: measured {measured}, written {written}")
        if reading.valid != is_fresh(reader, measured, now):
            self._tell(
                f"{name} {sequence} is called {'' if reading.valid else 'in'}valid at {now}, measured {measured}"
            )
        known = measured in self._published or self._clock.now() < self._unsure_until
        if name in OF_FRAMES and reading.valid and not known:
            self._tell(f"{name} {sequence} tells of a frame of {measured}, which was never published")

    def _tell(self, what: str) -> None:
        if len(self.wrong) < MAX_TOLD:
            self.wrong.append(what)


def is_fresh(reader: SlotReader, measured: int, now: int) -> bool:
    """May a value of a record still be called valid?"""
    limit_ns = round(reader.spec.validity_s * NS_PER_S)
    return limit_ns == 0 or now - measured <= limit_ns


def main(service: str) -> None:
    """Attach, doubt, report."""
    doubter = Doubter(attach_to(service).store)
    policy = keep_time(PRIORITY)
    print(READY, flush=True)
    while not told_to_end():
        time.sleep(LOOK_EVERY_S)
        doubter.look()
    print(json.dumps({"policy": policy, "reads": doubter.reads, "valid": doubter.valid, "wrong": doubter.wrong}))


if __name__ == "__main__":
    main(sys.argv[1])
