"""How well does this machine keep time? Wake-ups of one process that sleeps on an absolute grid.

    python -m vision_core.scheduling.selftest        prints the result as JSON

The result is a class. A: p99 of the lateness is under 0.2 ms, any camera can be served. B: under 2 ms, enough for 30
frames a second. C: worse, frames will be late when the machine has other work.
"""

import json
import os
import sys
import time
from dataclasses import asdict

from vision_core.clock import NS_PER_S, NS_PER_US, Instant
from vision_core.rtdb.infos import SelfTest
from vision_core.scheduling.attachment import end_with
from vision_core.scheduling.realtime import ask_priority, exact_timers, freeze_garbage, lock_memory, sleep_until

DURATION_S = 2.0
PERIOD_NS = NS_PER_S // 200
PRIORITY = 50
"""The same as of the task ``capture``."""
GRADES = (("A", 200e3), ("B", 2e6))
"""Class, and the limit of its p99 [ns]."""
WARM_UP = 10
"""Wake-ups at the beginning that are not counted."""


def measure(duration_s: float = DURATION_S) -> SelfTest:
    """Sleep and wake for a duration [s] in this process, which then has real-time priority, if granted."""
    freeze_garbage()
    exact_timers()
    memory, granted = lock_memory(), ask_priority(PRIORITY)
    wakeups = max(round(duration_s * NS_PER_S / PERIOD_NS), 1)
    late = [0] * (WARM_UP + wakeups)
    due = time.monotonic_ns()
    for index in range(len(late)):
        due += PERIOD_NS
        sleep_until(Instant(due))
        late[index] = time.monotonic_ns() - due
        due += max(late[index], 0) // PERIOD_NS * PERIOD_NS  # periods that passed meanwhile are skipped
    counted = sorted(late[WARM_UP:])
    p99 = counted[min(int(0.99 * len(counted)), len(counted) - 1)]
    return SelfTest(
        grade=next((grade for grade, limit in GRADES if p99 < limit), "C"),
        policy=granted.policy,
        refused=str(granted.refusal or ""),
        memory_locked=memory is None,
        memory_refused=str(memory or ""),
        wakeups=wakeups,
        lateness_median_us=counted[len(counted) // 2] / NS_PER_US,
        lateness_p99_us=p99 / NS_PER_US,
        lateness_max_us=counted[-1] / NS_PER_US,
    )


def in_words(result: SelfTest) -> str:
    """One line for a log."""
    memory = "memory is locked" if result.memory_locked else result.memory_refused
    policy = result.policy + (f" ({result.refused})" if result.refused else "")
    return (
        f"this machine keeps time in class {result.grade}: wake-ups are late by {result.lateness_median_us:.0f} us "
        f"(median), {result.lateness_p99_us:.0f} us (p99), {result.lateness_max_us:.0f} us (max); {policy}; {memory}"
    )


def main() -> None:
    """Measure in this process and print the result as JSON; a duration in seconds may be given."""
    end_with(os.getppid())
    print(json.dumps(asdict(measure(float(sys.argv[1]) if len(sys.argv) > 1 else DURATION_S))))


if __name__ == "__main__":
    main()
