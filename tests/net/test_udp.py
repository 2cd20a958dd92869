"""Sockets: who gets which datagram, and what is refused."""

import select
import socket
import time
from collections.abc import Iterator

import pytest

from vision_core.errors import ServiceError
from vision_core.net.udp import Address, Datagram, SendResult, SessionSocket, SharedSocket, open_server_sockets

PATIENCE_S = 2.0


@pytest.fixture
def ports() -> Iterator[tuple[socket.socket, socket.socket]]:
    main, session = open_server_sockets("127.0.0.1", 0, 0)
    yield main, session
    main.close()
    session.close()


@pytest.fixture
def client() -> Iterator[socket.socket]:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as opened:
        opened.bind(("127.0.0.1", 0))
        opened.settimeout(PATIENCE_S)
        yield opened


def peer_of(client: socket.socket) -> Address:
    host, port = client.getsockname()
    return host, port, 0


def received(source: SharedSocket | SessionSocket) -> Datagram | SendResult | None:
    select.select([source], [], [], PATIENCE_S)
    return source.receive()


def test_the_session_port_is_the_next_one(ports: tuple[socket.socket, socket.socket]) -> None:
    main, session = ports
    assert session.getsockname()[1] == main.getsockname()[1] + 1
    assert not main.getblocking()
    assert not session.getblocking()


def test_a_chosen_session_port(ports: tuple[socket.socket, socket.socket]) -> None:
    free = ports[1].getsockname()[1]
    for opened in ports:
        opened.close()
    again = open_server_sockets("127.0.0.1", 0, free)
    assert again[1].getsockname()[1] == free
    for opened in again:
        opened.close()


def test_a_port_in_use_is_named(ports: tuple[socket.socket, socket.socket]) -> None:
    """Neither port can be shared with a second server, although sessions share them."""
    main, session = (opened.getsockname()[1] for opened in ports)
    with pytest.raises(ServiceError, match=rf"UDP port {main} of 127\.0\.0\.1; found: another program"):
        open_server_sockets("127.0.0.1", main, 0)
    with pytest.raises(ServiceError, match=f"UDP port {session}"):
        open_server_sockets("127.0.0.1", 0, session)
    with pytest.raises(ServiceError, match=f"UDP port {session}"):
        open_server_sockets("127.0.0.1", session, 0)


@pytest.mark.parametrize(("host", "port"), [("192.0.2.1", 0), ("no host", 0), ("127.0.0.1", 65535)])
def test_impossible_addresses_are_named(host: str, port: int) -> None:
    with pytest.raises(ServiceError):
        open_server_sockets(host, port, 0)


@pytest.mark.parametrize("host", ["127.0.0.1", "0.0.0.0", "::1", "::"])  # every family, fixed and wildcard
def test_a_session_answers_from_where_it_was_asked(host: str) -> None:
    try:
        main, session = open_server_sockets(host, 0, 0)
    except ServiceError:
        pytest.skip(f"this machine has no {host}")
    asked = "::1" if ":" in host else "127.0.0.1"
    family = socket.AF_INET6 if ":" in host else socket.AF_INET
    with main, session, socket.socket(family, socket.SOCK_DGRAM) as client:
        client.settimeout(PATIENCE_S)
        client.sendto(b"(init blue 3)", (asked, main.getsockname()[1]))
        shared = SharedSocket(main)
        datagram = received(shared)
        assert isinstance(datagram, Datagram)
        assert (datagram.data, datagram.local) == (b"(init blue 3)", asked)
        assert shared.send(b"error", datagram.peer, datagram.local) is SendResult.SENT
        assert client.recvfrom(100)[1][:2] == (asked, main.getsockname()[1])
        own = SharedSocket(session).open_session(datagram.local, datagram.peer)
        assert own.send(b"see") is SendResult.SENT
        data, source = client.recvfrom(100)
        assert (data, source[:2]) == (b"see", (asked, session.getsockname()[1]))
        own.close()


def test_ipv4_clients_of_an_ipv6_wildcard(client: socket.socket) -> None:
    try:
        main, session = open_server_sockets("::", 0, 0)
    except ServiceError:
        pytest.skip("this machine has no IPv6")
    with main, session:
        client.sendto(b"(x", ("127.0.0.1", main.getsockname()[1]))
        datagram = received(SharedSocket(main))
        assert isinstance(datagram, Datagram)
        own = SharedSocket(session).open_session(datagram.local, datagram.peer)
        own.send(b"see")
        assert client.recvfrom(100) == (b"see", ("127.0.0.1", session.getsockname()[1]))
        own.close()


