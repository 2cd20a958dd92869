"""What client and server say to each other: frozen records, no bytes."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import TypeAlias

from vision_core.clock import US_PER_S
from vision_core.models.mirror import Mirror
from vision_core.protocol.driving import Drive, DriveLimits
from vision_core.protocol.error_codes import ErrorCode
from vision_core.protocol.options import PAPER_OPTIONS, Options
from vision_core.protocol.proofs import NO_PROOF, Proof
from vision_core.protocol.s_expressions import Form
from vision_core.types.objects import Team

MAX_NUMBER = 16
"""Robots per team that the letters of ``(types number)`` can tell apart."""
PLAY_MODES = frozenset(
    {
        "before_kick_off", "play_on", "kick_off_l", "kick_off_r", "kick_in_l", "kick_in_r", "free_kick_l",
        "free_kick_r", "corner_kick_l", "corner_kick_r", "goal_kick_l", "goal_kick_r", "goal_l", "goal_r",
        "penalty_kick_l", "penalty_kick_r", "drop_ball", "first_half_over", "pause", "time_over",
    }
)  # fmt: skip
"""SoccerServer's words; l and r are the sides that the teams defend."""
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
    """From version 2 on: some options are not known to this server."""
    proof: Proof = field(default=NO_PROOF, compare=False)
    """Not a part of what is asked for: the same init with another cookie is a repeated init."""


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
class Reconnect:
    """``(reconnect blue 3 (key K))``: a team's client goes on with a robot, from whatever address it has now."""

    team: Team
    number: int
    proof: Proof


@dataclass(frozen=True, slots=True)
class MonitorInit:
    """``(dispinit)``: a program asks for the whole field. SoccerServer's word."""

    proof: Proof = field(default=NO_PROOF, compare=False)


@dataclass(frozen=True, slots=True)
class Set:
    """``(set (rate 10))``, or ``(set blue 3 (rate 10))``: a client changes options of its session."""

    forms: tuple[str | Form, ...]
    """The options as they came: what they mean depends on those in force."""
    team: Team | None = None
    number: int | None = None


@dataclass(frozen=True, slots=True)
class Ping:
    """``(ping)``, ``(ping 7)``: is there somebody? From the server: is the client still there?"""

    id: int | None = None


@dataclass(frozen=True, slots=True)
class Sync:
    """``(sync Id T1)``: a client asks for the server's clock."""

    id: int
    t1_ns: int
    """The client's clock when it sent this."""


@dataclass(frozen=True, slots=True)
class InvalidCommand:
    """A command that is answered with an error."""

    error: ErrorCode


RobotCommand: TypeAlias = Bye | LagReport | MirrorQuery | Set | Drive
"""A command about one session; from a socket with several robots it names the robot."""
Command: TypeAlias = Init | Reconnect | MonitorInit | RobotCommand | Ping | Sync | InvalidCommand


@dataclass(frozen=True, slots=True)
class Request:
    """The commands of one datagram of a client."""

    commands: tuple[Command, ...]
    nul: bool
    """The datagram ended with NUL; the answers shall as well."""


@dataclass(frozen=True, slots=True)
class InitReply:
    """``(init blue 3 play_on)``: the session is open. From version 2 on, pairs tell what it has."""

    team: Team
    number: int
    mode: str
    facts: "SessionFacts | None" = None


@dataclass(frozen=True, slots=True)
class SessionFacts:
    """What a client of version 2 has to know about its session, as pairs of the answer to ``init``."""

    version: int
    """Of the protocol, as the server speaks it."""
    session: int
    """The UDP port that views come from."""
    lease_s: float
    """A session ends when its client has sent nothing for so long."""
    period_ms: float
    """Between two camera frames."""
    mirror: Mirror
    rmin_mm: float
    """No edge is nearer than this."""
    rmax_mm: float
    """No edge is farther than this: the diagonal of the field."""
    fov_deg: float
    center_deg: float
    resolution_deg: float
    types: str
    clock_ns: int
    """Time when this was written."""
    boot: str
    """Names this start of the server: when it changes, Time has begun anew."""
    venue: str
    field_mm: tuple[float, float]
    """Length and width between the lines."""
    drive: DriveLimits | None = None
    """What the robot can do; None: it cannot be driven."""


