"""Golden transcripts: a script of datagrams and events, played against a server, and what the server says to it.

# a remark                      @ 1.500     Time [s]
A -> 6000 (init blue 3)         a client's datagram, to the main or the session port; \\0 is NUL
A <- 6001 (init blue 3 play_on) a datagram of the server
! frame                         something happens: see ``Scene.happen``
"""

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest

from tests.net.serving import BALL
from tests.protocol.samples import BOOT, CODES, MIRRORS, STRANGER, Server, simple_view
from vision_core.clock import NS_PER_MS, NS_PER_S, Instant
from vision_core.models.mirror import Mirror
from vision_core.protocol.driving import DriveLimits
from vision_core.protocol.encoding import encode
from vision_core.protocol.error_codes import ErrorCode
from vision_core.protocol.events import Endpoint, Event, Reply, SyncAsked
from vision_core.protocol.lifecycle import Peer, Port, Session
from vision_core.protocol.messages import SyncReply
from vision_core.protocol.options import Options
from vision_core.protocol.proofs import key_digest
from vision_core.protocol.rules import SessionRules
from vision_core.protocol.see import reference_see
from vision_core.types.objects import Team

FOLDER = Path(__file__).parent / "golden"
PORTS = {"6000": Port.MAIN, "6001": Port.SESSION}
KEY = "Zx-9_" + "k" * 38
MATCH = Options(types="team", fov_deg=180.0, center_deg=0.0, resolution_deg=20.0, rate_hz=30)
SHOW = b"(show 20306.148 ((ball) 120 -35 800 0) ((robot blue 3) -450 20 90.0 0 0) ((obstacle) 1 2 90))"
CLIENTS = {name: Peer("127.0.0.1", 40000 + number) for number, name in enumerate("ABCDE")} | {"F": STRANGER}


def shown(datagram: bytes) -> str:
    return datagram.decode("ascii").replace("\0", "\\0")


def view_of(session: Session, at: Instant, boot: Instant) -> bytes:
    """Walls at 220 mm and a ball, through the session's mirror."""
    view = simple_view(at=at, rays=session.options.rays_per_circle, ball=BALL)
    return reference_see(view, session.options, MIRRORS[Team.BLUE, 3], CODES, boot, nul=session.nul)


class Scene:
    """A server in memory, with a clock that stands still and a secret that is known."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        monkeypatch.setattr("vision_core.protocol.proofs.secrets.token_bytes", bytes)
        self.server = Server(keys={Team.BLUE: key_digest(KEY)})
        self.server.apply(replace(self.server.sessions.rules, monitor_key=key_digest(KEY)))

    def play(self, script: str) -> str:
        """The whole transcript of a script; what it already says of the server is written anew."""
        lines = [line for line in script.splitlines() if " <- " not in line]
        return "\n".join(said for line in lines for said in self._line(line)) + "\n"

    def _line(self, line: str) -> Iterator[str]:
        yield line
        if line.startswith("@ "):
            ms = round(float(line[2:]) * 1000)
            self.server.clock.advance((BOOT + ms * NS_PER_MS - self.server.clock.now()) / NS_PER_S)
        elif line.startswith("! "):
            yield from self._said(self.happen(*line[2:].split()))
        elif line and not line.startswith("#"):
            name, _, port, text = line.split(" ", 3)
            yield from self._said(self.hear(CLIENTS[name], PORTS[port], text))

    def hear(self, peer: Peer, port: Port, text: str) -> list[Event]:
        cookie = encode_cookie(self.server, peer)
        datagram = text.replace("KEY", KEY).replace("COOKIE", cookie).replace("\\0", "\0").encode("ascii")
        return self.server.hear(datagram, peer, Endpoint(port, "127.0.0.1"))

    def happen(self, what: str, *words: str) -> list[Event]:
        """Something happens that no client has asked for."""
        sessions, now = self.server.sessions, self.server.clock.now()
        rules = sessions.rules
        match what:
            case "frame":  # in the order of the sessions; the real order is random
                views = [
                    Reply(view_of(session, now, BOOT), session.peer, Endpoint(session.port, session.local), session)
                    for session in sessions
                ]
                return [*views, *(Reply(SHOW, monitor.peer, monitor.endpoint) for monitor in sessions.monitors)]
            case "mode":
                return sessions.apply(rules, words[0], now)
            case "tell":
                return sessions.tell(words[0], now)
            case "mirror" | "match" | "practice" | "simulated":
                return sessions.apply(changed(rules, what, words), sessions.mode, now)
            case "expire":
                return sessions.expire(now)
            case "closed":
                (session,) = (one for one in sessions if one.peer == CLIENTS[words[0]])
                return sessions.refused(session, now)
            case "end":
                return [event for session in sessions for event in sessions.end(session, ErrorCode.NOT_CONNECTED, now)]
        raise ValueError(f"! {what}")

    def _said(self, events: list[Event]) -> Iterator[str]:
        names = {peer: name for name, peer in CLIENTS.items()}
        ports = {port: text for text, port in PORTS.items()}
        for event in events:
            match event:
                case Reply():
                    yield f"{names[event.to]} <- {ports[event.via.port]} {shown(event.data)}"
                case SyncAsked(session, sync, arrived):
                    reply = SyncReply(sync.id, sync.t1_ns, arrived - BOOT, self.server.clock.now() - BOOT)
                    yield f"{names[session.peer]} <- {ports[session.port]} {shown(encode(reply))}"


def changed(rules: SessionRules, what: str, words: tuple[str, ...]) -> SessionRules:
    """Other rules: another mirror, a match or practice, or a simulated venue in which blue 3 can be driven."""
    match what:
        case "mirror":
            return replace(rules, mirrors=dict.fromkeys(MIRRORS, Mirror(*map(float, words))))
        case "simulated":
            vx, vy, turn, kick, dribbler = map(float, words)
            return replace(rules, drives={(Team.BLUE, 3): DriveLimits(vx, vy, turn, kick, bool(dribbler))})
    return replace(rules, fixed=MATCH if what == "match" else None)


def encode_cookie(server: Server, peer: Peer) -> str:
    """The cookie that the server gives to an address now."""
    return server.sessions._door._cookies.make(peer.host, peer.port, server.clock.now())
