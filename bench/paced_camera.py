"""Helper process: publishes a simulated match at the camera's rate, as capture does, until standard input ends.

    python -m bench.paced_camera SIZE ROBOTS BLOCK EVENT

BLOCK is the descriptor of a block of memory with the record ``frame_record``, EVENT that of the event that is raised
after each frame. A frame is copied into the ring just before its instant, so that it lies in this core's caches. Prints
JSON: the scheduling policy that was granted.
"""

import json
import os
import sys
from itertools import count

import numpy as np

from bench.helpers import READY, has_stdin_ended, request_realtime
from bench.whole_loop import match_frames
from vision_core.clock import NS_PER_MS, NS_PER_S, Instant, MonotonicClock
from vision_core.rtdb.layout import RecordSpec
from vision_core.rtdb.store import Store
from vision_core.scheduling.realtime import sleep_until

RATE_HZ = 30.0
PRIORITY = 50
"""Of capture."""
COPY_NS = 4 * NS_PER_MS
"""The copy begins so long before the frame's instant."""


def frame_record(size_px: tuple[int, int]) -> RecordSpec:
    """The ring of frames. size_px: width and height."""
    return RecordSpec("frames/main", size_px[0] * size_px[1] * 3, validity_s=0.0, checksum=False)


def main(size: str, robots: int, block: int, event: int) -> None:
    """Render the frames, then publish them in a loop."""
    frames = match_frames(size, robots)
    height, width, _ = frames[0].shape
    record = frame_record((width, height))
    writer = Store([record], block).writer(record.name)
    clock = MonotonicClock()
    policy = request_realtime(PRIORITY)
    print(READY, flush=True)
    start = clock.now()
    for number in count(1):
        instant = Instant(start + round(number * NS_PER_S / RATE_HZ))
        sleep_until(Instant(instant - COPY_NS))
        pixels = np.frombuffer(writer.begin(), dtype=np.uint8)
        np.copyto(pixels, frames[number % len(frames)].reshape(-1))
        sleep_until(instant)
        writer.commit(record.capacity, instant, clock.now())
        os.eventfd_write(event, 1)
        if has_stdin_ended():
            break
    print(json.dumps({"policy": policy}))


if __name__ == "__main__":
    main(sys.argv[1], *map(int, sys.argv[2:]))
