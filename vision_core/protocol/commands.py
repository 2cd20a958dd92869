"""Datagrams of clients -> commands. Decoding gives a Request or None, never an exception.

Commands are read tolerantly: any letter case, any white space, a trailing newline or NUL, and three ways to name the
robot in ``init``.
"""

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from itertools import takewhile
from types import MappingProxyType

from vision_core.clock import MS_PER_S
from vision_core.protocol.driving import Drive
from vision_core.protocol.error_codes import ErrorCode
from vision_core.protocol.messages import (
    PLAY_MODES,
    Bye,
    Command,
    Init,
    InvalidCommand,
    LagReport,
    MirrorQuery,
    MonitorInit,
    Ping,
    Reconnect,
    Request,
    Set,
    Sync,
)
from vision_core.protocol.options import options_from_forms
from vision_core.protocol.proofs import COOKIE_DIGITS, MAX_KEY, Proof
from vision_core.protocol.s_expressions import SPACE, Form, parse_forms, real
from vision_core.protocol.words import TIME, long_integer, number_of, team_of, time_us
from vision_core.types.objects import Team

MAX_COMMAND = 1024
"""Longer datagrams of clients are dropped without being read [bytes]."""
SERVER_WORDS = frozenset({b"see", b"show", b"hear", b"error", b"warning", b"ok", b"challenge", b"pong"})
"""First words of a server's messages. A server does not answer them."""

_HEAD = re.compile(rb"\(\s*+([A-Za-z_]*+)")
_COOKIE = re.compile(rf"[0-9a-f]{{{COOKIE_DIGITS}}}")


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


def _is_reply(form: Form) -> bool:
    """Is it a server's answer to a command of the same name?

    ``(init blue 3 play_on)``, ``(dispinit play_on)``, ``(mirror 4.0 0.01 9e4)``, ``(sync 7 1 2 3)``.
    """
    match form:
        case ("init", _, _, mode, *_) | ("dispinit", mode, *_):
            return mode in PLAY_MODES
        case ("mirror", _, _, *_, last):
            return real(last) is not None
        case ("sync", _, _, _, *_):
            return True
    return False


def _unwrap(name: str, part: str | Form) -> str | Form:
    """``blue`` from ``(team blue)``; any other part unchanged."""
    return part[1] if isinstance(part, tuple) and len(part) == 2 and part[0] == name else part


def _command(form: Form) -> Command:
    if not form or not isinstance(form[0], str):
        return InvalidCommand(ErrorCode.ILLEGAL_FORM)
    decoder = COMMANDS.get(form[0])
    return decoder(form[1:]) if decoder else InvalidCommand(ErrorCode.UNKNOWN_COMMAND)


def _robot(parts: Sequence[str | Form]) -> tuple[Team, int] | InvalidCommand:
    team = team_of(_unwrap("team", parts[0])) if parts else None
    if team is None:
        return InvalidCommand(ErrorCode.ILLEGAL_TEAM)
    number = number_of(_unwrap("number", parts[1])) if len(parts) > 1 else None
    return InvalidCommand(ErrorCode.ILLEGAL_NUMBER) if number is None else (team, number)


def _init(parts: Sequence[str | Form]) -> Command:
    robot = _robot(parts)
    if isinstance(robot, InvalidCommand):
        return robot
    proof, forms = _proof(parts[2:])
    if proof is None:
        return InvalidCommand(ErrorCode.ILLEGAL_OPTION)
    found = options_from_forms(forms)
    if isinstance(found, ErrorCode):
        return InvalidCommand(found)
    options, unknown = found
    return Init(*robot, options, unknown, proof)


def _reconnect(parts: Sequence[str | Form]) -> Command:
    robot = _robot(parts)
    if isinstance(robot, InvalidCommand):
        return robot
    proof, forms = _proof(parts[2:])
    if proof is None or not proof.key or forms:
        return InvalidCommand(ErrorCode.ILLEGAL_OPTION)
    return Reconnect(*robot, proof)


