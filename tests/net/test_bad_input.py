"""Datagrams of every bad kind, and clients that stop reading: nobody else notices."""

import os
import signal
import socket
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.net.serving import PATIENCE_S, Stadium, robot
from vision_core.protocol.commands import MAX_COMMAND

LONGEST_ERROR = 39
BAD = {
    "empty": b"",
    "one byte": b"(",
    "the longest datagram": b"(" * 65507,
    "binary": bytes(range(256)) * 4,
    "only NULs": b"\0" * 1000,
    "open": b"(init blue 3",
    "closed": b"(init blue 3))",
    "10 000 deep": b"(" * 5000 + b")" * 5000,
    "1000 deep": b"(" * 500 + b")" * 500,
    "UTF-8": "(init blue drei–fünf)".encode(),
    "NaN": b"(lag nan nan nan)",
    "infinite": b"(init blue 3 (fov inf))",
    "1e999": b"(init blue 3 (mirror 1e999 1e999 1e999))",
    "1e-999": b"(init blue 3 (mirror 4.0187 1e-999 90000))",
    "huge number": b"(init blue " + b"9" * 900 + b")",
    "many forms": b"()" * 500,
}
NUMBERS = ["0", "6", "17", "-1", "03", "3.0", "+3", "1e0", "99999999999999999999", "three"]


@pytest.fixture
def stadium() -> Iterator[Stadium]:
    opened = Stadium()
    yield opened
    opened.close()


def answers_to(stadium: Stadium, datagram: bytes, port: int) -> list[bytes]:
    """What a stranger's datagram is answered with; the server goes on serving its client meanwhile."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as stranger:
        stranger.bind(("127.0.0.1", 0))
        stranger.sendto(datagram, ("127.0.0.1", port))
        stadium.serve(0.0)  # on loopback it has arrived, or the kernel has dropped it
        stranger.setblocking(False)
        found = []
        while True:
            try:
                found.append(stranger.recv(2048))
            except BlockingIOError:
                return found


def counted(stadium: Stadium) -> int:
    """Datagrams that were received, or dropped by the kernel since they can be no command."""
    return stadium.server.sessions.counts.received + stadium.server.dropped_by_kernel


@pytest.mark.parametrize("where", ["main", "session"])
@pytest.mark.parametrize("datagram", BAD.values(), ids=BAD.keys())
def test_a_bad_datagram_gets_at_most_one_short_error_and_is_counted(
    datagram: bytes, where: str, stadium: Stadium
) -> None:
    port = stadium.port if where == "main" else int(stadium.session.getsockname()[1])
    with robot(stadium, b"(init yellow 1)") as client:
        stadium.serve()
        assert client.recv(2048) == b"(init yellow 1 play_on)"
        before = counted(stadium)
        found = answers_to(stadium, datagram, port)
        assert counted(stadium) == before + 1
        assert len(found) <= 1
        assert all(len(error) <= LONGEST_ERROR and error.startswith(b"(error illegal_") for error in found)
        assert found or len(datagram) > MAX_COMMAND or not datagram.startswith(b"(")
        stadium.send_frame()
        assert client.recv(2048).startswith(b"(see ")
        assert len(stadium.server.sessions) == 1


@pytest.mark.parametrize("number", NUMBERS)
def test_an_init_with_an_impossible_number_opens_nothing(number: str, stadium: Stadium) -> None:
    init = f"(init blue {number})".encode()
    assert answers_to(stadium, init, stadium.port) == [b"(error illegal_number)"]
    assert len(stadium.server.sessions) == 0


@pytest.mark.parametrize("team", ["red", "Blue3", "3", "(team)", "blue,", '"blue"'])
def test_an_init_with_an_impossible_team_opens_nothing(team: str, stadium: Stadium) -> None:
    assert answers_to(stadium, f"(init {team} 3)".encode(), stadium.port) == [b"(error illegal_team)"]
    assert len(stadium.server.sessions) == 0


SLEEPER = """
import socket, sys
client = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
client.sendto(b"(init blue 3)", ("127.0.0.1", int(sys.argv[1])))
times = []
while True:
    message = client.recv(2048)
    if message.startswith(b"(error"):
        break
    if message.startswith(b"(see "):
        times.append(float(message.split()[1]))
        print(times[-1], flush=True)
"""
FRAMES = 600
"""More than the buffer of a socket holds."""


def test_a_client_that_is_stopped_loses_views_and_nobody_else_does(stadium: Stadium, tmp_path: Path) -> None:
    script = tmp_path / "sleeper.py"
    script.write_text(SLEEPER)
    command = [sys.executable, str(script), str(stadium.port)]
    with robot(stadium, b"(init yellow 1)") as neighbor:
        stadium.serve()
        neighbor.recv(2048)
        with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as sleeper:
            assert sleeper.stdout is not None
            stadium.serve(PATIENCE_S * 5)
            stadium.send_frame()
            first = float(sleeper.stdout.readline())
            os.kill(sleeper.pid, signal.SIGSTOP)
            neighbor.recv(2048)
            for _ in range(FRAMES):
                assert len(stadium.send_frame().deliveries) == 2
                assert neighbor.recv(2048).startswith(b"(see ")
            assert len(stadium.server.sessions) == 2
            os.kill(sleeper.pid, signal.SIGCONT)
            last = float(sleeper.stdout.readline())
            for session in stadium.server.sessions:
                stadium.server.end(session.team, session.number, session.opened)
            times = [first, last, *map(float, sleeper.stdout)]
    assert times == sorted(set(times))
