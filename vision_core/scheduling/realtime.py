"""What a process asks of the kernel in order to keep time, and what it is granted.

SCHED_FIFO needs the right to it (root, CAP_SYS_NICE, or ``ulimit -r``), locked memory the right to that (CAP_IPC_LOCK,
or ``ulimit -l``). Without them everything works, but later: each ``Refusal`` is
shown in the log, at /readyz and on the page.
"""

import contextlib
import ctypes
import gc
import os
import resource
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from vision_core.clock import NS_PER_S, Instant
from vision_core.rtdb.infos import Refusal, RefusalKind

MCL_CURRENT, MCL_FUTURE, MCL_ONFAULT = 1, 2, 4
M_TRIM_THRESHOLD, M_MMAP_MAX = -1, -4
PR_SET_TIMERSLACK = 29
CAP_IPC_LOCK, CAP_SYS_NICE = 14, 23
TIMER_ABSTIME = 1
NICE = -10
"""Asked for where real-time priority is refused."""
INITIAL_NICE = os.getpriority(os.PRIO_PROCESS, 0)
"""The nice value that this process was started with."""
ORDINARY = "ordinary"


@dataclass(frozen=True, slots=True)
class GrantedPolicy:
    """The scheduling policy of a process."""

    policy: str
    """"FIFO 45", "nice -10" or "ordinary"."""
    refusal: Refusal | None
    """Why it is not the policy that was asked for; None when it is."""


def ask_priority(priority: int) -> GrantedPolicy:
    """Ask for SCHED_FIFO at a priority for this process (its children start without it); 0: the ordinary policy.

    Where SCHED_FIFO is refused, the process gets the best nice value that is allowed.
    """
    if priority == 0:
        os.sched_setscheduler(0, os.SCHED_OTHER | os.SCHED_RESET_ON_FORK, os.sched_param(0))
        with contextlib.suppress(PermissionError):
            os.setpriority(os.PRIO_PROCESS, 0, INITIAL_NICE)
        return GrantedPolicy(ORDINARY, None)
    try:
        os.sched_setscheduler(0, os.SCHED_FIFO | os.SCHED_RESET_ON_FORK, os.sched_param(priority))
    except OSError as error:
        return GrantedPolicy(_lower_nice(), Refusal(RefusalKind.PRIORITY, str(priority), _why(error)))
    return GrantedPolicy(f"FIFO {priority}", None)


def _why(error: OSError) -> str:
    """Why SCHED_FIFO is refused."""
    if not isinstance(error, PermissionError):
        return str(error.strerror)
    if _has_capability(CAP_SYS_NICE):
        return "its control group has no share of real time"
    return f"no CAP_SYS_NICE, and ulimit -r is {resource.getrlimit(resource.RLIMIT_RTPRIO)[0]}"


def _lower_nice() -> str:
    """Lower the nice value as far as it is allowed. Returns the policy in words."""
    with contextlib.suppress(PermissionError):
        os.setpriority(os.PRIO_PROCESS, 0, NICE)
    nice = os.getpriority(os.PRIO_PROCESS, 0)
    return f"nice {nice}" if nice else ORDINARY


def lock_memory() -> Refusal | None:
    """Lock all present and future pages into memory; returns None, or the kernel's refusal."""
    library = ctypes.CDLL(None, use_errno=True)
    if hasattr(library, "mallopt"):  # glibc; a page that was given back would cost a page fault when it is needed again
        library.mallopt(M_TRIM_THRESHOLD, -1)
        library.mallopt(M_MMAP_MAX, 0)
    soft, _ = resource.getrlimit(resource.RLIMIT_MEMLOCK)
    if soft != resource.RLIM_INFINITY and not _has_capability(CAP_IPC_LOCK):  # later pages would run into the limit
        return Refusal(RefusalKind.MEMORY, "", f"no CAP_IPC_LOCK, and ulimit -l is {soft // 1024} KiB")
    ctypes.set_errno(0)
    if library.mlockall(MCL_CURRENT | MCL_FUTURE | MCL_ONFAULT):
        return Refusal(RefusalKind.MEMORY, "", os.strerror(ctypes.get_errno()))
    return None


def _has_capability(number: int) -> bool:
    """Has this process a capability of Linux, in its effective set?"""
    try:
        lines = Path("/proc/self/status").read_bytes().splitlines()
        line = next(line for line in lines if line.startswith(b"CapEff:"))
    except (OSError, StopIteration):
        return False
    return bool(int(line.split()[1], 16) >> number & 1)


def stay_on(cores: Sequence[int]) -> Refusal | None:
    """Run on these cores only, no cores meaning any; None when that is granted."""
    if not cores:
        return None
    try:
        os.sched_setaffinity(0, cores)
    except OSError as error:
        available = ", ".join(map(str, sorted(os.sched_getaffinity(0))))
        asked = ", ".join(map(str, cores))
        return Refusal(RefusalKind.CORES, asked, f"{error.strerror}; there are cores {available}")
    return None


class _Timespec(ctypes.Structure):
    _fields_ = (("seconds", ctypes.c_long), ("nanoseconds", ctypes.c_long))


_library = ctypes.CDLL(None)
_instant = _Timespec()


def sleep_until(instant: Instant) -> None:
    """Sleep until an instant, or a signal. The kernel gets the instant, not a duration: no delay adds to it."""
    _instant.seconds, _instant.nanoseconds = divmod(instant, NS_PER_S)
    _library.clock_nanosleep(time.CLOCK_MONOTONIC, TIMER_ABSTIME, ctypes.byref(_instant), None)


def freeze_garbage() -> None:
    """Exempt all present objects from garbage collection, and collect only when ``gc.collect`` is called."""
    gc.collect()
    gc.freeze()
    gc.disable()


def exact_timers() -> None:
    """Make timers of an ordinary process as exact as those of a real-time one: without 50 us of slack."""
    ctypes.CDLL(None).prctl(PR_SET_TIMERSLACK, 1, 0, 0, 0)
