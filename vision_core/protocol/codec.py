"""Messages <-> datagrams. Decoding gives a message or None, never an exception.

Clients are read tolerantly: any letter case, any white space, a trailing newline or NUL, and three ways
to write the robot in ``init``. The server writes one canonical form. Server messages are read tolerantly
too: what follows the parts we know is passed over, as a later version may append.
"""

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from types import MappingProxyType

from vision_core.protocol.error_codes import ErrorName
from vision_core.protocol.messages import (
    MAX_NUMBER,
    US_PER_S,
    Ball,
    Bye,
    Command,
    Error,
    Faulty,
    Init,
    InitReply,
    Lag,
    Request,
    See,
    ServerMessage,
    Warn,
)
from vision_core.protocol.options import encode_options, options_from_forms
from vision_core.protocol.s_expressions import SPACE, Form, integer, parse_forms, real
from vision_core.types.objects import Team

MAX_COMMAND = 1024
"""Longer datagrams of clients are dropped before anything is looked at [bytes]."""
MAX_ANSWER = 2048
"""Longer datagrams of servers are dropped [bytes]; ours have at most 1400."""
MODES = frozenset({"before_kick_off", "play_on", "time_over"})
"""Play modes in a server's answer to ``init``."""
SERVER_WORDS = frozenset({b"see", b"hear", b"error", b"warning", b"ok", b"challenge", b"pong"})
"""What begins like this was said by a server and gets no answer."""

MS_PER_S = 1000
_TEAMS = {team.value: team for team in Team}
_HEAD = re.compile(rb"\(\s*+([A-Za-z_]*+)")
_SEE = re.compile(
    rb"\(see\s++([0-9]{1,10})(?:\.([0-9]{0,6}+)[0-9]*+)?+"
    rb"\s++\(\(edge\)\s*+((?:[!-'*-~][0-9A-Fa-f]{2})*+)[^()]*+\)"
    rb"\s*+\(\(ball\)\s++(-?[0-9]{1,3})\s++(-?[0-9]{1,3})\s++(-?[0-9]{1,3})\s*+\).*\)",
    re.DOTALL,
)
_TIME = re.compile(rb"([0-9]{1,10})(?:\.([0-9]{0,6})[0-9]*)?")
_NAME = re.compile(r"[a-z_]{1,39}")


def decode_commands(datagram: bytes) -> Request | None:
    """What a client's datagram asks for; None when it deserves no answer."""
    if len(datagram) > MAX_COMMAND:
        return None
    body = datagram.strip(SPACE + b"\0") if datagram.endswith(b"\0") else datagram.strip(SPACE)
    head = _HEAD.match(body)
    if head is None or head.group(1).lower() in SERVER_WORDS:
        return None
    nul = datagram.endswith(b"\0")
    forms = parse_forms(body)
    if forms is None:
        return Request((Faulty(ErrorName.ILLEGAL_FORM),), nul)
    if any(len(form) == 4 and form[0] == "init" and form[3] in MODES for form in forms):
        return None
    return Request(tuple(_command(form) for form in forms), nul)


def decode_message(datagram: bytes) -> ServerMessage | None:
    """What a server says; None for anything that we do not understand."""
    if len(datagram) > MAX_ANSWER:
        return None
    body = datagram.strip(SPACE + b"\0")
    if body.startswith(b"(see"):
        return _see(body)
    forms = parse_forms(body)
    if forms is None or len(forms) != 1:
        return None
    match forms[0]:
        case ("init", str(team), str(number), str(mode), *_):
            named, counted = _team(team), _number(number)
            return InitReply(named, counted, mode) if named and counted and _NAME.fullmatch(mode) else None
        case ("error", str(name)) if _NAME.fullmatch(name):
            return Error(name)
        case ("warning", str(name)) if _NAME.fullmatch(name):
            return Warn(name)
    return None


def encode(message: Init | Bye | Lag | InitReply | Error | Warn) -> bytes:
    """The canonical datagram of a message, without NUL."""
    match message:
        case Init(team, number, options):
            asked = encode_options(options)
            return f"(init {team} {number}{' ' if asked else ''}{asked})".encode("ascii")
        case Bye(None, None):
            return b"(bye)"
        case Bye(team, number):
            return f"(bye {team} {number})".encode("ascii")
        case Lag():
            return _encode_lag(message).encode("ascii")
        case InitReply(team, number, mode):
            return f"(init {team} {number} {mode})".encode("ascii")
        case Error(name):
            return f"(error {name})".encode("ascii")
        case Warn(name):
            return f"(warning {name})".encode("ascii")


