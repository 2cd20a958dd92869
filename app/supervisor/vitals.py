"""Does a silent process hang, or does the machine have no time for it?"""

from dataclasses import dataclass
from pathlib import Path

from vision_core.clock import NS_PER_S

ASLEEP_S = 0.2
"""A silent process that has done nothing for so long hangs: one that reads a disk goes on sooner."""


@dataclass(slots=True)
class Silence:
    """What a process does while its beat stays away, from look to look."""

    spent: int
    """What it had used of the processors when its beat had stayed away for too long [ns]."""
    last_spent: int
    last_lived: int
    """When it was last seen to run, to wait for a processor, or to have run since the look before [ns]."""

    def is_hung(self, pid: int, now: int, longest_run_s: float) -> bool:
        """Look again. A process hangs when it is stopped, sleeps on, or has computed for too long."""
        states, spent = thread_states(pid), time_spent(pid)
        if "R" in states or spent != self.last_spent:
            self.last_lived, self.last_spent = now, spent
        stopped = bool(states) and states <= {"T", "t"}
        asleep = now - self.last_lived > ASLEEP_S * NS_PER_S
        return stopped or asleep or spent - self.spent > longest_run_s * NS_PER_S


def silence_of(pid: int, now: int) -> Silence:
    """The beginning of a silence."""
    spent = time_spent(pid)
    return Silence(spent, spent, now)


def thread_states(pid: int) -> set[str]:
    """Letters of what its threads do: R runs or waits for a processor, T is stopped; none when it has ended."""
    found = set()
    for thread in _threads(pid):
        try:
            found.add((thread / "stat").read_text(errors="replace").rpartition(")")[2].split()[0])
        except (OSError, IndexError):  # this one has ended
            continue
    return found


def time_spent(pid: int) -> int:
    """What the threads of a process have used of the processors [ns]."""
    spent = 0
    for thread in _threads(pid):
        try:
            spent += int((thread / "schedstat").read_text().split()[0])
        except (OSError, IndexError, ValueError):
            continue
    return spent


def _threads(pid: int) -> list[Path]:
    try:
        return list(Path(f"/proc/{pid}/task").iterdir())
    except OSError:
        return []
