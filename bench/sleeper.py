"""Asks one core for a nap again and again, and prints when it overslept: then the machine stood still.

    python bench/sleeper.py CORE [NAP_S WORTH_TELLING_S]        until standard input ends

With real-time priority, where it may have it, nothing that runs on the core can delay it: only the machine can.
Prints JSON: ``{"policy", "naps", "overslept": [[woke_s, late_s], ...]}``, of naps that were late by more than is worth
telling: 2 ms for naps of 1 ms, unless something finer is asked for.
"""

import contextlib
import gc
import json
import os
import select
import sys
import time

NAP_S = 0.001
WORTH_TELLING_S = 0.002
PRIORITY = 90
LOOK_EVERY_S = 0.01
"""At standard input."""


def main(core: int, nap_s: float = NAP_S, worth_telling_s: float = WORTH_TELLING_S) -> None:
    """Sleep until standard input ends."""
    os.sched_setaffinity(0, {core})
    with contextlib.suppress(PermissionError):
        os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(PRIORITY))
    policy = "SCHED_FIFO" if os.sched_getscheduler(0) == os.SCHED_FIFO else "SCHED_OTHER"
    poller = select.poll()
    poller.register(sys.stdin, select.POLLIN)
    gc.disable()
    between_looks = max(round(LOOK_EVERY_S / nap_s), 1)
    overslept: list[tuple[float, float]] = []
    naps = 0
    while naps % between_looks or not poller.poll(0):
        asked = time.monotonic()
        time.sleep(nap_s)
        woke = time.monotonic()
        naps += 1
        if woke - asked - nap_s > worth_telling_s:
            overslept.append((woke, woke - asked - nap_s))
    print(json.dumps({"policy": policy, "naps": naps, "overslept": overslept}))


if __name__ == "__main__":
    main(int(sys.argv[1]), *map(float, sys.argv[2:4]))
