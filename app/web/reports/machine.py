"""How punctually this machine wakes processes: the self-test at the start."""

from app.web.blackboard import ServiceSnapshot
from app.web.reports.base import Report
from vision_core.rtdb import records


class MachineReport(Report):
    """Result of the self-test: wake-ups of one process on a grid of 5 ms, for two seconds."""

    grade: str
    """By the 99th percentile of the lateness: A below 0.2 ms, B below 2 ms, C worse."""
    policy: str
    """Scheduling policy that a real-time process gets here: "FIFO 50", "nice -10" or "ordinary"."""
    refused: str
    """Why real-time priority is refused; empty when it is granted."""
    memory_locked: bool
    """Memory of the processes stays in RAM."""
    memory_refused: str
    """Why memory cannot be locked; empty when it can."""
    wakeups: int
    """Wake-ups that were measured."""
    lateness_median_us: float
    lateness_p99_us: float
    lateness_max_us: float


def machine_from(snapshot: ServiceSnapshot) -> MachineReport | None:
    """The self-test; None where none was made."""
    test = snapshot.of(records.SELF_TEST)
    if test is None:
        return None
    return MachineReport(**{key: getattr(test.value, key) for key in MachineReport.model_fields})
