"""Helper process: collects when each value of some records was measured and written, in a running service.

    python -m bench.record_timestamps SERVICE RECORD...        until standard input ends

Every slot of a record's ring holds the instants at which its value was measured and written. This process polls the
rings faster than they go round: with four slots nothing is missed as long as one poll comes within three writes, and
missed writes are counted. Prints JSON: {"policy", "timestamps": {record: [[measured_ns, written_ns], ...]}, "missed":
{record: count}}; instants in ns of CLOCK_MONOTONIC.
"""

import json
import sys
import time
from collections.abc import Sequence

from bench.helpers import OBSERVER_PRIORITY, READY, has_stdin_ended, request_realtime
from vision_core.net.control import attach_to
from vision_core.rtdb.slots import BEGUN, ENDED, MEASURED, WRITTEN, SlotReader
from vision_core.rtdb.store import Store

POLL_EVERY_S = 0.001

Timestamps = tuple[int, int]
"""When a value was measured, and when it was written [ns of CLOCK_MONOTONIC]."""


class WriteHistory:
    """The timestamps of all writes of one record since this object was made, and how many were missed."""

    def __init__(self, record: SlotReader) -> None:
        self._record = record
        self._seen = record.sequence
        self.timestamps: list[Timestamps] = []
        self.missed = 0

    def poll(self) -> None:
        """Collect the timestamps of all writes since the last poll."""
        head = self._record.sequence
        oldest = max(self._seen + 1, head - self._record.spec.slots + 2)  # the slot before may be overwritten just now
        self.missed += oldest - self._seen - 1
        for sequence in range(oldest, head + 1):
            if (timestamps := timestamps_of(self._record, sequence)) is None:
                self.missed += 1
            else:
                self.timestamps.append(timestamps)
        self._seen = head


def timestamps_of(record: SlotReader, sequence: int) -> Timestamps | None:
    """The timestamps of the write with a sequence number; None when its slot was overwritten."""
    fields = record._fields[sequence % record.spec.slots]
    copy = fields.tolist()
    if copy[BEGUN] != sequence or copy[ENDED] != sequence or fields[BEGUN] != sequence:
        return None
    return copy[MEASURED], copy[WRITTEN]


def watch(store: Store, records: Sequence[str]) -> dict[str, object]:
    """Poll records until standard input ends. Returns the report."""
    policy = request_realtime(OBSERVER_PRIORITY)
    histories = {name: WriteHistory(store.reader(name)) for name in records}
    print(READY, flush=True)
    while not has_stdin_ended():
        time.sleep(POLL_EVERY_S)
        for history in histories.values():
            history.poll()
    timestamps = {name: history.timestamps for name, history in histories.items()}
    missed = {name: history.missed for name, history in histories.items()}
    return {"policy": policy, "timestamps": timestamps, "missed": missed}


def main(service: str, *records: str) -> None:
    """Attach to a service's database, poll its records, print the report."""
    print(json.dumps(watch(attach_to(service).store, records)))


if __name__ == "__main__":
    main(*sys.argv[1:])
