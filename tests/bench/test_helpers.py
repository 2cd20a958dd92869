"""Helper processes report what they measured, and end with the measurement."""

import socket
import threading

import pytest

from bench.helpers import Helper
from bench.service import is_alive

CLIENTS = 2


def serve_a_few(server: socket.socket) -> None:
    """Reply to two inits, then send each client three views, the last one twice."""
    peers = []
    for _ in range(CLIENTS):
        datagram, peer = server.recvfrom(1024)
        assert b"(time us)" in datagram
        server.sendto(b"(init blue 1 play_on)", peer)
        peers.append(peer)
    for time in ("1.000001", "1.033334", "1.066667", "1.066667"):
        for peer in peers:
            server.sendto(f"(see {time} ((edge) w1) ((ball) -1 0 0))".encode(), peer)


@pytest.mark.slow
def test_the_receiver_reports_what_its_clients_received() -> None:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as server:
        server.bind(("127.0.0.1", 0))
        port = server.getsockname()[1]
        thread = threading.Thread(target=serve_a_few, args=(server,))
        thread.start()
        with Helper("bench.receiver", port, 1) as receiver:
            thread.join()
            received = receiver.finish()
            assert not is_alive(receiver.process.pid)
    assert (received["clients"], received["ports"], received["errors"]) == (CLIENTS, [port], [])
    assert received["disordered"] == CLIENTS
    assert [view[:2] for view in received["views"]] == [[1000001, 2], [1033334, 2], [1066667, 4]]
    assert all(first <= last for _, _, first, last in received["views"])


@pytest.mark.slow
def test_a_helper_that_fails_at_its_start_raises() -> None:
    with pytest.raises(RuntimeError, match="'ready' was expected"):
        Helper("bench.record_timestamps", "pslv/no-such-service")
