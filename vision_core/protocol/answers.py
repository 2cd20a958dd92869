"""Datagrams of a server -> messages, as a client reads them. Decoding gives a message or None, never an exception.

The client skips whatever follows the parts that it knows, since a later version may append something.
"""

import re
from collections.abc import Callable, Mapping, Sequence
from types import MappingProxyType

from vision_core.protocol.driving import DriveLimits
from vision_core.protocol.messages import (
    NO_EXTRAS,
    Ball,
    Challenge,
    ErrorReply,
    Hear,
    InitReply,
    MirrorReply,
    MonitorFacts,
    MonitorReply,
    Ok,
    Ping,
    Pong,
    See,
    ServerMessage,
    SessionFacts,
    SyncReply,
    WarningReply,
)
from vision_core.protocol.options import mirror_from_words
from vision_core.protocol.s_expressions import SPACE, Form, parse_forms, real
from vision_core.protocol.show import decode_show
from vision_core.protocol.words import NAME, TIME, long_integer, number_of, team_of, time_us

MAX_ANSWER = 2048
"""Longer datagrams of servers are dropped [bytes]; this server sends at most 1400."""

_SEE = re.compile(
    rb"\(see\s++([0-9]{1,10})(?:\.([0-9]{0,6}+)[0-9]*+)?+"
    rb"\s++\(\(edge\)\s*+((?:[!-'*-~][0-9A-Fa-f]{2})*+)[^()]*+\)"
    rb"\s*+\(\(ball\)\s++(-?[0-9]{1,3})\s++(-?[0-9]{1,3})\s++(-?[0-9]{1,3})\s*+\)(.*)\)",
    re.DOTALL,
)
_EXTRA = re.compile(rb"\(\(([a-z]{1,16})\)([^()]*+)\)")


def decode_message(datagram: bytes) -> ServerMessage | None:
    """The message of a server's datagram; None for anything else."""
    if len(datagram) > MAX_ANSWER:
        return None
    body = datagram.strip(SPACE + b"\0")
    if body.startswith(b"(see"):
        return _see(body)
    forms = parse_forms(body)
    return _message(forms[0]) if forms is not None and len(forms) == 1 else None


def _message(form: Form) -> ServerMessage | None:
    decoder = DECODERS.get(form[0]) if form and isinstance(form[0], str) else None
    return decoder(form[1:]) if decoder else None


def _see(body: bytes) -> See | None:
    match = _SEE.fullmatch(body)
    if match is None:
        return None
    seconds, decimals, edges, px, direction, size, rest = match.groups()
    ball = Ball(int(px), int(direction), int(size))
    return See(time_us(seconds, decimals), edges, ball, _extras(rest) if rest else NO_EXTRAS)


def _extras(rest: bytes) -> Mapping[str, tuple[str, ...]]:
    """What follows the ball, by name."""
    found = {name.decode("ascii"): words.decode("ascii", "replace") for name, words in _EXTRA.findall(rest)}
    return MappingProxyType({name: tuple(words.split()) for name, words in found.items()})


def _init(words: Sequence[str | Form]) -> InitReply | None:
    if len(words) < 3:
        return None
    team, number, mode = team_of(words[0]), number_of(words[1]), _name(words[2:])
    return InitReply(team, number, mode, _facts(words[3:])) if team and number and mode else None


def _challenge(words: Sequence[str | Form]) -> Challenge | None:
    return Challenge(words[0]) if words and isinstance(words[0], str) else None


def _hear(words: Sequence[str | Form]) -> Hear | None:
    match words:
        case (str(time), str(sender), *rest) if match := TIME.fullmatch(time.encode("ascii")):
            return Hear(time_us(*match.groups()), sender, tuple(word for word in rest if isinstance(word, str)))
    return None


def _ping(words: Sequence[str | Form]) -> Ping:
    return Ping(long_integer(words[0]) if words else None)


def _pong(words: Sequence[str | Form]) -> Pong:
    return Pong(long_integer(words[0]) if words else None)


def _sync(words: Sequence[str | Form]) -> SyncReply | None:
    numbers = [number for word in words[:4] if (number := long_integer(word)) is not None]
    return SyncReply(*numbers) if len(numbers) == 4 else None


