"""The whole service at one instant."""

from collections.abc import Iterator
from typing import Literal

from app.web.blackboard import ServiceSnapshot
from app.web.health.cause import Subject
from app.web.health.monitor import Health, HealthState
from app.web.reports.base import Report
from app.web.reports.camera import CameraReport, camera_from
from app.web.reports.clients import ClientReport, Lags, clients_from, lags_from
from app.web.reports.machine import MachineReport, machine_from
from app.web.reports.processes import ProcessReport, RestartReport, processes_from, restart_from
from app.web.reports.source import SourceReport, source_from
from app.web.reports.waiting import WaitingReport, waiting_from
from vision_core.clock import Instant, seconds_between


class Alarm(Report):
    """One cause why robots are served worse than they should be, or not at all."""

    level: Literal["error", "warning"]
    """error: it keeps robots from being served."""
    about: Subject
    """What it is about."""
    text: str
    """In plain words."""
    advice: str
    """What to do."""
    detail: str
    """The technical cause; empty when the text says all that is known."""
    first_s: float
    """Time since it was reported first [s]."""
    since_s: float
    """Time for which it has been reported without a break [s]."""


class LossReport(Report):
    """What was lost in the last minute, by the name of the task or robot; what lost nothing is missing."""

    missed: dict[str, int]
    """Releases of a task that passed without a run: images that it skipped."""
    overruns: dict[str, int]
    """Runs of a task that took longer than its budget."""
    dropped: dict[str, int]
    """Datagrams to a robot that the network refused."""


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
    """Reasons and what is worse than it should be, each with what to do."""
    losses: LossReport
    """In the last minute."""
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
    restart: RestartReport


def status_from(snapshot: ServiceSnapshot, health: Health) -> Status:
    """The status of a snapshot and its health."""
    service = snapshot.service
    return Status(
        version=service.version,
        state=health.state,
        ready=health.is_ready,
        reasons=[cause.sentence for cause in health.reasons],
        degraded=[cause.sentence for cause in health.degradations],
        alarms=list(_alarms(health, snapshot.now)),
        losses=LossReport.model_validate(health.losses, from_attributes=True),
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
        restart=restart_from(snapshot),
    )


def _alarms(health: Health, now: Instant) -> Iterator[Alarm]:
    for cause in health.causes:
        seen = health.seen.get(cause.key)
        yield Alarm(
            level="error" if cause in health.reasons else "warning",
            about=cause.about,
            text=cause.text,
            advice=cause.advice,
            detail=cause.detail,
            first_s=seconds_between(seen.first, now) if seen else 0.0,
            since_s=seconds_between(seen.since, now) if seen else 0.0,
        )
