"""Messages -> datagrams, in the one canonical form of each."""

from vision_core.clock import MS_PER_S, US_PER_MS, US_PER_S
from vision_core.protocol.driving import Drive
from vision_core.protocol.messages import (
    Bye,
    Challenge,
    ErrorReply,
    Hear,
    Init,
    InitReply,
    LagReport,
    MirrorQuery,
    MirrorReply,
    MonitorFacts,
    MonitorInit,
    MonitorReply,
    Ok,
    Ping,
    Pong,
    Reconnect,
    See,
    SessionFacts,
    Set,
    Sync,
    SyncReply,
    WarningReply,
)
from vision_core.protocol.options import encode_mirror, encode_options
from vision_core.protocol.proofs import Proof
from vision_core.protocol.s_expressions import Form
from vision_core.types.objects import Team

ClientMessage = Init | Reconnect | MonitorInit | Bye | Set | Ping | Sync | LagReport | MirrorQuery | Drive
Answer = InitReply | MonitorReply | Challenge | MirrorReply | Hear | Pong | SyncReply | Ok | ErrorReply | WarningReply


Opening = Init | Reconnect | MonitorInit
"""Commands that may bring a proof."""


def encode(message: ClientMessage | Answer) -> bytes:
    """The canonical datagram of a message, without NUL."""
    words = _command_words(message) if isinstance(message, ClientMessage) else _answer_words(message)
    return f"({' '.join(word for word in words if word)})".encode("ascii")


def _command_words(message: ClientMessage) -> tuple[str, ...]:
    match message:
        case Init() | Reconnect() | MonitorInit():
            return *_opening_words(message), *_proof_words(message.proof)
        case Bye(team, number) | MirrorQuery(team, number):
            return "bye" if isinstance(message, Bye) else "mirror", *_robot_words(team, number)
        case Set(forms, team, number):
            return "set", *_robot_words(team, number), *map(_form_text, forms)
        case Ping(number):
            return "ping", _number_word(number)
        case Sync(number, t1_ns):
            return "sync", str(number), str(t1_ns)
        case LagReport():
            return "lag", *_robot_words(message.team, message.number), *_lag_words(message)
        case Drive():
            return "drive", *_robot_words(message.team, message.number), *_drive_words(message)


def _opening_words(message: Opening) -> tuple[str, ...]:
    match message:
        case Init(team, number, options):
            return "init", str(team), str(number), encode_options(options)
        case Reconnect(team, number):
            return "reconnect", str(team), str(number)
        case MonitorInit():
            return ("dispinit",)


def _answer_words(message: Answer) -> tuple[str, ...]:
    match message:
        case Pong(number):
            return "pong", _number_word(number)
        case SyncReply(number, t1_ns, t2_ns, t3_ns):
            return "sync", str(number), str(t1_ns), str(t2_ns), str(t3_ns)
        case MirrorReply(mirror, team, number):
            return "mirror", *_robot_words(team, number), encode_mirror(mirror)
        case InitReply() | MonitorReply():
            return _opened_words(message)
        case Challenge(cookie):
            return "challenge", cookie
        case Hear(time_us, sender, words):
            return "hear", time_word(time_us, "ms"), sender, *words
        case Ok(name):
            return "ok", name
        case ErrorReply(name) | WarningReply(name):
            return "error" if isinstance(message, ErrorReply) else "warning", name


def _opened_words(message: InitReply | MonitorReply) -> tuple[str, ...]:
    match message:
        case InitReply(team, number, mode, facts):
            return "init", str(team), str(number), mode, *(_pairs(facts) if facts else ())
        case MonitorReply(mode, facts):
            return "dispinit", mode, *(_monitor_pairs(facts) if facts else ())


def encode_see(see: See, time: str = "ms") -> bytes:
    """The datagram of a ``see`` with three (ms) or six (us) decimals; spaces are exact."""
    ball = see.ball
    extras = "".join(f" (({name}){''.join(f' {word}' for word in words)})" for name, words in see.extras.items())
    return b"(see %s ((edge) %s) ((ball) %d %d %d)%s)" % (
        time_word(see.time_us, time).encode("ascii"),
        see.edges,
        ball.px,
        ball.direction_deg,
        ball.size_deg,
        extras.encode("ascii"),
    )


def time_word(time_us: int, unit: str = "ms") -> str:
    """Time as it is printed, with three (ms) or six (us) decimals."""
    seconds, us = divmod(time_us, US_PER_S)
    return f"{seconds}.{us // US_PER_MS:03d}" if unit == "ms" else f"{seconds}.{us:06d}"


def _form_text(form: str | Form) -> str:
    return form if isinstance(form, str) else f"({' '.join(map(_form_text, form))})"


def _robot_words(team: Team | None, number: int | None) -> tuple[str, ...]:
    return () if team is None else (str(team), str(number))


def _number_word(number: int | None) -> str:
    return "" if number is None else str(number)


def _proof_words(proof: Proof) -> tuple[str, ...]:
    return tuple(f"({name} {word})" for name, word in (("cookie", proof.cookie), ("key", proof.key)) if word)


def _lag_words(lag: LagReport) -> tuple[str, ...]:
    client = "-" if lag.client_s is None else f"{lag.client_s * MS_PER_S:.3f}"
    return time_word(lag.time_us, "us"), f"{lag.hold_s * MS_PER_S:.3f}", client


def _drive_words(drive: Drive) -> tuple[str, ...]:
    speeds = (f"{speed:.4f}" for speed in (drive.vx_m_s, drive.vy_m_s, drive.turn_rad_s))
    return *speeds, f"(kick {drive.kick_m_s:.4f})" if drive.kick_m_s else "", "(dribble)" if drive.dribble else ""


def _pairs(facts: SessionFacts) -> tuple[str, ...]:
    return (
        f"(version {facts.version})",
        f"(session {facts.session})",
        f"(lease {facts.lease_s:g})",
        f"(period {facts.period_ms:g})",
        f"(mirror {encode_mirror(facts.mirror)})",
        f"(rmin {facts.rmin_mm:g})",
        f"(rmax {facts.rmax_mm:g})",
        f"(fov {facts.fov_deg:g} {facts.center_deg:g})",
        f"(resolution {facts.resolution_deg:g})",
        f"(types {facts.types})",
        *_server_pairs(facts),
        *((f"(drive {' '.join(f'{limit:g}' for limit in facts.drive)})",) if facts.drive else ()),
    )


def _monitor_pairs(facts: MonitorFacts) -> tuple[str, ...]:
    return (
        f"(version {facts.version})",
        f"(lease {facts.lease_s:g})",
        f"(period {facts.period_ms:g})",
        *_server_pairs(facts),
    )


def _server_pairs(facts: SessionFacts | MonitorFacts) -> tuple[str, ...]:
    """What every client is told of the server itself."""
    length_mm, width_mm = facts.field_mm
    return (
        f"(clock {facts.clock_ns})",
        f"(boot {facts.boot})",
        f"(venue {facts.venue})",
        f"(field {length_mm:g} {width_mm:g})",
    )
