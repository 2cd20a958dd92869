"""What client and server say to each other: frozen records, no bytes."""

from dataclasses import dataclass
from typing import TypeAlias

from vision_core.protocol.error_codes import ErrorName
from vision_core.protocol.options import PAPER_OPTIONS, Options
from vision_core.types.objects import Team

US_PER_S = 1_000_000
MAX_NUMBER = 16
"""Robots per team that the letters of ``(types number)`` can tell apart."""
MAX_LAG_S = 10.0
"""A client's report of more than this is no lag but a mistake."""
NOTHING_PX = 0xFF
"""An edge of ``ff`` pixels: nothing within range."""


@dataclass(frozen=True, slots=True)
class Init:
    """``(init blue 3 ...)``: a client asks for a robot's views."""

    team: Team
    number: int
    options: Options = PAPER_OPTIONS
    unknown_options: bool = False
    """A client of a higher version asked for something that we do not know."""


@dataclass(frozen=True, slots=True)
class Bye:
    """``(bye)``, or ``(bye blue 3)`` from a socket that holds several robots."""

    team: Team | None = None
    number: int | None = None


@dataclass(frozen=True, slots=True)
class Lag:
    """``(lag Time Hold Client)``, or ``(lag blue 3 Time Hold Client)``: a client reports its share of the lag."""

    time_us: int
    """Time of the newest ``see``."""
    hold_s: float
    """How long after its arrival this report was sent."""
    client_s: float | None
    """From a view's arrival to when the client's program had used it; None: not known."""
    team: Team | None = None
    number: int | None = None


@dataclass(frozen=True, slots=True)
class Faulty:
    """A command that deserves an error."""

    error: ErrorName


Command: TypeAlias = Init | Bye | Lag | Faulty


@dataclass(frozen=True, slots=True)
class Request:
    """One datagram of a client."""

    commands: tuple[Command, ...]
    nul: bool
    """It ended with NUL, so answers do."""


@dataclass(frozen=True, slots=True)
class InitReply:
    """``(init blue 3 play_on)``: the session is open."""

    team: Team
    number: int
    mode: str


@dataclass(frozen=True, slots=True)
class Error:
    """``(error not_admitted)``. A client keeps names that it does not know."""

    name: str


@dataclass(frozen=True, slots=True)
class Warn:
    """``(warning unknown_option)``."""

    name: str


@dataclass(frozen=True, slots=True)
class Ball:
    """The ball in a ``see``: whole pixels and degrees, in the client's sense of direction."""

    px: int
    direction_deg: int
    size_deg: int

    @property
    def hidden(self) -> bool:
        return self.px < 0


HIDDEN = Ball(-1, 0, 0)


@dataclass(frozen=True, slots=True)
class See:
    """``(see Time ((edge) EdgeString) ((ball) Distance Direction Size))``."""

    time_us: int
    """Grab of the image, since the server's start."""
    edges: bytes
    """Three characters per direction: the type and two hexadecimal digits."""
    ball: Ball

    @property
    def time_s(self) -> float:
        return self.time_us / US_PER_S


ServerMessage: TypeAlias = InitReply | See | Error | Warn
