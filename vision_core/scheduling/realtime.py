"""What a process asks of the kernel to keep time, and what it gets.

SCHED_FIFO needs the right to it (root, CAP_SYS_NICE, or ``ulimit -r``), locked memory the right to that (CAP_IPC_LOCK,
or ``ulimit -l``). Without them everything works, later: each refusal is a sentence for the log, /readyz and the page.
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

MCL_CURRENT, MCL_FUTURE, MCL_ONFAULT = 1, 2, 4
M_TRIM_THRESHOLD, M_MMAP_MAX = -1, -4
PR_SET_TIMERSLACK = 29
CAP_IPC_LOCK, CAP_SYS_NICE = 14, 23
TIMER_ABSTIME = 1
NICE = -10
"""Of a process that may not have real-time priority but may be nice to itself."""
BEFORE = os.getpriority(os.PRIO_PROCESS, 0)
"""The nice value that this process was started with."""
ORDINARY = "ordinary"


@dataclass(frozen=True, slots=True)
class GrantedPolicy:
    """What a process has got from the kernel."""

    policy: str
    """"FIFO 45", "nice -10" or "ordinary"."""
    refused: str
    """Why it is not what was asked for; empty when it is."""


@dataclass(frozen=True, slots=True)
class Memory:
    """Whether memory stays where it is."""

    locked: bool
    refused: str


def ask_priority(priority: int) -> GrantedPolicy:
    """SCHED_FIFO at a priority for this process (its children start without it); 0 asks for nothing special.

    Where it is refused: the best nice value there is.
    """
    if priority == 0:
        os.sched_setscheduler(0, os.SCHED_OTHER | os.SCHED_RESET_ON_FORK, os.sched_param(0))
        with contextlib.suppress(PermissionError):
            os.setpriority(os.PRIO_PROCESS, 0, BEFORE)
        return GrantedPolicy(ORDINARY, "")
    try:
        os.sched_setscheduler(0, os.SCHED_FIFO | os.SCHED_RESET_ON_FORK, os.sched_param(priority))
    except OSError as error:
        return GrantedPolicy(_nicer(), f"SCHED_FIFO {priority} is refused: {_why(error)}")
    return GrantedPolicy(f"FIFO {priority}", "")


def _why(error: OSError) -> str:
    """Why SCHED_FIFO is refused."""
    if not isinstance(error, PermissionError):
        return str(error.strerror)
    if _has_capability(CAP_SYS_NICE):
        return "its control group has no share of real time"
    return f"no CAP_SYS_NICE, and ulimit -r is {resource.getrlimit(resource.RLIMIT_RTPRIO)[0]}"


def _nicer() -> str:
    with contextlib.suppress(PermissionError):
        os.setpriority(os.PRIO_PROCESS, 0, NICE)
    nice = os.getpriority(os.PRIO_PROCESS, 0)
    return f"nice {nice}" if nice else ORDINARY


def lock_memory() -> Memory:
    """Keep every page that was touched in memory, and give nothing back to the system."""
    library = ctypes.CDLL(None, use_errno=True)
    if hasattr(library, "mallopt"):  # glibc; pages given back would be missing when they are needed again
        library.mallopt(M_TRIM_THRESHOLD, -1)
        library.mallopt(M_MMAP_MAX, 0)
    soft, _ = resource.getrlimit(resource.RLIMIT_MEMLOCK)
    if soft != resource.RLIM_INFINITY and not _has_capability(CAP_IPC_LOCK):  # later pages would run into the limit
        return Memory(False, f"locking memory is refused: no CAP_IPC_LOCK, and ulimit -l is {soft // 1024} KiB")
    ctypes.set_errno(0)
    if library.mlockall(MCL_CURRENT | MCL_FUTURE | MCL_ONFAULT):
        return Memory(False, f"locking memory is refused: {os.strerror(ctypes.get_errno())}")
    return Memory(True, "")


def _has_capability(number: int) -> bool:
    """Is a capability of Linux in this process's effective set?"""
    try:
        lines = Path("/proc/self/status").read_bytes().splitlines()
        line = next(line for line in lines if line.startswith(b"CapEff:"))
    except (OSError, StopIteration):
        return False
    return bool(int(line.split()[1], 16) >> number & 1)


def stay_on(cores: Sequence[int]) -> str:
    """Run on some cores only, none means anywhere; why not, or the empty string."""
    if not cores:
        return ""
    try:
        os.sched_setaffinity(0, cores)
    except OSError as error:
        there = ", ".join(map(str, sorted(os.sched_getaffinity(0))))
        return f"cores {', '.join(map(str, cores))} are refused: {error.strerror}; there are {there}"
    return ""


class _Timespec(ctypes.Structure):
    _fields_ = (("seconds", ctypes.c_long), ("nanoseconds", ctypes.c_long))


_library = ctypes.CDLL(None)
_instant = _Timespec()


def sleep_until(instant: Instant) -> None:
    """Sleep until an instant, or a signal. The kernel is told the instant itself: no delay on the way there adds up."""
    _instant.seconds, _instant.nanoseconds = divmod(instant, NS_PER_S)
    _library.clock_nanosleep(time.CLOCK_MONOTONIC, TIMER_ABSTIME, ctypes.byref(_instant), None)


def freeze_garbage() -> None:
    """What is there is no garbage, and nobody looks for any until ``collect`` is called."""
    gc.collect()
    gc.freeze()
    gc.disable()


def exact_timers() -> None:
    """Let timers of an ordinary process be as exact as those of a real-time one (no 50 us of slack)."""
    ctypes.CDLL(None).prctl(PR_SET_TIMERSLACK, 1, 0, 0, 0)
