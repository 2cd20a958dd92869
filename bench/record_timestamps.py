"""When what was written: looks into records of a running service faster than their rings go round.

    python -m bench.record_timestamps SERVICE RECORD...        until standard input ends

Every slot of a record keeps when it was measured and written, and the ring has four, so nothing is lost as long as one
look comes within three writings; what is lost is counted. Prints JSON: {"policy", "stamps": {record: [[measured_ns,
written_ns], ...]}, "lost": {record: count}}.
"""

import json
import sys
import time
from collections.abc import Sequence

from bench.helpers import BELOW_SERVE, READY, keep_time, told_to_end
from vision_core.net.control import attach_to
from vision_core.rtdb.slots import BEGUN, ENDED, MEASURED, WRITTEN, SlotReader
from vision_core.rtdb.store import Store

LOOK_EVERY_S = 0.001

Stamp = tuple[int, int]
"""Measured and written [ns of CLOCK_MONOTONIC]."""


class History:
    """Every writing of one record since this began, as far as looks came in time."""

    def __init__(self, record: SlotReader) -> None:
        self._record = record
        self._seen = record.sequence
        self.stamps: list[Stamp] = []
        self.lost = 0

    def look(self) -> None:
        """Take down what was written since the last look."""
        head = self._record.sequence
        oldest = max(self._seen + 1, head - self._record.spec.slots + 2)  # the one before may be written over just now
        self.lost += oldest - self._seen - 1
        for sequence in range(oldest, head + 1):
            if (stamp := stamp_of(self._record, sequence)) is None:
                self.lost += 1
            else:
                self.stamps.append(stamp)
        self._seen = head


def stamp_of(record: SlotReader, sequence: int) -> Stamp | None:
    """Measured and written of one writing; None when it was written over."""
    fields = record._fields[sequence % record.spec.slots]
    told = fields.tolist()
    if told[BEGUN] != sequence or told[ENDED] != sequence or fields[BEGUN] != sequence:
        return None
    return told[MEASURED], told[WRITTEN]


def watch(store: Store, records: Sequence[str]) -> dict[str, object]:
    """Look until standard input ends."""
    policy = keep_time(BELOW_SERVE)
    histories = {name: History(store.reader(name)) for name in records}
    print(READY, flush=True)
    while not told_to_end():
        time.sleep(LOOK_EVERY_S)
        for history in histories.values():
            history.look()
    stamps = {name: history.stamps for name, history in histories.items()}
    return {"policy": policy, "stamps": stamps, "lost": {name: one.lost for name, one in histories.items()}}


def main(service: str, *records: str) -> None:
    """Attach, watch, report."""
    print(json.dumps(watch(attach_to(service).store, records)))


if __name__ == "__main__":
    main(*sys.argv[1:])
