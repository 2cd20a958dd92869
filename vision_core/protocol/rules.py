"""What a server prescribes to its sessions, and what it tells them of itself."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

from vision_core.clock import Instant
from vision_core.models.mirror import MM_PER_M, Mirror
from vision_core.protocol.admission import Admission
from vision_core.protocol.driving import DriveLimits
from vision_core.protocol.lifecycle import Port, Session
from vision_core.protocol.messages import SessionFacts
from vision_core.protocol.options import HIGHEST_VERSION, Options
from vision_core.types.objects import Team

VERSION_2_LEASE_S = 15.0
"""A session of version 2 or higher ends when its client has sent nothing for so long; it can ping."""


@dataclass(frozen=True, slots=True)
class ServerFacts:
    """What clients of version 2 are told of the server."""

    ports: Mapping[Port, int]
    period_ms: float
    """Between two camera frames."""
    rmin_mm: Mapping[Team, float]
    """A robot's own radius: no edge is reported nearer."""
    venue: str
    """A name without white space and parentheses."""
    field_mm: tuple[float, float]
    """Length and width between the lines."""


@dataclass(frozen=True, slots=True)
class SessionRules:
    """What a server prescribes."""

    boot: Instant
    """Where Time is 0."""
    numbers: int
    """Robots per team that may connect."""
    lease_s: float
    """A session of version 1 ends when its client has sent nothing for so long."""
    diagonal_m: float
    """Of the field: a client's mirror must reach so far."""
    mirrors: Mapping[tuple[Team, int], Mirror]
    """Of each robot, by team and number."""
    admission: Admission
    facts: ServerFacts
    fixed: Options | None = None
    """The match gives all robots these types, fields of view, resolution and rate; None: clients choose."""
    drives: Mapping[tuple[Team, int], DriveLimits] = field(default_factory=dict)
    """The robots that clients may drive, by team and number, and what these can do."""
    keys: Mapping[Team, str] = field(default_factory=dict)
    """The digest of each team's key: see ``proofs``."""
    monitor_key: str | None = None
    """The digest of the monitors' key; None: there is none."""

    def granted(self, asked: Options) -> Options:
        """What a client gets of what it asks for. In a match no team has a better eye than the other."""
        if self.fixed is None:
            return asked
        fixed = self.fixed
        return replace(
            asked, mirror=None, types=fixed.types, fov_deg=fixed.fov_deg, center_deg=fixed.center_deg,
            resolution_deg=fixed.resolution_deg, rate_hz=fixed.rate_hz,
        )  # fmt: skip

    def fixes(self, session: Session) -> bool:
        """Does the match fix something that a session's client has asked for?"""
        return self.granted(session.init.options) != session.init.options

    def is_guest(self, session: Session) -> bool:
        """Has nobody admitted a session's address, and has the client not proven that the address is its own?"""
        proven = session.version > 1 or session.has_key
        return not proven and self.admission.is_guest(session.peer.host, session.team, session.number)

    def mirror_of(self, session: Session) -> Mirror:
        """The mirror through which a session's robot sees."""
        return session.options.mirror or self.mirrors[session.team, session.number]

    def lease_of(self, session: Session) -> float:
        """For how long a session's client may be silent [s]."""
        return self.lease_s if session.version == 1 else VERSION_2_LEASE_S

    def facts_of(self, session: Session, now: Instant) -> SessionFacts:
        """What a session of version 2 is told in the answer to its init."""
        facts, options = self.facts, session.options
        return SessionFacts(
            version=HIGHEST_VERSION,
            session=facts.ports[session.port],
            lease_s=self.lease_of(session),
            period_ms=facts.period_ms,
            mirror=self.mirror_of(session),
            rmin_mm=facts.rmin_mm[session.team],
            rmax_mm=self.diagonal_m * MM_PER_M,
            fov_deg=options.fov_deg,
            center_deg=options.center_deg,
            resolution_deg=options.resolution_deg,
            types=options.types,
            clock_ns=now - self.boot,
            boot=f"{self.boot:x}",
            venue=facts.venue,
            field_mm=facts.field_mm,
            drive=self.drives.get((session.team, session.number)),
        )