def encode_see(see: See, time: str = "ms") -> bytes:
    """The datagram of a ``see`` with three (ms) or six (us) decimals; spaces are exact."""
    seconds, us = divmod(see.time_us, US_PER_S)
    decimals = b"%03d" % (us // 1000) if time == "ms" else b"%06d" % us
    ball = see.ball
    return b"(see %d.%s ((edge) %s) ((ball) %d %d %d))" % (
        seconds,
        decimals,
        see.edges,
        ball.px,
        ball.direction_deg,
        ball.size_deg,
    )


def _see(body: bytes) -> See | None:
    match = _SEE.fullmatch(body)
    if match is None:
        return None
    seconds, decimals, edges, px, direction, size = match.groups()
    return See(_time_us(seconds, decimals), edges, Ball(int(px), int(direction), int(size)))


def _time_us(seconds: bytes, decimals: bytes | None) -> int:
    return int(seconds) * US_PER_S + int((decimals or b"").ljust(6, b"0"))


def _encode_lag(lag: Lag) -> str:
    robot = "" if lag.team is None else f"{lag.team} {lag.number} "
    seconds, us = divmod(lag.time_us, US_PER_S)
    client = "-" if lag.client_s is None else f"{lag.client_s * MS_PER_S:.3f}"
    return f"(lag {robot}{seconds}.{us:06d} {lag.hold_s * MS_PER_S:.3f} {client})"


def _team(word: str | Form) -> Team | None:
    return _TEAMS.get(word) if isinstance(word, str) else None


def _number(word: str | Form) -> int | None:
    number = integer(word)
    return number if number is not None and 1 <= number <= MAX_NUMBER else None


def _inside(name: str, part: str | Form) -> str | Form:
    """``blue`` of ``(team blue)``; anything else stays."""
    return part[1] if isinstance(part, tuple) and len(part) == 2 and part[0] == name else part


def _command(form: Form) -> Command:
    if not form or not isinstance(form[0], str):
        return Faulty(ErrorName.ILLEGAL_FORM)
    decoder = COMMANDS.get(form[0])
    return decoder(form[1:]) if decoder else Faulty(ErrorName.UNKNOWN_COMMAND)


def _robot(parts: Sequence[str | Form]) -> tuple[Team, int] | Faulty:
    team = _team(_inside("team", parts[0])) if parts else None
    if team is None:
        return Faulty(ErrorName.ILLEGAL_TEAM)
    number = _number(_inside("number", parts[1])) if len(parts) > 1 else None
    return Faulty(ErrorName.ILLEGAL_NUMBER) if number is None else (team, number)


def _init(parts: Sequence[str | Form]) -> Command:
    robot = _robot(parts)
    if isinstance(robot, Faulty):
        return robot
    found = options_from_forms(parts[2:])
    if isinstance(found, ErrorName):
        return Faulty(found)
    options, unknown = found
    return Init(*robot, options, unknown)


def _bye(parts: Sequence[str | Form]) -> Command:
    if not parts:
        return Bye()
    if len(parts) != 2:
        return Faulty(ErrorName.ILLEGAL_FORM)
    robot = _robot(parts)
    return robot if isinstance(robot, Faulty) else Bye(*robot)


def _lag(parts: Sequence[str | Form]) -> Command:
    if len(parts) not in (3, 5):
        return Faulty(ErrorName.ILLEGAL_FORM)
    time, hold, client = parts[-3:]
    when = _TIME.fullmatch(time.encode("ascii")) if isinstance(time, str) else None
    hold_ms, client_ms = real(hold), real(client)
    if when is None or hold_ms is None or (client_ms is None and client != "-"):
        return Faulty(ErrorName.ILLEGAL_FORM)
    lag = Lag(_time_us(*when.groups()), hold_ms / MS_PER_S, None if client_ms is None else client_ms / MS_PER_S)
    if len(parts) == 3:
        return lag
    robot = _robot(parts)
    return robot if isinstance(robot, Faulty) else replace(lag, team=robot[0], number=robot[1])


COMMANDS: Mapping[str, Callable[[Sequence[str | Form]], Command]] = MappingProxyType(
    {"init": _init, "bye": _bye, "lag": _lag}
)
"""Every command of version 1."""
