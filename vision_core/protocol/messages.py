"""What client and server say to each other: frozen records, no bytes."""

from dataclasses import dataclass
from typing import TypeAlias

from vision_core.clock import US_PER_S
from vision_core.models.mirror import Mirror
from vision_core.protocol.error_codes import ErrorCode
from vision_core.protocol.options import PAPER_OPTIONS, Options
from vision_core.types.objects import Team

MAX_NUMBER = 16
"""Robots per team that the letters of ``(types number)`` can tell apart."""
MAX_LAG_S = 10.0
"""A report of a longer lag is taken for a mistake of the client."""
REPORT_PERIOD_S = 0.5
"""A client's lag reports that come faster than this are ignored."""
NOTHING_PX = 0xFF
"""Distance of an edge, two characters ``ff``: nothing within range [px]."""


@dataclass(frozen=True, slots=True)
class Init:
    """``(init blue 3 ...)``: a client asks for a robot's views."""

    team: Team
    number: int
    options: Options = PAPER_OPTIONS
    unknown_options: bool = False
    """A client of a higher version asked for options that this server does not know."""


@dataclass(frozen=True, slots=True)
class Bye:
    """``(bye)``, or ``(bye blue 3)`` from a socket that has several robots: a client ends its session."""

    team: Team | None = None
    number: int | None = None


@dataclass(frozen=True, slots=True)
class LagReport:
    """``(lag Time Hold Client)``, or ``(lag blue 3 Time Hold Client)``: a client reports its share of the lag."""

    time_us: int
    """Time of the newest ``see``."""
    hold_s: float
    """From the arrival of that ``see`` to the sending of this report."""
    client_s: float | None
    """From the arrival of a view until the client's program has used it; None: not known."""
    team: Team | None = None
    number: int | None = None


@dataclass(frozen=True, slots=True)
class MirrorQuery:
    """``(mirror)``, or ``(mirror blue 3)`` from a socket that has several robots: which mirror has the session?"""

    team: Team | None = None
    number: int | None = None


@dataclass(frozen=True, slots=True)
class InvalidCommand:
    """A command that is answered with an error."""

    error: ErrorCode


Command: TypeAlias = Init | Bye | LagReport | MirrorQuery | InvalidCommand


@dataclass(frozen=True, slots=True)
class Request:
    """The commands of one datagram of a client."""

    commands: tuple[Command, ...]
    nul: bool
    """The datagram ended with NUL; the answers shall as well."""


@dataclass(frozen=True, slots=True)
class InitReply:
    """``(init blue 3 play_on)``: the session is open."""

    team: Team
    number: int
    mode: str


@dataclass(frozen=True, slots=True)
class MirrorReply:
    """``(mirror A B C)``: the constants of equation 1 for a session; names the robot if the query did."""

    mirror: Mirror
    team: Team | None = None
    number: int | None = None


@dataclass(frozen=True, slots=True)
class ErrorReply:
    """``(error not_admitted)``. A client keeps names that it does not know."""

    name: str


@dataclass(frozen=True, slots=True)
class WarningReply:
    """``(warning unknown_option)``."""

    name: str


FIXED_BY_MATCH = "fixed_by_match"
"""Name of the warning that an option is not granted because the match fixes it."""


@dataclass(frozen=True, slots=True)
class Ball:
    """The ball in a ``see``: whole pixels and degrees, in the client's sense of direction."""

    px: int
    direction_deg: int
    size_deg: int

    @property
    def hidden(self) -> bool:
        """No part of the ball is visible."""
        return self.px < 0


HIDDEN = Ball(-1, 0, 0)


@dataclass(frozen=True, slots=True)
class See:
    """``(see Time ((edge) EdgeString) ((ball) Distance Direction Size))``."""

    time_us: int
    """When the image was grabbed, since the server's start."""
    edges: bytes
    """Three characters per direction: the type and two hexadecimal digits."""
    ball: Ball

    @property
    def time_s(self) -> float:
        """The same in seconds."""
        return self.time_us / US_PER_S


ServerMessage: TypeAlias = InitReply | MirrorReply | See | ErrorReply | WarningReply
