"""``pslv check``: what a team runs before a match. It is a client like any other (``vision_core.client``)."""

from collections.abc import Iterator
from typing import NamedTuple

from vision_core.client.connecting import connect
from vision_core.client.connection import Connection
from vision_core.clock import MS_PER_S, Clock
from vision_core.errors import ConnectionRefused
from vision_core.examination.findings import Finding, bad, doubtful, good, worst
from vision_core.examination.measures import on_clock, on_lag, on_losses, on_rate, on_sight, watch
from vision_core.examination.way import own_address, place_of, why_silent
from vision_core.models.mirror import MM_PER_M
from vision_core.protocol.error_codes import ErrorCode
from vision_core.protocol.options import Options
from vision_core.types.objects import Team

FEWEST_VIEWS = 3
"""Fewer say nothing about losses and lag."""
ASKED = Options(extras=("seq", "age"))
TYPES = {"same": "no robot", "team": "a robot's team", "number": "a robot's team and number"}


class Asked(NamedTuple):
    """Which robot's views, from where."""

    host: str
    port: int
    team: Team
    number: int
    key: str = ""

    @property
    def robot(self) -> str:
        """The robot, for people."""
        return f"{self.team} {self.number}"


def check_server(asked: Asked, clock: Clock, *, seconds: float, timeout_s: float = 5.0) -> Iterator[Finding]:
    """Connect as a robot, watch its views for some seconds, and say how that was; the last finding is the verdict."""
    found = []
    for finding in _findings(asked, clock, seconds, timeout_s):
        found.append(finding)
        yield finding
    grade = worst(found)
    names = ", ".join(finding.name for finding in found if finding.grade == grade)
    said = ("ready to play", f"playable, but look at: {names}", f"not ready: {names}")[grade]
    yield Finding("verdict", grade, said)


def _findings(asked: Asked, clock: Clock, seconds: float, timeout_s: float) -> Iterator[Finding]:
    host, port, team, number, key = asked
    try:
        place = place_of(host, port)
    except (OSError, UnicodeError) as error:
        yield bad("name", f"{host} is no computer that is known here: {error}")
        return
    own = own_address(place)
    yield good("name", f"{host} is {place.address[0]}; this computer is {own} on the way there")
    try:
        with connect(host, port, team, number, options=ASKED, key=key, timeout_s=timeout_s, clock=clock) as robot:
            yield good("admission", f"the server serves this computer as {asked.robot}{', by the key' if key else ''}")
            yield _port(robot, port)
            yield from _session(robot)
            yield from _views(robot, seconds, clock)
    except ConnectionRefused as error:
        why = _cure(error.code, asked.robot, own) if error.code else why_silent(place)
        yield bad("admission" if error.code else "answer", why or str(error))


def _port(robot: Connection, port: int) -> Finding:
    if robot.port != port:
        return good("port", f"views come from port {robot.port}")
    cause = "the answers from the session port were not heard. A firewall or an address translation is in between"
    return doubtful("port", f"views come from port {port}: {cause}; other clients need (port same)")


def _session(robot: Connection) -> Iterator[Finding]:
    """What the server has told of the session."""
    mirror, facts = robot.mirror, robot.facts
    yield good(
        "mirror", f"A {mirror.a:g}, B {mirror.b:g}, C {mirror.c:g}; its horizon is at {mirror.horizon_px:.1f} px"
    )
    if facts is None:
        yield doubtful("version", "the server speaks version 1 only: no clock, no field, no proof of an address")
        return
    yield good("version", f"the server speaks version {facts.version}; it was started as {facts.boot}")
    length_m, width_m = (side_mm / MM_PER_M for side_mm in facts.field_mm)
    yield good("field", f"{facts.venue}: {length_m:g} x {width_m:g} m between the lines")
    sight = f"{facts.fov_deg:g} deg around {facts.center_deg:g} deg, every {facts.resolution_deg:g} deg"
    yield good("views", f"they name {TYPES.get(facts.types, facts.types)}; {sight}")


def _views(robot: Connection, seconds: float, clock: Clock) -> Iterator[Finding]:
    watched = watch(robot, seconds, clock)
    yield on_sight(watched, f"{robot.init.team} {robot.init.number}")
    if len(watched.views) < FEWEST_VIEWS:
        return
    period_s = robot.facts.period_ms / MS_PER_S if robot.facts else None
    yield on_rate(watched, period_s)
    yield on_losses(watched, period_s)
    yield on_lag(watched)
    yield on_clock(robot)


def _cure(code: str, robot: str, own: str) -> str:
    """Why the server does not serve this client, and what to do; empty: see the error."""
    click = f"The referee finds {own}, {robot}, among the Waiting requests of the page Match and clicks Admit"
    admit = f"the server does not serve this computer. {click}"
    cures: dict[str, str] = {
        ErrorCode.NOT_ADMITTED: f"{admit}, or gives you the team's key (--key)",
        ErrorCode.WRONG_KEY: "this is not the key of the team that plays this color: ask the referee for its link",
        ErrorCode.ALREADY_CONNECTED: f"another program has {robot} and still runs: end it, or bring the key (--key)",
        ErrorCode.REPLACED: f"a newer program has taken {robot} over while this check ran",
        ErrorCode.ILLEGAL_NUMBER: f"the match has no {robot}",
        ErrorCode.NOT_READY: "the server still prepares: after its first start it compiles for minutes. Try again",
        ErrorCode.SERVER_FULL: "the server has no socket left: the referee ends sessions that nobody uses",
    }
    return cures.get(code, "")
