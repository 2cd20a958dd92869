"""Whole sessions as golden transcripts: in memory to the byte, and over real sockets but for what the clock shows."""

import re
import socket
from collections.abc import Iterator
from contextlib import ExitStack
from dataclasses import replace

import pytest

from tests.net.serving import PATIENCE_S, Stadium
from tests.protocol.samples import MIRRORS
from tests.protocol.transcripts import FOLDER, MATCH, Scene, shown
from vision_core.models.mirror import Mirror
from vision_core.protocol.error_codes import ErrorCode
from vision_core.protocol.messages import FIXED_BY_MATCH, UNKNOWN_OPTION

FILES = sorted(FOLDER.glob("*.txt"))
OF_SOCKETS = ["version-1", "version-2"]
"""Those that need neither time to pass nor other addresses."""
MASKS = {
    r"\((see|hear) [0-9]+\.([0-9]+) ": lambda m: f"({m[1]} {'T' * len(m[2])} ",
    r"\((clock|boot|session) \w+\)": lambda m: f"({m[1]} ...)",
    r"\(sync (\S+) (\S+) \S+ \S+\)": lambda m: f"(sync {m[1]} {m[2]} T2 T3)",
    r"\(challenge (\w+)\)": lambda m: "(challenge ...)",
}


def test_the_transcripts_show_every_form_and_error() -> None:
    """All but three errors, which need a server that is full, busy or not yet ready."""
    text = "".join(file.read_text() for file in FILES)
    said = set(re.findall(r"<- \d+ \((?:error|warning) (\w+)\)", text))
    elsewhere = {ErrorCode.SERVER_FULL, ErrorCode.NOT_READY, ErrorCode.RATE_LIMITED}
    assert said == {UNKNOWN_OPTION, FIXED_BY_MATCH, *ErrorCode} - elsewhere
    assert len(max(re.findall(r"<- \d+ (\(see .*\))$", text, flags=re.MULTILINE), key=len)) > 1080


@pytest.mark.parametrize("name", [file.stem for file in FILES])
def test_a_transcript_in_memory(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    text = (FOLDER / f"{name}.txt").read_text()
    assert Scene(monkeypatch).play(text) == text


@pytest.fixture
def stadium() -> Iterator[Stadium]:
    opened = Stadium()
    yield opened
    opened.close()


@pytest.mark.parametrize("name", OF_SOCKETS)
def test_a_transcript_over_real_sockets(name: str, stadium: Stadium) -> None:
    with ExitStack() as stack:
        scene = RealScene(stadium, stack)
        for line in (FOLDER / f"{name}.txt").read_text().splitlines():
            scene.take(line)
        scene.expect_silence()


class RealScene:
    """Clients' sockets against a server's, which is driven step by step."""

    def __init__(self, stadium: Stadium, stack: ExitStack) -> None:
        self._stadium, self._stack = stadium, stack
        self._clients: dict[str, socket.socket] = {}
        self._cookies: dict[str, str] = {}
        self._ports = {"6000": stadium.port, "6001": int(stadium.session.getsockname()[1])}

    def take(self, line: str) -> None:
        """Do what a line says, or receive what it says of the server."""
        if line.startswith("! "):
            self._happen(*line[2:].split())
        elif not line.startswith(("#", "@")):
            name, arrow, port, text = line.split(" ", 3)
            if arrow == "->":
                datagram = text.replace("COOKIE", self._cookies.get(name, "")).replace("\\0", "\0")
                self._client(name).sendto(datagram.encode("ascii"), ("127.0.0.1", self._ports[port]))
                self._stadium.serve()
            else:
                said, (_, source) = self._client(name).recvfrom(2048)
                assert (masked(shown(said)), source) == (masked(text), self._ports[port])
                if said.startswith(b"(challenge "):
                    self._cookies[name] = said[11:-1].decode("ascii")

    def expect_silence(self) -> None:
        for client in self._clients.values():
            client.setblocking(False)
            with pytest.raises(BlockingIOError):
                client.recv(2048)

    def _client(self, name: str) -> socket.socket:
        if name not in self._clients:
            client = self._stack.enter_context(socket.socket(socket.AF_INET, socket.SOCK_DGRAM))
            client.bind(("127.0.0.1", 0))
            client.settimeout(PATIENCE_S)
            self._clients[name] = client
        return self._clients[name]

    def _happen(self, what: str, *words: str) -> None:
        server, now = self._stadium.server, self._stadium.clock.now()
        rules, mode = server.sessions.rules, server.sessions.mode
        match what:
            case "frame":
                self._stadium.send_frame()
            case "mode":
                server.apply(rules, words[0], now)
            case "tell":
                server.tell(words[0])
            case "mirror":
                server.apply(replace(rules, mirrors=dict.fromkeys(MIRRORS, Mirror(*map(float, words)))), mode, now)
            case "match" | "practice":
                server.apply(replace(rules, fixed=MATCH if what == "match" else None), mode, now)


def masked(text: str) -> str:
    """Without what a clock, a secret or a free port decides."""
    for pattern, mask in MASKS.items():
        text = re.sub(pattern, mask, text)
    return text
