"""Messages <-> datagrams. Decoding gives a message or None, never an exception.

Commands of clients are read tolerantly: any letter case, any white space, a trailing newline or NUL, and three ways
to name the robot in ``init``. The server writes one canonical form. The client reads the server's messages
tolerantly as well: it skips whatever follows the parts that it knows, since a later version may append something.
"""

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from types import MappingProxyType

from vision_core.clock import MS_PER_S, US_PER_S
from vision_core.protocol.error_codes import ErrorCode
from vision_core.protocol.messages import (
    MAX_NUMBER,
    Ball,
    Bye,
    Command,
    ErrorReply,
    Init,
    InitReply,
    InvalidCommand,
    LagReport,
    MirrorQuery,
    MirrorReply,
    Request,
    See,
    ServerMessage,
    WarningReply,
)
from vision_core.protocol.options import encode_mirror, encode_options, mirror_from_words, options_from_forms
from vision_core.protocol.s_expressions import SPACE, Form, integer, parse_forms, real
from vision_core.types.objects import Team

MAX_COMMAND = 1024
"""Longer datagrams of clients are dropped without being read [bytes]."""
MAX_ANSWER = 2048
"""Longer datagrams of servers are dropped [bytes]; this server sends at most 1400."""
MODES = frozenset({"before_kick_off", "play_on", "time_over"})
"""Play modes in a server's answer to ``init``."""
SERVER_WORDS = frozenset({b"see", b"hear", b"error", b"warning", b"ok", b"challenge", b"pong"})
"""First words of a server's messages. A server does not answer them."""

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
    """The commands of a client's datagram; None when it gets no answer.

    That is so for a datagram that is too long, does not begin with a command, or holds a message of a server: two
    servers must not answer each other for ever.
    """
    if len(datagram) > MAX_COMMAND:
        return None
    nul = datagram.endswith(b"\0")
    body = datagram.strip(SPACE + b"\0") if nul else datagram.strip(SPACE)
    head = _HEAD.match(body)
    if head is None or head.group(1).lower() in SERVER_WORDS:
        return None
    forms = parse_forms(body)
    if forms is None:
        return Request((InvalidCommand(ErrorCode.ILLEGAL_FORM),), nul)
    if any(_is_reply(form) for form in forms):
        return None
    return Request(tuple(_command(form) for form in forms), nul)


def decode_message(datagram: bytes) -> ServerMessage | None:
    """The message of a server's datagram; None for anything else."""
    if len(datagram) > MAX_ANSWER:
        return None
    body = datagram.strip(SPACE + b"\0")
    if body.startswith(b"(see"):
        return _see(body)
    forms = parse_forms(body)
    if forms is None or len(forms) != 1:
        return None
    match forms[0]:
        case ("init", str(team_word), str(number_word), str(mode), *_):
            team, number = _team(team_word), _number(number_word)
            return InitReply(team, number, mode) if team and number and _NAME.fullmatch(mode) else None
        case ("mirror", *words):
            return _mirror_reply(words)
        case ("error", str(name)) if _NAME.fullmatch(name):
            return ErrorReply(name)
        case ("warning", str(name)) if _NAME.fullmatch(name):
            return WarningReply(name)
    return None


def encode(
    message: Init | Bye | LagReport | MirrorQuery | InitReply | MirrorReply | ErrorReply | WarningReply,
) -> bytes:
    """The canonical datagram of a message, without NUL."""
    match message:
        case Init(team, number, options):
            return _encode_form("init", str(team), str(number), encode_options(options))
        case Bye(team, number):
            return _encode_form("bye", *_robot_words(team, number))
        case LagReport():
            return _encode_form("lag", *_robot_words(message.team, message.number), *_lag_words(message))
        case MirrorQuery(team, number):
            return _encode_form("mirror", *_robot_words(team, number))
        case MirrorReply(mirror, team, number):
            return _encode_form("mirror", *_robot_words(team, number), encode_mirror(mirror))
        case InitReply(team, number, mode):
            return _encode_form("init", str(team), str(number), mode)
        case ErrorReply(name):
            return _encode_form("error", name)
        case WarningReply(name):
            return _encode_form("warning", name)


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


def _encode_form(*words: str) -> bytes:
    """A form of all words that are not empty."""
    return f"({' '.join(word for word in words if word)})".encode("ascii")


def _robot_words(team: Team | None, number: int | None) -> tuple[str, ...]:
    return () if team is None else (str(team), str(number))


