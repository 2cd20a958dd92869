"""Does a silent process hang, or does the machine have no time for it?"""

import os
from pathlib import Path

NS_PER_TICK = 1_000_000_000 // os.sysconf("SC_CLK_TCK")
STATE, USER, SYSTEM = 0, 11, 12
"""Places in /proc/<pid>/stat after the name."""


def wants_to_run(pid: int) -> bool:
    """Does any thread of a process run or wait for a processor? One that is stopped or waits for something does not."""
    try:
        threads = list(Path(f"/proc/{pid}/task").iterdir())
    except OSError:
        return False
    return any(_fields(thread)[STATE] == "R" for thread in threads)


def time_spent(pid: int) -> int:
    """What a process has used of the processors [ns]; 0 when it has ended."""
    fields = _fields(Path(f"/proc/{pid}"))
    return (int(fields[USER]) + int(fields[SYSTEM])) * NS_PER_TICK


def _fields(folder: Path) -> list[str]:
    """The line of a process or thread after its name; of one that has ended, all zero."""
    try:
        return (folder / "stat").read_text(errors="replace").rpartition(")")[2].split()
    except OSError:
        return ["0"] * (SYSTEM + 1)
