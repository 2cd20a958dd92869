"""Who goes first: the supervisor, and whoever takes a place. Where the kernel refuses, they take their turn."""

import contextlib
import os
from pathlib import Path

OWN = 91
"""Real-time priority of the supervisor, above that of every task: it only waits."""
HURRIED = 1
"""Of a spare until it beats in its new place: before all that is ordinary, after every task."""


def go_first() -> None:
    """Let no load delay what this process does; what it starts is ordinary."""
    with contextlib.suppress(OSError):
        os.sched_setscheduler(0, os.SCHED_FIFO | os.SCHED_RESET_ON_FORK, os.sched_param(OWN))


def hurry(pid: int) -> None:
    """Let a spare prepare before other work. Round robin marks it: tasks that ask for real time get FIFO."""
    with contextlib.suppress(OSError):
        os.sched_setscheduler(pid, os.SCHED_RR | os.SCHED_RESET_ON_FORK, os.sched_param(HURRIED))


def hurry_to_end(pid: int) -> None:
    """The same for the ordinary threads of a process that was killed: it has ended when the last of them has."""
    for thread in (int(path.name) for path in Path("/proc").glob(f"{pid}/task/*")):
        with contextlib.suppress(OSError):
            if os.sched_getscheduler(thread) & ~os.SCHED_RESET_ON_FORK in (os.SCHED_OTHER, os.SCHED_BATCH):
                hurry(thread)


def settle(pid: int) -> None:
    """End the hurry of a process that has not asked for a priority of its own."""
    with contextlib.suppress(OSError):
        if os.sched_getscheduler(pid) & ~os.SCHED_RESET_ON_FORK == os.SCHED_RR:
            os.sched_setscheduler(pid, os.SCHED_OTHER | os.SCHED_RESET_ON_FORK, os.sched_param(0))