def _monitor_init(parts: Sequence[str | Form]) -> Command:
    proof, forms = _proof(parts)
    match forms:
        case _ if proof is None:
            return InvalidCommand(ErrorCode.ILLEGAL_OPTION)
        case [] | [("version", _)]:
            return MonitorInit(proof)
    return InvalidCommand(ErrorCode.ILLEGAL_OPTION)


def _proof(forms: Sequence[str | Form]) -> tuple[Proof | None, Sequence[str | Form]]:
    """Cookie and key among the options, and the other options; no proof when one is illegal or comes twice."""
    cookie = key = ""
    others = []
    for form in forms:
        match form:
            case ("cookie", str(word)) if not cookie and _COOKIE.fullmatch(word):
                cookie = word
            case ("key", str(word)) if not key and len(word) <= MAX_KEY:
                key = word
            case ("cookie" | "key", *_):
                return None, ()
            case _:
                others.append(form)
    return Proof(cookie, key), others


def _set(parts: Sequence[str | Form]) -> Command:
    if parts and isinstance(parts[0], str):
        robot = _robot(parts)
        return robot if isinstance(robot, InvalidCommand) else Set(tuple(parts[2:]), *robot)
    return Set(tuple(parts))


def _ping(parts: Sequence[str | Form]) -> Command:
    if not parts:
        return Ping()
    number = long_integer(parts[0]) if len(parts) == 1 else None
    return InvalidCommand(ErrorCode.ILLEGAL_FORM) if number is None else Ping(number)


def _sync(parts: Sequence[str | Form]) -> Command:
    numbers = [number for part in parts if (number := long_integer(part)) is not None]
    if len(parts) != 2 or len(numbers) != 2:
        return InvalidCommand(ErrorCode.ILLEGAL_FORM)
    return Sync(*numbers)


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
    when = TIME.fullmatch(time.encode("ascii")) if isinstance(time, str) else None
    hold_ms, client_ms = real(hold), real(client)
    if when is None or hold_ms is None or (client_ms is None and client != "-"):
        return InvalidCommand(ErrorCode.ILLEGAL_FORM)
    lag = LagReport(time_us(*when.groups()), hold_ms / MS_PER_S, None if client_ms is None else client_ms / MS_PER_S)
    if len(parts) == 3:
        return lag
    return _of_robot(lag, parts)


def _drive(parts: Sequence[str | Form]) -> Command:
    words = tuple(takewhile(lambda part: isinstance(part, str), parts))
    numbers = [number for word in words[-3:] if (number := real(word)) is not None]
    equipment = {form[0]: form[1:] for form in parts[len(words) :] if isinstance(form, tuple) and form}
    if len(words) not in (3, 5) or len(numbers) < 3 or len(equipment) < len(parts) - len(words):
        return InvalidCommand(ErrorCode.ILLEGAL_FORM)
    kick, dribble = equipment.pop("kick", ("0",)), equipment.pop("dribble", None)
    kick_m_s = real(kick[0]) if len(kick) == 1 else None
    if kick_m_s is None or dribble or equipment:
        return InvalidCommand(ErrorCode.ILLEGAL_FORM)
    drive = Drive(numbers[0], numbers[1], numbers[2], kick_m_s, dribble is not None)
    return drive if len(words) == 3 else _of_robot(drive, parts)


def _of_robot(command: LagReport | Drive, parts: Sequence[str | Form]) -> Command:
    """A command about the robot that it names first."""
    robot = _robot(parts)
    return robot if isinstance(robot, InvalidCommand) else replace(command, team=robot[0], number=robot[1])


COMMANDS: Mapping[str, Callable[[Sequence[str | Form]], Command]] = MappingProxyType(
    {
        "init": _init,
        "reconnect": _reconnect,
        "dispinit": _monitor_init,
        "bye": _bye,
        "set": _set,
        "ping": _ping,
        "sync": _sync,
        "lag": _lag,
        "mirror": _mirror,
        "drive": _drive,
    }
)
"""The decoder of each command."""
