"""A process that only beats, for the supervisor's tests. Its name says what else it does."""

import sys
import time

from vision_core.scheduling.attachment import attach, monotonic


def main() -> None:
    attachment = attach()
    name = attachment.resources.process
    if name == "unborn":
        sys.exit(3)
    attachment.heartbeat(monotonic())
    if name == "job":
        print("1 of 1: nothing", flush=True)
        return
    if name == "faller":
        sys.exit(3)
    while not attachment.stopping or name == "deaf":
        attachment.heartbeat(monotonic())
        time.sleep(0.02)
        while name == "looper":
            pass


if __name__ == "__main__":
    main()
