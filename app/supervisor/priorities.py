"""Which process runs first: the supervisor, and a warm spare while it takes a place.

Every request may be refused by the kernel; then the process takes its turn as an ordinary one.
"""

import contextlib
import os
from collections.abc import Iterator
from pathlib import Path

OWN = 91
"""Real-time priority of the supervisor, above that of every task: it only waits."""
HURRIED = 1
"""Of a spare until its first heartbeat in its new place: before all ordinary processes, after every real-time task."""


def go_first() -> None:
    """Give this process the highest priority; the processes that it starts are ordinary."""
    with contextlib.suppress(OSError):
        os.sched_setscheduler(0, os.SCHED_FIFO | os.SCHED_RESET_ON_FORK, os.sched_param(OWN))


@contextlib.contextmanager
def unhurried() -> Iterator[None]:
    """Compute as an ordinary process for the time of the block: above all tasks, one may only wait."""
    with contextlib.suppress(OSError):
        os.sched_setscheduler(0, os.SCHED_OTHER | os.SCHED_RESET_ON_FORK, os.sched_param(0))
    yield
    go_first()


def hurry(pid: int) -> bool:
    """Let a process or thread run before ordinary ones (SCHED_RR); False when the kernel refuses."""
    try:
        os.sched_setscheduler(pid, os.SCHED_RR | os.SCHED_RESET_ON_FORK, os.sched_param(HURRIED))
    except OSError:
        return False
    return True


def hurry_to_end(pid: int) -> None:
    """Hurry the ordinary threads of a process that was killed: it has ended only when the last of them has run."""
    for thread in (int(path.name) for path in Path("/proc").glob(f"{pid}/task/*")):
        with contextlib.suppress(OSError):
            if os.sched_getscheduler(thread) & ~os.SCHED_RESET_ON_FORK in (os.SCHED_OTHER, os.SCHED_BATCH):
                hurry(thread)


def settle(pid: int) -> None:
    """Make a hurried process ordinary again, unless it has asked for a priority of its own meanwhile."""
    with contextlib.suppress(OSError):
        if os.sched_getscheduler(pid) & ~os.SCHED_RESET_ON_FORK == os.SCHED_RR:
            os.sched_setscheduler(pid, os.SCHED_OTHER | os.SCHED_RESET_ON_FORK, os.sched_param(0))