@dataclass(frozen=True, slots=True)
class MonitorReply:
    """``(dispinit play_on {pair})``: the monitor is sent the field with every frame."""

    mode: str
    facts: "MonitorFacts | None" = None
    """None: one is missing, as none is in the answers of this server."""


@dataclass(frozen=True, slots=True)
class MonitorFacts:
    """What a monitor is told, as pairs of the answer to ``dispinit``. As in ``SessionFacts``."""

    version: int
    lease_s: float
    period_ms: float
    clock_ns: int
    boot: str
    venue: str
    field_mm: tuple[float, float]


@dataclass(frozen=True, slots=True)
class Challenge:
    """``(challenge 0123456789abcdef01234567)``: send the init again, with ``(cookie 0123456789abcdef01234567)``."""

    cookie: str


@dataclass(frozen=True, slots=True)
class Pong:
    """``(pong)``, ``(pong 7)``: the answer to a ping, with its number."""

    id: int | None = None


@dataclass(frozen=True, slots=True)
class SyncReply:
    """``(sync Id T1 T2 T3)``: the server's clock, which is that of Time."""

    id: int
    t1_ns: int
    """As it came."""
    t2_ns: int
    """When the question arrived."""
    t3_ns: int
    """When this was sent."""


@dataclass(frozen=True, slots=True)
class Ok:
    """``(ok set)``: a command was carried out."""

    name: str


@dataclass(frozen=True, slots=True)
class Hear:
    """``(hear Time referee play_on)``: what a session of version 2 is told when it happens.

    Of the referee: a play mode, or ``vision_lost`` and ``vision_back``. Of the mirror: its constants from this Time on.
    """

    time_us: int
    sender: str
    words: tuple[str, ...]


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


UNKNOWN_OPTION = "unknown_option"
"""Name of the warning that the server does not know an option."""
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


NO_EXTRAS: Mapping[str, tuple[str, ...]] = MappingProxyType({})


@dataclass(frozen=True, slots=True)
class See:
    """``(see Time ((edge) EdgeString) ((ball) Distance Direction Size))``."""

    time_us: int
    """When the image was grabbed, since the server's start."""
    edges: bytes
    """Three characters per direction: the type and two hexadecimal digits."""
    ball: Ball
    extras: Mapping[str, tuple[str, ...]] = field(default_factory=lambda: NO_EXTRAS)
    """What follows the ball, by name: only what was asked for."""

    @property
    def time_s(self) -> float:
        """The same in seconds."""
        return self.time_us / US_PER_S


@dataclass(frozen=True, slots=True)
class ShownBall:
    """The ball on the field: origin at the center, x towards the right goal, y to the left of it. mm, mm/s."""

    x_mm: float
    y_mm: float
    vx_mm_s: float
    vy_mm_s: float


@dataclass(frozen=True, slots=True)
class ShownRobot:
    """A robot on the field, as ``ShownBall``; its heading anticlockwise from x [degrees]."""

    team: Team
    number: int | None
    """None: its marker's id is no robot's, or could not be read."""
    x_mm: float
    y_mm: float
    heading_deg: float | None
    """None: not known."""
    vx_mm_s: float
    vy_mm_s: float


@dataclass(frozen=True, slots=True)
class ShownObstacle:
    """A thing of robot size that is no robot."""

    x_mm: float
    y_mm: float
    radius_mm: float


@dataclass(frozen=True, slots=True)
class Show:
    """``(show Time {thing})``: the whole field at the grab of an image, for a monitor."""

    time_us: int
    ball: ShownBall | None
    robots: tuple[ShownRobot, ...]
    obstacles: tuple[ShownObstacle, ...]


ServerMessage: TypeAlias = (
    InitReply
    | MonitorReply
    | Show
    | Challenge
    | MirrorReply
    | See
    | Hear
    | Ping
    | Pong
    | SyncReply
    | Ok
    | ErrorReply
    | WarningReply
)
