"""Helper process: detects stalls of the machine on one core, as ``cyclictest`` does.

    python bench/stall_detector.py CORE [SLEEP_S MIN_LATE_S]        until standard input ends

It asks again and again for a short sleep, with real-time priority where that is granted. Then no process on the core
can delay its wake-ups: a late one shows that the machine itself stood still (its hypervisor ran something else).
Prints JSON: {"policy", "sleeps", "late": [[woke_s, late_s], ...]} with the wake-ups that were late by more than
MIN_LATE_S; woke_s in s of CLOCK_MONOTONIC. It imports the standard library alone, so that it is small and starts fast.
"""

import contextlib
import gc
import json
import os
import select
import sys
import time

SLEEP_S = 0.001
MIN_LATE_S = 0.002
PRIORITY = 90
CHECK_STDIN_EVERY_S = 0.01


def main(core: int, sleep_s: float = SLEEP_S, min_late_s: float = MIN_LATE_S) -> None:
    """Sleep again and again until standard input ends, then print the report."""
    os.sched_setaffinity(0, {core})
    with contextlib.suppress(PermissionError):
        os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(PRIORITY))
    policy = "SCHED_FIFO" if os.sched_getscheduler(0) == os.SCHED_FIFO else "SCHED_OTHER"
    poller = select.poll()
    poller.register(sys.stdin, select.POLLIN)
    gc.disable()
    sleeps_per_check = max(round(CHECK_STDIN_EVERY_S / sleep_s), 1)
    late: list[tuple[float, float]] = []
    sleeps = 0
    while sleeps % sleeps_per_check or not poller.poll(0):
        began = time.monotonic()
        time.sleep(sleep_s)
        woke = time.monotonic()
        sleeps += 1
        if woke - began - sleep_s > min_late_s:
            late.append((woke, woke - began - sleep_s))
    print(json.dumps({"policy": policy, "sleeps": sleeps, "late": late}))


if __name__ == "__main__":
    main(int(sys.argv[1]), *map(float, sys.argv[2:4]))
