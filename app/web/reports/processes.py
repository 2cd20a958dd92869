"""The processes of the service."""

from app.web.blackboard import ServiceSnapshot
from app.web.reports.base import Report
from vision_core.rtdb import records


class ProcessReport(Report):
    """One process of the service; ``/api/v1/tasks`` reports what runs in it."""

    name: str
    state: str
    """waiting, starting, running, restarting, disabled, done or stopped."""
    pid: int | None
    """Process id; null while it does not run."""
    restarts: int
    """Restarts since the start of the service."""
    detail: str
    """The reason for the last restart, or the progress of the compiler."""


def processes_from(snapshot: ServiceSnapshot) -> list[ProcessReport]:
    """Every process that the supervisor knows."""
    processes = snapshot.of(records.PROCESSES)
    return [
        ProcessReport(**{key: getattr(process, key) for key in ProcessReport.model_fields})
        for process in (processes.value.processes if processes else ())
    ]