def test_the_kernel_routes_each_client_to_its_own_socket(
    ports: tuple[socket.socket, socket.socket], client: socket.socket
) -> None:
    session = ports[1]
    own = SharedSocket(session).open_session("127.0.0.1", peer_of(client))
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as stranger:
        stranger.sendto(b"(stranger", session.getsockname())
        client.sendto(b"(client", session.getsockname())
        mine, rest = received(own), received(SharedSocket(session))
    assert isinstance(mine, Datagram)
    assert isinstance(rest, Datagram)
    assert (mine.data, mine.peer) == (b"(client", peer_of(client))
    assert rest.data == b"(stranger"
    assert own.receive() is None
    own.close()


def test_a_stranger_who_slips_in_between_bind_and_connect_keeps_his_name(
    ports: tuple[socket.socket, socket.socket], client: socket.socket, monkeypatch: pytest.MonkeyPatch
) -> None:
    session = ports[1]
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as stranger:
        stranger.bind(("127.0.0.1", 0))

        class Slow(socket.socket):
            def connect(self, address: object) -> None:
                stranger.sendto(b"(now", self.getsockname())
                time.sleep(0.01)
                super().connect(address)  # type: ignore[arg-type]

        monkeypatch.setattr(socket, "socket", Slow)
        own = SharedSocket(session).open_session("127.0.0.1", peer_of(client))
        monkeypatch.undo()
        slipped = received(own)
        assert isinstance(slipped, Datagram)
        assert slipped.peer == peer_of(stranger)
    own.close()


@pytest.mark.parametrize("address", ["127.0.0.1", "0.0.0.0"])
@pytest.mark.parametrize("which", [0, 1])
def test_no_other_program_gets_a_port_that_sessions_share(
    ports: tuple[socket.socket, socket.socket], client: socket.socket, which: int, address: str
) -> None:
    shared = SharedSocket(ports[which])
    first = shared.open_session("127.0.0.1", peer_of(client))
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as other:
        other.bind(("127.0.0.1", 0))
        second = shared.open_session("127.0.0.1", peer_of(other))
        for flag in (socket.SO_REUSEADDR, socket.SO_REUSEPORT):
            with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as thief:
                thief.setsockopt(socket.SOL_SOCKET, flag, 1)
                with pytest.raises(OSError, match="already in use"):
                    thief.bind((address, ports[which].getsockname()[1]))
        first.close()
        again = shared.open_session("127.0.0.1", peer_of(client))  # a closed session's socket is not touched again
        for one in (second, again):
            one.close()


@pytest.mark.parametrize("which", [0, 1])
def test_a_closed_client_refuses(ports: tuple[socket.socket, socket.socket], client: socket.socket, which: int) -> None:
    """Also on the main port, where a session may have its socket."""
    own = SharedSocket(ports[which]).open_session("127.0.0.1", peer_of(client))
    client.close()
    assert own.send(b"see") is SendResult.SENT
    assert received(own) is SendResult.REFUSED
    assert own.receive() is None
    own.send(b"see")
    assert own.send(b"see") is SendResult.REFUSED
    own.close()


def test_sending_never_blocks_and_never_raises(
    ports: tuple[socket.socket, socket.socket], client: socket.socket
) -> None:
    own = SharedSocket(ports[1]).open_session("127.0.0.1", peer_of(client))
    assert own.send(bytes(100_000)) is SendResult.DROPPED  # longer than any datagram
    assert all(own.send(bytes(1400)) is not SendResult.REFUSED for _ in range(1000))
    shared = SharedSocket(ports[0])
    assert shared.send(b"x", ("255.255.255.255", 9, 0), "127.0.0.1") is SendResult.DROPPED
    assert shared.receive() is None
    own.close()


def test_a_session_at_an_address_that_is_not_ours_has_no_socket(
    ports: tuple[socket.socket, socket.socket], client: socket.socket
) -> None:
    with pytest.raises(OSError, match="assign"):
        SharedSocket(ports[1]).open_session("192.0.2.1", peer_of(client))


def test_views_are_marked_for_low_delay(ports: tuple[socket.socket, socket.socket], client: socket.socket) -> None:
    for opened in ports:
        assert opened.getsockopt(socket.IPPROTO_IP, socket.IP_TOS) == 46 << 2
