"""A process that only writes heartbeats, for the supervisor's tests. Its name says what else it does."""

import sys
import time

from vision_core.scheduling.attachment import attach, monotonic

THINKING_S = 1.5
"""Three times as long as a heartbeat may be old."""


def compute(duration_s: float) -> None:
    """Use processor time [s]."""
    end = time.process_time() + duration_s
    while time.process_time() < end:
        pass


def main() -> None:
    attachment = attach()
    name = attachment.resources.process
    if name == "unborn":
        sys.exit(3)
    attachment.heartbeat(monotonic())
    if name == "job":
        print("1 of 1: nothing", flush=True)
        return
    if name in ("faller", "attempt"):
        sys.exit(3)
    while not attachment.stopping or name == "deaf":
        attachment.heartbeat(monotonic())
        time.sleep(0.02)
        if name == "chatterbox":
            print("chatter " * 1000, file=sys.stderr)
        if name == "speaker":
            print("a line", file=sys.stderr)
        while name == "looper":
            pass
        if name == "thinker":
            compute(THINKING_S)


if __name__ == "__main__":
    main()