def _lag_words(lag: LagReport) -> tuple[str, ...]:
    seconds, us = divmod(lag.time_us, US_PER_S)
    client = "-" if lag.client_s is None else f"{lag.client_s * MS_PER_S:.3f}"
    return f"{seconds}.{us:06d}", f"{lag.hold_s * MS_PER_S:.3f}", client


def _is_reply(form: Form) -> bool:
    """Is it a server's answer to a command of the same name: ``(init blue 3 play_on)``, ``(mirror 4.0 0.01 9e4)``?"""
    if len(form) == 4 and form[0] == "init":
        return form[3] in MODES
    return len(form) >= 4 and form[0] == "mirror" and real(form[-1]) is not None


def _mirror_reply(words: Sequence[str | Form]) -> MirrorReply | None:
    """The answer to ``(mirror)``; None for constants that are not those of a mirror, or a robot that cannot be."""
    if words and _team(words[0]) is not None:
        team, number = _team(words[0]), _number(words[1]) if len(words) > 1 else None
        mirror = mirror_from_words(words[2:5])
        return MirrorReply(mirror, team, number) if mirror and number else None
    mirror = mirror_from_words(words[:3])
    return MirrorReply(mirror) if mirror else None


def _team(word: str | Form) -> Team | None:
    return _TEAMS.get(word) if isinstance(word, str) else None


def _number(word: str | Form) -> int | None:
    number = integer(word)
    return number if number is not None and 1 <= number <= MAX_NUMBER else None


def _unwrap(name: str, part: str | Form) -> str | Form:
    """``blue`` from ``(team blue)``; any other part unchanged."""
    return part[1] if isinstance(part, tuple) and len(part) == 2 and part[0] == name else part


def _command(form: Form) -> Command:
    if not form or not isinstance(form[0], str):
        return InvalidCommand(ErrorCode.ILLEGAL_FORM)
    decoder = COMMANDS.get(form[0])
    return decoder(form[1:]) if decoder else InvalidCommand(ErrorCode.UNKNOWN_COMMAND)


def _robot(parts: Sequence[str | Form]) -> tuple[Team, int] | InvalidCommand:
    team = _team(_unwrap("team", parts[0])) if parts else None
    if team is None:
        return InvalidCommand(ErrorCode.ILLEGAL_TEAM)
    number = _number(_unwrap("number", parts[1])) if len(parts) > 1 else None
    return InvalidCommand(ErrorCode.ILLEGAL_NUMBER) if number is None else (team, number)


def _init(parts: Sequence[str | Form]) -> Command:
    robot = _robot(parts)
    if isinstance(robot, InvalidCommand):
        return robot
    found = options_from_forms(parts[2:])
    if isinstance(found, ErrorCode):
        return InvalidCommand(found)
    options, unknown = found
    return Init(*robot, options, unknown)


def _bye(parts: Sequence[str | Form]) -> Command:
    robot = _optional_robot(parts)
    return robot if isinstance(robot, InvalidCommand) else Bye(*robot)


def _mirror(parts: Sequence[str | Form]) -> Command:
    robot = _optional_robot(parts)
    return robot if isinstance(robot, InvalidCommand) else MirrorQuery(*robot)


def _optional_robot(parts: Sequence[str | Form]) -> tuple[Team | None, int | None] | InvalidCommand:
    if not parts:
        return None, None
    return _robot(parts) if len(parts) == 2 else InvalidCommand(ErrorCode.ILLEGAL_FORM)


def _lag(parts: Sequence[str | Form]) -> Command:
    if len(parts) not in (3, 5):
        return InvalidCommand(ErrorCode.ILLEGAL_FORM)
    time, hold, client = parts[-3:]
    when = _TIME.fullmatch(time.encode("ascii")) if isinstance(time, str) else None
    hold_ms, client_ms = real(hold), real(client)
    if when is None or hold_ms is None or (client_ms is None and client != "-"):
        return InvalidCommand(ErrorCode.ILLEGAL_FORM)
    lag = LagReport(_time_us(*when.groups()), hold_ms / MS_PER_S, None if client_ms is None else client_ms / MS_PER_S)
    if len(parts) == 3:
        return lag
    robot = _robot(parts)
    return robot if isinstance(robot, InvalidCommand) else replace(lag, team=robot[0], number=robot[1])


COMMANDS: Mapping[str, Callable[[Sequence[str | Form]], Command]] = MappingProxyType(
    {"init": _init, "bye": _bye, "lag": _lag, "mirror": _mirror}
)
"""The decoder of each command of version 1."""
