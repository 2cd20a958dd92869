"""``/api/v1/clients``: who is connected and who waits; admitting, refusing, disconnecting."""

import ipaddress
import time
from http import HTTPStatus
from typing import Any

from fastapi import APIRouter, Request
from pydantic import ConfigDict, Field

from app.web.auth.identity import identity_of
from app.web.blackboard import Blackboard
from app.web.configuration.configuration import Configuration
from app.web.configuration.keys import ADMISSION, REFUSAL
from app.web.problems import REFUSED, RequestRefused
from app.web.reports.base import Report
from app.web.reports.changes import ChangeReport
from app.web.reports.clients import ClientReport, DatagramReport, clients_from, datagrams_from
from app.web.reports.waiting import WaitingReport, waiting_from
from app.web.routes.change import change
from vision_core.rtdb import records
from vision_core.types.objects import Team

MAX_MINUTES = 7 * 24 * 60.0


class AdmissionReport(Report):
    """An address or subnet that may connect."""

    id: int
    network: str
    team: Team | None
    """null: as any robot of both teams."""
    number: int | None
    """null: as any robot of the team."""
    until: float | None
    """Seconds since 1970; null: until it is withdrawn."""
    by: str
    """Who admitted it."""


class RefusalReport(Report):
    """An address or subnet that is turned away."""

    address: str
    by: str


class Clients(Report):
    """Everybody who is connected, waits, may connect or may not."""

    revision: int
    connected: list[ClientReport]
    waiting: list[WaitingReport]
    admissions: list[AdmissionReport]
    admitted_by_files: list[str]
    """Subnets that the settings files admit."""
    refused: list[RefusalReport]
    datagrams: DatagramReport | None
    """null: the task that serves does not report."""


class Admission(Report):
    """Who is to be admitted."""

    model_config = ConfigDict(extra="forbid")

    network: str = Field(max_length=64)
    """An address or a subnet: 192.168.1.7 or 192.168.1.0/24."""
    team: Team | None = None
    number: int | None = Field(default=None, ge=1, le=16)
    minutes: float | None = Field(default=None, gt=0.0, le=MAX_MINUTES)
    """For how long [min]; null: until it is withdrawn."""


class RefusalRequest(Report):
    """Who is to be turned away."""

    model_config = ConfigDict(extra="forbid")

    address: str = Field(max_length=64)
    """An address or a subnet."""


def client_routes(blackboard: Blackboard, configuration: Configuration) -> APIRouter:
    """Clients and who may become one."""
    router = APIRouter(prefix="/api/v1", tags=["clients"])

    @router.get("/clients")
    def clients() -> Clients:
        """Who is connected, who waits and why, who may connect and who may not."""
        snapshot, entries = blackboard.read(), configuration.entries
        return Clients(
            revision=configuration.revision,
            connected=clients_from(snapshot),
            waiting=waiting_from(snapshot),
            admissions=[
                AdmissionReport(id=int(key.removeprefix(ADMISSION)), **entry)
                for key, entry in entries.items()
                if key.startswith(ADMISSION)
            ],
            admitted_by_files=list(configuration.settings.admission.subnets),
            refused=[
                RefusalReport(address=key.removeprefix(REFUSAL), by=entry["by"])
                for key, entry in entries.items()
                if key.startswith(REFUSAL)
            ],
            datagrams=datagrams_from(snapshot),
        )

    @router.post("/admissions", responses=REFUSED, status_code=HTTPStatus.CREATED)
    def admit(admission: Admission, request: Request) -> ChangeReport:
        """Admits an address or subnet, for one robot, a team or all; who waits is accepted when it asks again."""
        network = _network(admission.network, "network")
        who = identity_of(request).name
        entry = {
            "network": network,
            "team": admission.team.value if admission.team else None,
            "number": admission.number,
            "until": time.time() + 60.0 * admission.minutes if admission.minutes else None,
            "by": who,
        }
        taken = [int(key.removeprefix(ADMISSION)) for key in configuration.entries if key.startswith(ADMISSION)]
        values: dict[str, Any] = {f"{ADMISSION}{max(taken, default=0) + 1}": entry}
        if f"{REFUSAL}{network}" in configuration.entries:
            values[f"{REFUSAL}{network}"] = None
        return change(configuration, values, request, f"admit {network}{_robot(admission)}")

    @router.delete("/admissions/{number}", responses=REFUSED)
    def withdraw(number: int, request: Request) -> ChangeReport:
        """Withdraws an admission; the sessions that it allowed end."""
        key = f"{ADMISSION}{number}"
        if key not in configuration.entries:
            raise RequestRefused(
                HTTPStatus.NOT_FOUND, "an admission", found=str(number)[:40], accepted="an id of /api/v1/clients"
            )
        return change(
            configuration, {key: None}, request, f"withdraw the admission of {configuration.entries[key]['network']}"
        )

    @router.post("/refusals", responses=REFUSED, status_code=HTTPStatus.CREATED)
    def refuse(refusal: RefusalRequest, request: Request) -> ChangeReport:
        """Turns an address away, whatever admits it, and shows its requests no more."""
        network = _network(refusal.address, "address")
        return change(
            configuration, {f"{REFUSAL}{network}": {"by": identity_of(request).name}}, request, f"refuse {network}"
        )

    @router.delete("/refusals/{address:path}", responses=REFUSED)
    def forgive(address: str, request: Request) -> ChangeReport:
        """Turns an address away no longer."""
        key = f"{REFUSAL}{address}"
        if key not in configuration.entries:
            raise RequestRefused(
                HTTPStatus.NOT_FOUND, "a refused address", found=address[:80], accepted="one of /api/v1/clients"
            )
        return change(configuration, {key: None}, request, f"refuse {address} no longer")

    @router.delete("/clients/{team}/{number}", responses=REFUSED, status_code=HTTPStatus.NO_CONTENT)
    def disconnect(team: Team, number: int) -> None:
        """Ends the session of a robot's program; it may connect again."""
        serving = blackboard.read().recent(records.SERVING)
        for client in serving.value.clients if serving else ():
            if (client.team, client.number) == (team, number):
                configuration.end_session(team, number, client.since)
                return
        raise RequestRefused(
            HTTPStatus.NOT_FOUND, "a client", found=f"{team.value} {number}"[:40], accepted="one that is connected"
        )

    return router


def _network(text: str, field: str) -> str:
    """An address or subnet in its usual form. Raises RequestRefused."""
    try:
        network = ipaddress.ip_network(text.strip())
    except ValueError as error:
        raise RequestRefused(
            HTTPStatus.UNPROCESSABLE_ENTITY,
            "an address",
            found=f"{text[:64]!r}: {error}",
            accepted="an address or a subnet: 192.168.1.7 or 192.168.1.0/24",
            field=field,
        ) from None
    return str(network.network_address) if network.prefixlen == network.max_prefixlen else str(network)


def _robot(admission: Admission) -> str:
    """As which robot: " as blue 3"; empty: as any."""
    words = [admission.team.value if admission.team else "", str(admission.number or "")]
    robot = " ".join(filter(None, words))
    return f" as {robot}" if robot else ""
