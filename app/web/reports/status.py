"""The whole service at one instant."""

from app.web.blackboard import ServiceSnapshot
from app.web.health.monitor import Health, HealthState
from app.web.reports.base import Report
from app.web.reports.camera import CameraReport, camera_from
from app.web.reports.clients import ClientReport, Lags, clients_from, lags_from
from app.web.reports.machine import MachineReport, machine_from
from app.web.reports.processes import ProcessReport, processes_from
from app.web.reports.source import SourceReport, source_from
from app.web.reports.waiting import WaitingReport, waiting_from
from vision_core.clock import seconds_between


class Alarm(Report):
    """One cause of worse service."""

    text: str
    """In plain words."""
    detail: str
    """The technical cause; empty when the text says all that is known."""


class Status(Report):
    """The whole service at one instant."""

    version: str
    state: HealthState
    """ready; degraded: robots are served, but worse than they should be; not_ready: no robot is served."""
    ready: bool
    """Robots are served: true for ready and degraded."""
    reasons: list[str]
    """Why no robot is served, a sentence each; empty when ready is true."""
    degraded: list[str]
    """What is worse than it should be: text and detail of each alarm in one sentence."""
    alarms: list[Alarm]
    """What is worse than it should be."""
    uptime_s: float
    """Time since the start of the service [s], which is also the clock of the protocol."""
    http: str
    """Address of the page."""
    udp: str
    """Address to which clients send their init message."""
    source: SourceReport | None
    """null before the source was opened."""
    cameras: list[CameraReport]
    clients: list[ClientReport]
    """Robot programs that are connected."""
    lags: Lags
    waiting: list[WaitingReport]
    """Clients that were refused lately, those that wait to be admitted first."""
    selftest: MachineReport | None
    """null where no self-test was made."""
    processes: list[ProcessReport]


def status_from(snapshot: ServiceSnapshot, health: Health) -> Status:
    """The status of a snapshot and its health."""
    service = snapshot.service
    return Status(
        version=service.version,
        state=health.state,
        ready=health.is_ready,
        reasons=list(health.reasons),
        degraded=health.sentences,
        alarms=[Alarm(text=cause.text, detail=cause.detail) for cause in health.degradations],
        uptime_s=seconds_between(service.boot, snapshot.now),
        http=service.http,
        udp=service.udp,
        source=source_from(snapshot),
        cameras=[camera_from(snapshot)],
        clients=clients_from(snapshot),
        lags=lags_from(snapshot),
        waiting=waiting_from(snapshot),
        selftest=machine_from(snapshot),
        processes=processes_from(snapshot),
    )