def _named(message: Callable[[str], ServerMessage]) -> Callable[[Sequence[str | Form]], ServerMessage | None]:
    def decoder(words: Sequence[str | Form]) -> ServerMessage | None:
        name = _name(words)
        return message(name) if name else None

    return decoder


def _name(words: Sequence[str | Form]) -> str | None:
    """The first word, if it is a name."""
    return words[0] if words and isinstance(words[0], str) and NAME.fullmatch(words[0]) else None


def _mirror_reply(words: Sequence[str | Form]) -> MirrorReply | None:
    """The answer to ``(mirror)``; None for constants that are not those of a mirror, or a robot that cannot be."""
    if words and team_of(words[0]) is not None:
        team, number = team_of(words[0]), number_of(words[1]) if len(words) > 1 else None
        mirror = mirror_from_words(words[2:5])
        return MirrorReply(mirror, team, number) if mirror and number else None
    mirror = mirror_from_words(words[:3])
    return MirrorReply(mirror) if mirror else None


def _facts(pairs: Sequence[str | Form]) -> SessionFacts | None:
    """The facts of an answer to init; None when one is missing, as in the answers of version 1."""
    words, server = _by_name(pairs), _monitor_facts(pairs)
    try:
        mirror = mirror_from_words(words["mirror"])
        if mirror is None or server is None:
            return None
        (session,) = map(_long, words["session"])
        (rmin_mm,), (rmax_mm,), (fov_deg, center_deg) = (map(_real, words[name]) for name in ("rmin", "rmax", "fov"))
        return SessionFacts(
            server.version, session, server.lease_s, server.period_ms, mirror, rmin_mm, rmax_mm, fov_deg, center_deg,
            _real(words["resolution"][0]), str(words["types"][0]), server.clock_ns, server.boot, server.venue,
            server.field_mm, _drive_limits(words["drive"]) if "drive" in words else None,
        )  # fmt: skip
    except (KeyError, ValueError, IndexError):
        return None


def _by_name(pairs: Sequence[str | Form]) -> dict[str, Form]:
    """The words of each pair, by its name."""
    return {str(pair[0]): pair[1:] for pair in pairs if isinstance(pair, tuple) and pair}


def _monitor_reply(words: Sequence[str | Form]) -> MonitorReply | None:
    mode = _name(words)
    return MonitorReply(mode, _monitor_facts(words[1:])) if mode else None


def _monitor_facts(pairs: Sequence[str | Form]) -> MonitorFacts | None:
    """The facts of an answer to dispinit, which an answer to init has as well; None when one is missing."""
    words = _by_name(pairs)
    try:
        (version,), (clock_ns,) = (map(_long, words[name]) for name in ("version", "clock"))
        (lease_s,), (period_ms,) = (map(_real, words[name]) for name in ("lease", "period"))
        length_mm, width_mm = map(_real, words["field"])
        boot, venue = str(words["boot"][0]), str(words["venue"][0])
    except (KeyError, ValueError, IndexError):
        return None
    return MonitorFacts(version, lease_s, period_ms, clock_ns, boot, venue, (length_mm, width_mm))


def _drive_limits(words: Sequence[str | Form]) -> DriveLimits:
    *speeds, dribbler = map(_real, words[:5])
    vx_m_s, vy_m_s, turn_rad_s, kick_m_s = speeds
    return DriveLimits(vx_m_s, vy_m_s, turn_rad_s, kick_m_s, bool(dribbler))


def _real(word: str | Form) -> float:
    number = real(word)
    if number is None:
        raise ValueError(f"a number: {word!r}")
    return number


def _long(word: str | Form) -> int:
    number = long_integer(word)
    if number is None:
        raise ValueError(f"an integer: {word!r}")
    return number


DECODERS: Mapping[str, Callable[[Sequence[str | Form]], ServerMessage | None]] = MappingProxyType(
    {
        "init": _init,
        "dispinit": _monitor_reply,
        "show": decode_show,
        "challenge": _challenge,
        "mirror": _mirror_reply,
        "hear": _hear,
        "ping": _ping,
        "pong": _pong,
        "sync": _sync,
        "ok": _named(Ok),
        "error": _named(ErrorReply),
        "warning": _named(WarningReply),
    }
)
"""The decoder of each message but ``see``."""
