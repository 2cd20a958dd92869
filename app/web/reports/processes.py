"""The processes of the service."""

from app.web.blackboard import ServiceSnapshot
from app.web.reports.base import Report
from vision_core.rtdb import records
from vision_core.rtdb.infos import RestartStatus
from vision_core.rtdb.process_state import ProcessState, RestartState


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


class RestartReport(Report):
    """The newest request to restart the whole service."""

    state: RestartState
    """none: there was none since the start or the last restart; checking: whether the service would start is being
    found out, while it goes on; refused: it would not start, so it goes on as it is; restarting."""
    detail: str
    """Why it was refused, or how far the check is."""
    count: int
    """How often the whole service was restarted since it was started."""


def restart_from(snapshot: ServiceSnapshot) -> RestartReport:
    """What became of the newest request."""
    processes = snapshot.of(records.PROCESSES)
    restart = processes.value.restart if processes else RestartStatus()
    return RestartReport(state=restart.state, detail=restart.detail, count=snapshot.service.restarts)


def processes_from(snapshot: ServiceSnapshot) -> list[ProcessReport]:
    """Every process that the supervisor knows."""
    processes = snapshot.of(records.PROCESSES)
    return [
        ProcessReport(**{key: getattr(process, key) for key in ProcessReport.model_fields})
        for process in (processes.value.processes if processes else ())
    ]
