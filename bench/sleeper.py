"""Asks one core for 1 ms of sleep again and again, and prints when it overslept: then the machine stood still.

    python bench/sleeper.py CORE        until standard input ends

With real-time priority, where it may have it, nothing that runs on the core can delay it: only the machine can.
Prints JSON: ``{"policy", "naps", "overslept": [[woke_s, late_s], ...]}``, of naps that were over 2 ms late.
"""

import contextlib
import json
import os
import select
import sys
import time

NAP_S = 0.001
PRIORITY = 90
WORTH_TELLING_S = 0.002


def main(core: int) -> None:
    """Sleep until standard input ends."""
    os.sched_setaffinity(0, {core})
    with contextlib.suppress(PermissionError):
        os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(PRIORITY))
    policy = "SCHED_FIFO" if os.sched_getscheduler(0) == os.SCHED_FIFO else "SCHED_OTHER"
    poller = select.poll()
    poller.register(sys.stdin, select.POLLIN)
    overslept: list[tuple[float, float]] = []
    naps = 0
    while not poller.poll(0):
        asked = time.monotonic()
        time.sleep(NAP_S)
        woke = time.monotonic()
        naps += 1
        if woke - asked - NAP_S > WORTH_TELLING_S:
            overslept.append((woke, woke - asked - NAP_S))
    print(json.dumps({"policy": policy, "naps": naps, "overslept": overslept}))


if __name__ == "__main__":
    main(int(sys.argv[1]))
