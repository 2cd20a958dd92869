"""What the kernel drops, and what it lets through."""

import socket
from collections.abc import Iterator

import pytest

from vision_core.net.kernel_filter import LONGEST, attach_filter, dropped
from vision_core.protocol.commands import MAX_COMMAND, decode_commands


@pytest.fixture(params=[(socket.AF_INET, "127.0.0.1"), (socket.AF_INET6, "::1")], ids=["IPv4", "IPv6"])
def server(request: pytest.FixtureRequest) -> Iterator[socket.socket]:
    family, host = request.param
    with socket.socket(family, socket.SOCK_DGRAM) as opened:
        if not attach_filter(opened):
            pytest.skip("this system has no socket filters")
        opened.bind((host, 0))
        opened.setblocking(False)
        yield opened


def test_the_limit_is_that_of_the_protocol() -> None:
    assert LONGEST == MAX_COMMAND


def received(server: socket.socket, datagram: bytes) -> bool:
    with socket.socket(server.family, socket.SOCK_DGRAM) as client:
        client.sendto(datagram, server.getsockname())
    try:
        return server.recv(2048) == datagram
    except BlockingIOError:
        return False


@pytest.mark.parametrize(
    "datagram",
    [b"(init blue 3)", b"(", b" (bye)", b"\t(bye)", b"\r\n(bye)", b"(" + b"x" * (MAX_COMMAND - 1)],
)
def test_what_may_be_a_command_arrives(server: socket.socket, datagram: bytes) -> None:
    assert received(server, datagram)
    assert dropped(server) == 0


@pytest.mark.parametrize(
    "datagram",
    [b"", b"\0", b"init blue 3", b"\xff" * 100, b"\x08(bye)", b"\x0e(bye)", b")(bye)", b"(" * (MAX_COMMAND + 1)],
)
def test_what_can_be_none_is_dropped_and_counted(server: socket.socket, datagram: bytes) -> None:
    assert not received(server, datagram)
    assert dropped(server) == 1
    assert decode_commands(datagram) is None, "the server would not have answered either"
