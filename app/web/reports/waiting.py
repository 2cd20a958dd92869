"""Clients that asked to connect and were refused, with what can be done."""

from app.web.blackboard import ServiceSnapshot
from app.web.reports.base import Report
from vision_core.clock import seconds_between
from vision_core.protocol.error_codes import ErrorCode
from vision_core.rtdb import records
from vision_core.types.objects import Team

REASONS = {
    ErrorCode.NOT_ADMITTED: ("its address is not admitted", "admit it, or refuse it for good"),
    ErrorCode.ALREADY_CONNECTED: (
        "another computer is connected as this robot",
        "disconnect the other program, or let this one take another number",
    ),
    ErrorCode.ILLEGAL_NUMBER: ("this number does not play", "raise match.numbers, or let it take another number"),
    ErrorCode.ILLEGAL_TEAM: ("it names no team", "its program has to ask for blue or yellow"),
    ErrorCode.ILLEGAL_MIRROR: ("its mirror does not show the whole field", "its program has to ask for another mirror"),
    ErrorCode.ILLEGAL_DRIVE: ("its robot cannot do what it asks for", "its program has to stay within the limits"),
    ErrorCode.NO_DRIVE: ("this robot is not driven over the network", "its program has to drive it by radio"),
    ErrorCode.ILLEGAL_OPTION: ("it asks for an option that does not exist", "its program has to be corrected"),
    ErrorCode.ILLEGAL_FORM: ("its message cannot be read", "its program has to be corrected"),
    ErrorCode.RATE_LIMITED: ("it asks too often", "its program has to wait between two requests"),
    ErrorCode.SERVER_FULL: ("no further client can be served", "disconnect a program that is not needed"),
}
OTHERWISE = ("its request was refused", "its program has to be corrected")


class WaitingReport(Report):
    """A client that was refused lately."""

    address: str
    port: int
    team: Team | None
    """As which robot it asked to connect; null: it said none."""
    number: int | None
    error: str
    """The word that it was told: not_admitted."""
    reason: str
    """Why, in plain words."""
    advice: str
    """What can be done."""
    can_be_admitted: bool
    """Admitting its address ends the refusal."""
    first_s: float
    """Time since it was refused first [s]."""
    last_s: float
    """Time since it was refused last [s]."""
    count: int
    """How often it was refused."""


def waiting_from(snapshot: ServiceSnapshot) -> list[WaitingReport]:
    """Refused clients, those that wait to be admitted first, then the newest first. Who is served by now is none."""
    serving = snapshot.recent(records.SERVING)
    served = {(each.address, each.team, each.number) for each in (serving.value.clients if serving else ())}
    found = []
    for refused in serving.value.refused if serving else ():
        if (refused.address, refused.team, refused.number) in served:
            continue
        reason, advice = REASONS.get(ErrorCode(refused.error), OTHERWISE)
        found.append(
            WaitingReport(
                address=refused.address,
                port=refused.port,
                team=refused.team,
                number=refused.number,
                error=refused.error,
                reason=reason,
                advice=advice,
                can_be_admitted=refused.error == ErrorCode.NOT_ADMITTED,
                first_s=seconds_between(refused.first, snapshot.now),
                last_s=seconds_between(refused.last, snapshot.now),
                count=refused.count,
            )
        )
    return sorted(found, key=lambda each: (not each.can_be_admitted, each.last_s))
