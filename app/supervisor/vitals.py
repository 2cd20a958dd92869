"""Is a process with an overdue heartbeat hung, or does it work, or wait for a processor? The kernel tells."""

from dataclasses import dataclass
from pathlib import Path

from vision_core.clock import NS_PER_S

ASLEEP_S = 0.2
"""A process with an overdue heartbeat that does nothing for this long is hung; one that reads a disk goes on sooner."""


@dataclass(slots=True)
class Silence:
    """What a process does while its heartbeat is overdue, from one check to the next."""

    spent: int
    """Processor time that it had used when the heartbeat became overdue [ns]."""
    last_spent: int
    """Processor time that it had used at the last check [ns]."""
    last_active: int
    """The last check at which it ran, waited for a processor, or had run since the check before [ns]."""

    def is_hung(self, pid: int, now: int, longest_run_s: float) -> bool:
        """Check again: is it stopped, or asleep, or has it computed for longer than a run may take [s]?"""
        states, spent = thread_states(pid), time_spent(pid)
        if "R" in states or spent != self.last_spent:
            self.last_active, self.last_spent = now, spent
        stopped = bool(states) and states <= {"T", "t"}
        asleep = now - self.last_active > ASLEEP_S * NS_PER_S
        return stopped or asleep or spent - self.spent > longest_run_s * NS_PER_S


def silence_of(pid: int, now: int) -> Silence:
    """The first check of a process whose heartbeat has just become overdue."""
    spent = time_spent(pid)
    return Silence(spent, spent, now)


def thread_states(pid: int) -> set[str]:
    """The kernel's letters for the states of its threads: R, running or ready; T, stopped; empty when it has ended."""
    found = set()
    for thread in _threads(pid):
        try:
            found.add((thread / "stat").read_text(errors="replace").rpartition(")")[2].split()[0])
        except (OSError, IndexError):  # the thread has ended
            continue
    return found


def time_spent(pid: int) -> int:
    """Processor time that the threads of a process have used [ns]."""
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
