"""What clients are told while no server answers."""

import socket
import subprocess
import sys
from collections.abc import Iterator

import pytest

from vision_core.clock import MonotonicClock, after
from vision_core.net.not_ready import MAX_CLIENTS, NOT_READY, NotReadyResponder
from vision_core.net.udp import SharedSocket, open_server_sockets
from vision_core.protocol.answers import decode_message
from vision_core.protocol.encoding import encode
from vision_core.protocol.error_codes import ErrorCode
from vision_core.protocol.messages import ErrorReply

INIT = b"(init blue 3)"
NOW = MonotonicClock().now()


@pytest.fixture
def ports() -> Iterator[tuple[socket.socket, socket.socket]]:
    main, session = open_server_sockets("127.0.0.1", 0, 0)
    with main, session:
        yield main, session


@pytest.fixture
def client() -> Iterator[socket.socket]:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as opened:
        opened.bind(("127.0.0.1", 0))
        opened.settimeout(2.0)
        yield opened


@pytest.fixture
def responder(ports: tuple[socket.socket, socket.socket]) -> NotReadyResponder:
    return NotReadyResponder([SharedSocket(opened) for opened in ports])


def test_the_answer_is_a_message_of_the_protocol() -> None:
    assert encode(ErrorReply(ErrorCode.NOT_READY)) == NOT_READY
    assert decode_message(NOT_READY) == ErrorReply("not_ready")


@pytest.mark.parametrize("port", [0, 1])
@pytest.mark.parametrize("init", [INIT, b" ( INIT\tblue 3)\n", b"(init(team blue)(number 3))", INIT + b" " * 1000])
def test_an_init_is_answered_from_the_port_that_it_came_to(
    ports: tuple[socket.socket, socket.socket],
    client: socket.socket,
    responder: NotReadyResponder,
    port: int,
    init: bytes,
) -> None:
    client.sendto(init, ports[port].getsockname())
    assert responder.answer_pending(NOW) == 1
    assert client.recvfrom(100) == (NOT_READY, ports[port].getsockname())


def test_the_answer_ends_like_the_request(
    ports: tuple[socket.socket, socket.socket], client: socket.socket, responder: NotReadyResponder
) -> None:
    client.sendto(INIT + b"\0", ports[0].getsockname())
    responder.answer_pending(NOW)
    assert client.recv(100) == NOT_READY + b"\0"


@pytest.mark.parametrize(
    "noise", [b"", b"(", b"(bye)", b"(initiate 1)", b"init blue 3", b"(error not_ready)", b"(" * 1400, b"\xff" * 1400]
)
def test_nothing_else_is_answered(
    ports: tuple[socket.socket, socket.socket], client: socket.socket, responder: NotReadyResponder, noise: bytes
) -> None:
    client.sendto(noise, ports[0].getsockname())
    assert responder.answer_pending(NOW) == 0
    client.sendto(INIT, ports[0].getsockname())
    assert responder.answer_pending(NOW) == 1


def test_a_client_is_answered_once_a_second(
    ports: tuple[socket.socket, socket.socket], client: socket.socket, responder: NotReadyResponder
) -> None:
    answers = []
    for tenth in range(31):
        client.sendto(INIT, ports[0].getsockname())
        answers.append(responder.answer_pending(after(NOW, tenth / 10)))
    assert [tenth for tenth, count in enumerate(answers) if count] == [0, 10, 20, 30]


def test_eleven_robots_of_one_computer_are_all_answered(
    ports: tuple[socket.socket, socket.socket], responder: NotReadyResponder
) -> None:
    robots = [socket.socket(socket.AF_INET, socket.SOCK_DGRAM) for _ in range(11)]
    for robot in robots:
        robot.sendto(INIT, ports[0].getsockname())
    assert responder.answer_pending(NOW) == 11
    for robot in robots:
        robot.close()


def test_the_table_is_bounded_and_forgets(
    ports: tuple[socket.socket, socket.socket], client: socket.socket, responder: NotReadyResponder
) -> None:
    for port in range(MAX_CLIENTS):
        responder._answered_at["192.0.2.1", port, 0] = NOW
    client.sendto(INIT, ports[0].getsockname())
    assert responder.answer_pending(after(NOW, 0.5)) == 0
    client.sendto(INIT, ports[0].getsockname())
    assert responder.answer_pending(after(NOW, 1.0)) == 1
    assert len(responder._answered_at) == 1


def test_no_answer_is_longer_than_three_requests(
    ports: tuple[socket.socket, socket.socket], client: socket.socket, responder: NotReadyResponder
) -> None:
    client.sendto(b"(init\0", ports[0].getsockname())
    client.sendto(b"(init ", ports[0].getsockname())
    assert responder.answer_pending(NOW) == 1
    assert len(client.recv(100)) <= 3 * len(b"(init ")


def test_the_standard_library_is_enough() -> None:
    """The process starts within a moment, and before anything is compiled."""
    script = (
        "import sys, vision_core.startup.responder\n"
        "heavy = {name.partition('.')[0] for name in sys.modules} - sys.stdlib_module_names - {'vision_core'}\n"
        "print(sorted(name for name in heavy if not name.startswith('_')))"
    )
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"
