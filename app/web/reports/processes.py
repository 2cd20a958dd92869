"""The processes of the service."""

from app.web.blackboard import ServiceSnapshot
from app.web.reports.base import Report
from vision_core.rtdb import records
from vision_core.rtdb.process_state import ProcessState


class ProcessReport(Report):
    """One process of the service; ``/api/v1/tasks`` reports what runs in it."""

    name: str
    state: ProcessState
    """waiting: not started yet; starting: no heartbeat yet; running; restarting: it has ended and is started again;
    disabled: it has crashed too often; done: it runs once and has ended well; stopped: the service ends."""
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
